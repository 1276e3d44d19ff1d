"""A column map from words of the command line: ``--time t:ms --x px:mm --heading yaw:deg --wheel -fl:rpm``.

A word is ``[-]COLUMN[:UNIT]``; a leading ``-`` turns the sign, and without a unit the column is in SI.  In
a file without a header columns are named by number, ``#1`` the first.  A
wheel's unit says what it is: rad, deg or turn and ``ticks=4096`` (a turn) its angle, rad/s, deg/s, turn/s or
rpm its speed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from slipmargin.errors import InputError
from slipmargin.io.importers.csv_map import Column, CsvMap
from slipmargin.io.importers.units import UNITS, factor


def csv_map(
    *,
    time: str | None,
    x: str | None,
    y: str | None,
    heading: str | None,
    wheels: Sequence[str],
    separator: str = ",",
) -> CsvMap:
    """The column map that the words say, one wheel for each of ``wheels`` in the robot file's order.

    Raises
    ------
    InputError
        Placed at the option that is missing or wrong.
    """
    given = {"--time": time, "--x": x, "--y": y, "--heading": heading}
    missing = [option for option, word in given.items() if not word]
    if missing:
        unseen = [o for o in missing if o != "--time"]
        raise _refusal(
            missing[0],
            "is missing"
            + (": wheels alone show no slip, the pose has to be measured too" if len(unseen) == 3 else ""),
            f"name the column of {', '.join(missing)}, or give --map",
        )
    if not wheels:
        raise _refusal("--wheel", "is missing", "name the column of each wheel, in the robot file's order")
    if separator not in (",", ";", "\t", "|"):
        raise _refusal("--separator", f"is {separator!r}", "use one of: , ; | or a tabulator")
    stamp, *pose = pose_columns(str(time), str(x), str(y), str(heading))
    return CsvMap(
        separator=separator,
        time=stamp,
        pose=(pose[0], pose[1], pose[2]),
        wheels=tuple({field: column} for field, column in wheel_columns(wheels)),
    )


def pose_columns(time: str, x: str, y: str, heading: str) -> tuple[Column, Column, Column, Column]:
    """The columns of time [s], x, y [m] and heading [rad] that four words say.

    Raises
    ------
    InputError
        Placed at the option that is wrong.
    """
    return (
        _column("--time", time, "time"),
        _column("--x", x, "length"),
        _column("--y", y, "length"),
        _column("--heading", heading, "angle"),
    )


_SI = {"time": "s", "length": "m", "angle": "rad"}


def _column(option: str, word: str, kind: str) -> Column:
    name, unit, sign = _parts(option, word)
    return Column(name=name, factor=sign * _factor(option, kind, unit or _SI[kind]))


def wheel_columns(words: Sequence[str]) -> list[tuple[str, Column]]:
    """Each wheel's field of a record and its column, from words like ``-fl:rpm``.

    Raises
    ------
    InputError
        Placed at the option ``--wheel`` for another unit, or where two wheels have one column.
    """
    found = [_wheel_column(word) for word in words]
    names = [column.name for _, column in found]
    twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
    if twice is not None:
        raise _refusal("--wheel", f"names {twice} for two wheels", "name the column of each wheel")
    return found


def _wheel_column(word: str) -> tuple[str, Column]:
    name, unit, sign = _parts("--wheel", word)
    if unit.startswith("ticks="):
        try:
            turn = float(unit.partition("=")[2])
        except ValueError:
            turn = math.nan
        if not 0.0 < abs(turn) < math.inf:
            raise _refusal("--wheel", f"is {word!r}", "write COLUMN:ticks=4096, ticks per turn of the wheel")
        return "theta", Column(name=name, factor=sign * 2.0 * math.pi / turn)
    unit = unit or "rad/s"
    for field, kind in (("theta", "angle"), ("omega", "speed")):
        if unit in UNITS[kind]:
            return field, Column(name=name, factor=sign * UNITS[kind][unit])
    known = ", ".join([*UNITS["angle"], *UNITS["speed"], "ticks=4096"])
    raise _refusal("--wheel", f"has the unit {unit!r}", f"use one of: {known}")


def _factor(option: str, kind: str, unit: str) -> float:
    try:
        return factor(option, kind, unit)
    except InputError as fault:
        raise fault.in_file("command line") from None


def _parts(option: str, word: str) -> tuple[str, str, float]:
    """Column, unit and sign of a word."""
    name, _, unit = word.rpartition(":") if ":" in word else (word, "", "")
    sign = -1.0 if name.startswith("-") else 1.0
    name = name.removeprefix("-").strip()
    if not name:
        raise _refusal(option, f"is {word!r}", "write COLUMN or COLUMN:UNIT")
    return name, unit.strip(), sign


def _refusal(option: str, problem: str, cure: str) -> InputError:
    return InputError(option, problem, cure, "command line")
