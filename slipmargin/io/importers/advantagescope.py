"""CSV that AdvantageScope exports ("CSV (Table)" and "CSV (List)") of a mecanum robot.

Table: ``Timestamp`` [s] and one column a field, every row filled with the last value.  List: ``Timestamp,Key,
Value``, one row a change.  Fields of structures are fields of their own: a Pose2d is ``…/translation/x``,
``…/translation/y`` [m] and ``…/rotation/value`` [rad], the wheels of a mecanum drive ``…/front_left`` to
``…/rear_right``.  Arrays are ``[1; 2; 3]`` (AdvantageScope's CSVDecoder).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.importers.channels import Channel, Kind, Wanted, reading
from slipmargin.io.importers.plug import Reading
from slipmargin.io.source import read_text

_LIST = ("Timestamp", "Key", "Value")
_POSE = ("/translation/x", "/translation/y", "/rotation/value")
_WHEELS = ("/front_left", "/front_right", "/rear_left", "/rear_right")
_SWERVE = ("/0/speed", "/0/angle/value")
#: Share of the rows that may be unreadable before the file is none of AdvantageScope's.
_BAD = 0.5

_Rows = dict[str, tuple[list[float], list[tuple[float, ...]]]]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class AdvantageScopeImporter:
    """Exports of one robot's logs: which fields hold its pose and its wheels, found where they are not
    named."""

    wanted: Wanted
    name: str = "advantagescope"

    def read(self, path: Path) -> Reading:
        """One run.

        Raises
        ------
        InputError
            Where it is no such export, or holds no pose or wheels.
        """
        channels, bad = fields(read_text(path))
        found = reading(path, channels, self.wanted)
        if not bad:
            return found
        lines = "1 line" if len(bad) == 1 else f"{len(bad)} lines"
        return replace(found, notes=(*found.notes, f"{lines} cannot be read, the first is line {bad[0]}"))


def fields(text: str) -> tuple[dict[str, Channel], list[int]]:
    """The fields of an export, a pose's and a mecanum drive's together, and the lines that cannot be read.

    Raises
    ------
    InputError
        Placed at ``line:column``.
    """
    lines = text.replace("\r\n", "\n").split("\n")
    names = [cell.strip().strip('"') for cell in lines[0].split(",")]
    if names[0] != _LIST[0] or len(names) < 2:
        raise InputError(
            "1:1",
            "is no export of AdvantageScope (its first column is not Timestamp)",
            "export the log as CSV (Table) or CSV (List); for another CSV use import csv",
        )
    rows: _Rows = {}
    bad: list[int] = []
    full = [(number, line) for number, line in enumerate(lines[1:], 2) if line.strip()]
    for number, line in full:
        cells = [cell.strip() for cell in line.split(",")]
        time = _number(cells[0])
        if len(cells) != len(names) or time is None:
            bad.append(number)
        elif tuple(names) == _LIST:
            _put(rows, cells[1], time, cells[2])
        else:
            for name, cell in zip(names[1:], cells[1:], strict=True):
                _put(rows, name, time, cell)
    if not full or len(bad) > _BAD * len(full):
        first = f"{bad[0]}:1" if bad else "2:1"
        problem = f"has no {len(names)} cells, as the first line, or no time" if bad else "there is no row"
        raise InputError(first, problem, "export the log again")
    return _together({name: _channel(*found) for name, found in rows.items()}), bad


def _put(rows: _Rows, name: str, time: float, cell: str) -> None:
    if cell.startswith("[") and cell.endswith("]"):
        values = [_number(word) for word in cell[1:-1].split(";")]
    else:
        values = [_number(cell)]
    usable = tuple(v for v in values if v is not None)
    if len(usable) < len(values):
        return  # text, or no value yet
    at, found = rows.setdefault(name, ([], []))
    if not found or len(found[0]) == len(usable):
        at.append(time)
        found.append(usable)


def _number(word: str) -> float | None:
    try:
        value = float(word.strip().strip('"'))
    except ValueError:
        return None
    return value if abs(value) < 1e12 else None


def _channel(t: list[float], values: list[tuple[float, ...]]) -> Channel:
    kind = Kind.NUMBER if len(values[0]) == 1 else Kind.NUMBERS
    return Channel(kind=kind, t_s=np.array(t), values=np.array(values))


def _together(found: dict[str, Channel]) -> dict[str, Channel]:
    """The fields, with those of one pose or one mecanum drive made one field of their structure's name."""
    out = dict(found)
    for name in found:
        for ends, kind in ((_POSE, Kind.POSE), (_WHEELS, Kind.WHEELS), (_SWERVE, Kind.SWERVE)):
            stem = name.removesuffix(ends[0])
            parts = [found.get(stem + end) for end in ends]
            if stem == name or not all(part is not None and part.kind is Kind.NUMBER for part in parts):
                continue
            t, values = _joined([part for part in parts if part is not None])
            out[stem] = Channel(kind=_of_wheels(stem) if kind is Kind.WHEELS else kind, t_s=t, values=values)
    return out


def _joined(parts: list[Channel]) -> tuple[Array, Array]:
    """Fields at all of their times together, each holding its last value; from where all have one."""
    t = np.unique(np.concatenate([part.t_s for part in parts]))
    t = t[t >= max(float(part.t_s.min()) for part in parts)]
    columns = []
    for part in parts:
        order = np.argsort(part.t_s, kind="stable")
        last = np.searchsorted(part.t_s[order], t, side="right") - 1
        columns.append(part.values[order][last, 0])
    return t, np.stack(columns, axis=1)


def _of_wheels(stem: str) -> Kind:
    """Speeds and positions have the same fields; only the name tells them apart."""
    last = stem.lower().rpartition("/")[2]
    for kind, words in ((Kind.POSITIONS, ("position", "distance")), (Kind.SPEEDS, ("speed", "veloc"))):
        if any(word in last for word in words):
            return kind
    return Kind.WHEELS
