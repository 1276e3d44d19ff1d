"""Any CSV of a run, with a map that says which column is what.

The map is a TOML file::

    schema = 1
    separator = ";"                                  # optional, default ","
    [time]
    column = "stamp"
    unit = "ms"                                      # s, ms, us, ns
    [pose]
    x = { column = "px", unit = "mm" }               # m, cm, mm, in
    y = { column = "py", unit = "mm", scale = -1 }   # scale multiplies after the unit (here: y points down)
    heading = { column = "yaw", unit = "deg", offset_rad = 1.5708 }
    [[wheel]]                                        # in the robot file's order
    angle = { column = "enc1", unit = "ticks", ticks_per_turn = 4096, scale = -1 }
    [[wheel]]
    speed = { column = "w2", unit = "rpm" }          # also command, current
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.importers.loose_table import LooseTable, read_loose
from slipmargin.io.importers.plug import Reading
from slipmargin.io.importers.units import factor
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import Table, document

#: Key of a wheel's table → (field of a record, kind of quantity).
_CHANNELS = {
    "angle": ("theta", "angle"),
    "speed": ("omega", "speed"),
    "command": ("omega_cmd", "speed"),
    "current": ("current", "current"),
}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """A column of the log and the factor and offset that make it SI."""

    name: str
    factor: float
    offset: float = 0.0


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CsvMap:
    """Which column is what: time, x, y, heading, and per wheel the channels it has.

    Raises
    ------
    InputError
        Where one column is two things.
    """

    separator: str
    time: Column
    pose: tuple[Column, Column, Column]
    wheels: tuple[dict[str, Column], ...]

    def __post_init__(self) -> None:
        names = [column.name for column in self.columns]
        for k, name in enumerate(names):
            if name in names[:k]:
                raise InputError(name, "is the column of two channels", "name the column of each")

    @property
    def columns(self) -> list[Column]:
        """All that are read."""
        return [self.time, *self.pose, *(c for wheel in self.wheels for c in wheel.values())]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CsvImporter:
    """Logs of one map."""

    map: CsvMap
    name: str = "csv"

    def read(self, path: Path) -> Reading:
        """One run.

        Raises
        ------
        InputError
            Where a mapped column is missing, or fewer than two rows can be used.
        """
        table = read_loose(path, [c.name for c in self.map.columns], self.map.separator)
        if len(table.lines) < 2:
            raise InputError(f"{table.lines[0]}:1", "only one row can be used", "give a whole run")
        pose = np.stack([_si(table, column) for column in self.map.pose], axis=1)
        seen = np.isfinite(pose).all(axis=1)
        if not seen.any():
            raise InputError(self.map.pose[0].name, "no row holds a whole pose", "give x, y and heading")
        pose[seen, 2] = np.unwrap(pose[seen, 2])
        pose[~seen] = np.nan
        channels: dict[str, Any] = {field: self._all(table, field) for field, _ in _CHANNELS.values()}
        t, rows, dropped, notes = _si(table, self.map.time), table.rows, table.dropped, table.notes
        del table  # a record copies what it holds: a long log need not be there three times
        return Reading(
            source=str(path),
            record=Record(name=path.stem, t_s=t - t[0], pose=pose, **channels),
            rows=rows,
            dropped=dropped,
            lost_frames=int(np.count_nonzero(~seen)),
            notes=notes,
        )

    def _all(self, table: LooseTable, field: str) -> Array | None:
        if not any(field in wheel for wheel in self.map.wheels):
            return None
        gap = np.full(len(table.lines), np.nan)
        columns = [_si(table, wheel[field]) if field in wheel else gap for wheel in self.map.wheels]
        return np.stack(columns, axis=1)


def read_map(path: Path) -> CsvMap:
    """Read a column map strictly.

    Raises
    ------
    InputError
        With file and key, what is wrong and what to do.
    """
    try:
        top = document(
            read_text(path), "say which column is what, or use --time, --x, --y, --heading, --wheel"
        )
        separator = top.word("separator", (",", ";", "\t", "|"), ",")
        time = _column(top.table("time", "give [time] with column and unit"), "time", offset=False)
        pose = top.table("pose", "give [pose] with x, y and heading")
        where = tuple(
            _column(pose.table(key, "give column and unit"), kind)
            for key, kind in (("x", "length"), ("y", "length"), ("heading", "angle"))
        )
        pose.done()
        wheels = tuple(_wheel(table) for table in top.tables("wheel"))
        if not wheels:
            raise InputError(
                "wheel", "no wheel is mapped", "give one [[wheel]] for each, in the robot's order"
            )
        top.done()
        return CsvMap(separator=separator, time=time, pose=(where[0], where[1], where[2]), wheels=wheels)
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None


def _wheel(table: Table) -> dict[str, Column]:
    found = {
        field: _column(table.table(key, "give column and unit"), kind, offset=False)
        for key, (field, kind) in _CHANNELS.items()
        if table.has(key)
    }
    table.done()
    if not found:
        raise InputError(table.place, "has no channel", f"give one of: {', '.join(_CHANNELS)}")
    return found


def _column(table: Table, kind: str, offset: bool = True) -> Column:
    name = table.text("column")
    unit = table.text("unit")
    if kind == "angle" and unit == "ticks":
        per_turn = real(
            table.at("ticks_per_turn"),
            table.number("ticks_per_turn", "1"),
            above=0.0,
            cure="give ticks per turn of the wheel",
        )
        si = 2.0 * math.pi / per_turn
    else:
        si = factor(table.at("unit"), kind, unit)
    scale = table.number("scale", "1", 1.0)
    if scale == 0.0:
        raise InputError(table.at("scale"), "is 0", "give the factor of the channel, -1 to turn its sign")
    shift = table.number("offset_rad" if kind == "angle" else "offset_m", kind, 0.0) if offset else 0.0
    table.done()
    return Column(name=name, factor=si * scale, offset=shift)


def _si(table: LooseTable, column: Column) -> Array:
    return np.asarray(table[column.name] * column.factor + column.offset)
