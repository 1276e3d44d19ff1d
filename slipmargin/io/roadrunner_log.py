"""Road Runner's log files (JSON): what the quickstart's ``LogFiles`` class writes while an op mode runs.

``version`` "quickstart1 v2"; ``nsTimes`` [ns]; the pose followed (``targetXs``, ``targetYs``,
``targetHeadings``)
and the pose estimated (``xs``, ``ys``, ``headings``), lengths in the unit of the robot's constants, which the
quickstart gives in inches, headings in radians; ``driveEncPositions`` and ``driveEncVels``, a list for each
motor in the order of the drive class (left front, left rear, right rear, right front) [ticks, ticks/s].
A wheel turns by ``gearRatio`` for a turn of its motor, and a turn of the motor is ``ticksPerRev`` ticks
(``DriveConstants``: "output (wheel) speed / input (motor) speed").  x is forward, y left, headings are
counter-clockwise, as in REP 103.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin.checks import LARGEST, Array
from slipmargin.errors import InputError
from slipmargin.io.json_read import parse_json

#: Length units of the robot's constants [m].
LENGTHS = {"in": 0.0254, "m": 1.0, "cm": 0.01, "mm": 0.001}
#: The pose that was estimated, and the one that was to be followed.
POSE = ("xs", "ys", "headings")
TARGET = ("targetXs", "targetYs", "targetHeadings")
#: Motors of a mecanum drive in the log's order.
MOTORS = ("left front", "left rear", "right rear", "right front")
VERSION = "quickstart1 v2"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RoadRunnerLog:
    """A log: times (T,) [s] from the first, and the whole file's table."""

    t_s: Array
    table: Mapping[str, Any]

    def pose(self, keys: Sequence[str], length_m: float) -> Array:
        """x, y [m] and heading [rad] (T, 3) of one of the two poses."""
        columns = [numbers(self.table, key, len(self.t_s)) for key in keys]
        return np.column_stack([columns[0] * length_m, columns[1] * length_m, np.unwrap(columns[2])])

    def has(self, key: str) -> bool:
        """Whether a list is there and holds something."""
        return isinstance(self.table.get(key), list) and bool(self.table[key])

    def wheels(self, key: str) -> Array:
        """What the encoders of the four motors say (T, 4) [ticks or ticks/s]."""
        lists = self.table.get(key)
        if not isinstance(lists, list) or len(lists) != len(MOTORS):
            found = len(lists) if isinstance(lists, list) else "no"
            raise InputError(
                key,
                f"holds {found} lists, not one for each of {', '.join(MOTORS)}",
                "give the log of a mecanum drive (with LogFiles.record's drive encoders)",
            )
        parts = {str(i): part for i, part in enumerate(lists)}
        return np.stack(
            [numbers(parts, str(i), len(self.t_s), f"{key}[{i}]") for i in range(len(MOTORS))], axis=1
        )

    def number(self, key: str) -> float:
        """A positive number of the file's head."""
        value = self.table.get(key)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < LARGEST:
            raise InputError(key, f"is {_shown(value)}", "give the log with DriveConstants as it was written")
        return float(value)


def is_road_runner(table: Mapping[str, Any]) -> bool:
    """Whether a JSON object is such a log."""
    return "nsTimes" in table


def road_runner_log(text: str) -> RoadRunnerLog:
    """The log in a file's text.

    Raises
    ------
    InputError
        Placed at the key that is wrong.
    """
    table = parse_json(text, "give the log as the robot wrote it")
    if not isinstance(table, dict) or not is_road_runner(table):
        raise InputError(
            "nsTimes",
            "is missing, so this is no log of Road Runner's LogFiles",
            "give the JSON that the quickstart writes to /sdcard/RoadRunner/logs",
        )
    return of_table(table)


def of_table(table: Mapping[str, Any]) -> RoadRunnerLog:
    """The log of a JSON object that is one."""
    stamps = table["nsTimes"]
    if not isinstance(stamps, list) or len(stamps) < 2:
        count = len(stamps) if isinstance(stamps, list) else "no"
        raise InputError("nsTimes", f"holds {count} times", "give the log of a whole run")
    for row, stamp in enumerate(stamps):
        if isinstance(stamp, bool) or not isinstance(stamp, int) or abs(stamp) >= 2**63:
            raise InputError(f"nsTimes[{row}]", f"is {_shown(stamp)}", "give whole nanoseconds")
    first = stamps[0]
    t = np.array([1e-9 * (stamp - first) for stamp in stamps])
    return RoadRunnerLog(t_s=t, table=table)


def numbers(table: Mapping[str, Any], key: str, count: int, place: str = "") -> Array:
    """A list of finite numbers of the log, one a time.

    Raises
    ------
    InputError
        Placed at the list, or at the number in it.
    """
    place = place or key
    values = table.get(key)
    if not isinstance(values, list):
        raise InputError(place, "is missing", "give the log as the robot wrote it")
    if len(values) != count:
        raise InputError(
            place, f"holds {len(values)} numbers for {count} times", "give the log as the robot wrote it"
        )
    for row, value in enumerate(values):
        bad = isinstance(value, bool) or not isinstance(value, int | float)
        if bad or not math.isfinite(value) or abs(value) >= LARGEST:
            raise InputError(f"{place}[{row}]", f"is {_shown(value)}, not a number", "give finite numbers")
    return np.array(values, dtype=float)


def _shown(value: Any) -> str:
    return repr(value)[:40]


def length_of(unit: str) -> float:
    """The length of a unit word [m].

    Raises
    ------
    InputError
        Placed at ``length_unit``.
    """
    if unit not in LENGTHS:
        raise InputError("length_unit", f"is {unit!r}", f"use one of: {', '.join(LENGTHS)}")
    return LENGTHS[unit]


def log_text(name: str, t_s: Array, pose: Array) -> str:
    """A motion as such a log, in inches: the pose to follow and the pose reached are both the given one.

    Parameters
    ----------
    name : str
        What the op mode is called.
    t_s, pose : (T,), (T, 3)
        Time [s], and x, y [m] and the heading of the front [rad].
    """
    from slipmargin.io.json_text import json_text

    stamps = [round(1e9 * float(t)) for t in t_s - t_s[0]]
    columns = [(pose[:, k] / (LENGTHS["in"] if k < 2 else 1.0)).tolist() for k in range(3)]
    return json_text(
        {
            "version": VERSION,
            "opModeName": name,
            "msInit": 0,
            "nsInit": 0,
            "nsStart": 0,
            "nsStop": stamps[-1],
            "nsTimes": stamps,
            **dict(zip(TARGET, columns, strict=True)),
            **dict(zip(POSE, columns, strict=True)),
            "voltages": [],
            "driveEncPositions": [],
            "driveEncVels": [],
            "trackingEncPositions": [],
            "trackingEncVels": [],
        }
    )


def read_log(path: Path) -> RoadRunnerLog:
    """The log in a file."""
    from slipmargin.io.source import read_text

    return road_runner_log(read_text(path))
