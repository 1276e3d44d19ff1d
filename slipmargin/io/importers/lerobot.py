"""LeRobot's data sets (parquet) of a LeKiwi, with the pose from a tracker's CSV: the extra ``[lerobot]``.

A data set is a folder: ``meta/info.json`` names the numbers of ``observation.state``, and
``data/*/*.parquet``
hold a row a frame with ``observation.state``, ``timestamp`` [s] and ``episode_index`` (LeRobotDataset v2,
v3).
A LeKiwi writes its wheels' measured speeds there as ``x.vel``, ``y.vel`` [m/s] and ``theta.vel`` [deg/s],
by the
no-slip kinematics of its driver (``lekiwi.py: _wheel_raw_to_body``: wheels left, back, right at 240°, 0° and
120° less 90°, radius 0.05 m, 0.125 m from the centre).  That is undone here.  It is not the robot's motion:
where a wheel slips, only a tracker sees it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.extra import need
from slipmargin.io.importers.csv_map import Column
from slipmargin.io.importers.csv_options import wheel_columns
from slipmargin.io.importers.loose_table import LooseTable, increasing, left_out, read_loose
from slipmargin.io.importers.plug import Reading
from slipmargin.io.json_read import parse_json
from slipmargin.io.source import read_bytes, read_text
from slipmargin.robot import Robot

#: The driver's wheels and the directions in which a positive speed drives [deg], and its two lengths [m].
WHEELS = {"left": 150.0, "back": -90.0, "right": 30.0}
RADIUS_M, REACH_M = 0.05, 0.125
_BODY = ("x.vel", "y.vel", "theta.vel")
_STATE = "observation.state"
#: A wheel of the robot file is the driver's if its direction is this close [deg].
_SAME_DEG = 1.0


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Tracker:
    """The tracker's file, one for each log: time, x, y and heading, and its clock when an episode starts
    [s]."""

    files: tuple[Path, ...]
    columns: tuple[Column, Column, Column, Column]
    start_s: float = 0.0


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class LeRobotImporter:
    """Data sets of one robot: its wheels as ``words`` name them, or LeKiwi's; one episode a log."""

    robot: Robot
    logs: tuple[Path, ...]
    tracker: Tracker
    words: tuple[str, ...] = ()
    episode: int | None = None
    name: str = "lerobot"

    def read(self, path: Path) -> Reading:
        """One run.

        Raises
        ------
        InputError
            Where pyarrow is not installed, it is no such data set, or the tracker's file does not fit.
        """
        t, names, state = frames(path, self.episode)
        omega = self._wheels(names, state)
        keep, order = increasing(t)
        if len(keep) < 2:
            raise InputError("timestamp", f"{len(keep)} frames follow each other", "give a whole episode")
        if len(keep) < len(t):
            order.append(f"{len(t) - len(keep)} of {len(t)} frames left out, their times do not increase")
        t, omega = t[keep], omega[keep]
        table, stamp, pose = self._pose(path)
        inside = (stamp >= t[0]) & (stamp <= t[-1])
        if np.count_nonzero(inside) < 2:
            raise InputError(
                "--tracker",
                f"runs from {stamp[0]:.3g} to {stamp[-1]:.3g} s, the episode from {t[0]:.3g} to {t[-1]:.3g}",
                "say with --tracker-start what the tracker's clock showed when the episode began",
            )
        stamp, pose = stamp[inside], pose[inside]
        speeds = np.stack([np.interp(stamp, t, column) for column in omega.T], axis=1)
        record = Record(name=_run_name(path, self.episode), t_s=stamp - stamp[0], pose=pose, omega=speeds)
        dropped = [*table.dropped, *left_out(np.flatnonzero(~inside), "outside the episode", table.lines)]
        return Reading(
            source=str(path),
            record=record,
            rows=table.rows,
            dropped=tuple(sorted(dropped, key=lambda part: part.line)),
            lost_frames=int(np.count_nonzero(np.isnan(pose[:, 2]))),
            notes=(
                "the data set says what the wheels did; pose and rows counted here are the tracker's",
                *(f"the tracker's file: {note}" for note in table.notes),
                *order,
            ),
        )

    def _pose(self, path: Path) -> tuple[LooseTable, Array, Array]:
        tracker = self.tracker
        source = tracker.files[self.logs.index(path)] if len(tracker.files) > 1 else tracker.files[0]
        try:
            table = read_loose(source, list(dict.fromkeys(c.name for c in tracker.columns)), ",")
        except InputError as fault:
            raise fault.in_file(fault.source or str(source)) from None
        t, *where = (table[c.name] * c.factor for c in tracker.columns)
        pose = np.column_stack(where)
        seen = np.isfinite(pose).all(axis=1)
        pose[seen, 2] = self.robot.convention.phi_of_yaw(np.unwrap(pose[seen, 2]))
        pose[~seen] = np.nan
        return table, t - tracker.start_s, pose

    def _wheels(self, names: Sequence[str], state: Array) -> Array:
        if self.words:
            return self._named(names, state)
        missing = [name for name in _BODY if name not in names]
        if missing:
            raise InputError(
                _STATE,
                f"has no {missing[0]} (it has: {', '.join(names)})",
                "name the wheels' speeds with --wheel NAME:UNIT, once a wheel",
            )
        x, y, turn = (state[:, names.index(name)] for name in _BODY)
        return self._lekiwi(x, y, np.radians(turn))

    def _lekiwi(self, x: Array, y: Array, turn: Array) -> Array:
        out = []
        for wheel in self.robot.wheels:
            front = wheel.drive_direction_deg - math.degrees(self.robot.convention.front_rad)
            for drive in WHEELS.values():
                apart = abs(math.remainder(front - drive, 180.0))
                if apart < _SAME_DEG:
                    ahead = math.cos(math.radians(front - drive))
                    way = math.radians(drive)
                    speed = (math.cos(way) * x + math.sin(way) * y + REACH_M * turn) / RADIUS_M
                    out.append(speed * math.copysign(1.0, -self.robot.convention.contact_sign * ahead))
                    break
            else:
                raise InputError(
                    f"wheel {wheel.name}",
                    f"drives at {front:g}° from the front, LeKiwi's wheels at 150°, -90° and 30°",
                    "give LeKiwi's robot file (robots new NAME --type lekiwi), or name wheels with --wheel",
                )
        return np.stack(out, axis=1)

    def _named(self, names: Sequence[str], state: Array) -> Array:
        if len(self.words) != len(self.robot.wheels):
            count = len(self.robot.wheels)
            raise InputError("--wheel", f"are {len(self.words)}", f"give one for each of {count} wheels")
        out = []
        for field, column in wheel_columns(self.words):
            if field != "omega" or column.name not in names:
                problem = "is an angle" if field != "omega" else f"{column.name!r} is not in {_STATE}"
                raise InputError("--wheel", problem, f"give speeds of: {', '.join(names)}")
            out.append(column.factor * state[:, names.index(column.name)])
        return np.stack(out, axis=1)


def frames(path: Path, episode: int | None) -> tuple[Array, list[str], Array]:
    """Times (T,) [s], names and values (T, m) of the state in one episode of a data set.

    Raises
    ------
    InputError
        Where pyarrow is not installed, it is no such data set, or the episode is not there.
    """
    need("LeRobot data set", "pyarrow", "lerobot")
    root, files = _files(path)
    names = _names(root / "meta" / "info.json")
    tables = [_table(file) for file in files]
    index, t, state = (np.concatenate([table[k] for table in tables]) for k in range(3))
    there = sorted({int(i) for i in index})
    if episode is None:
        if len(there) != 1:
            raise InputError(
                "--episode",
                f"there are {len(there)}: {', '.join(map(str, there[:8]))}{' …' if len(there) > 8 else ''}",
                "name one",
            )
        episode = there[0]
    mine = index == episode
    if not mine.any():
        raise InputError(
            "--episode",
            f"{episode} is not there",
            f"there are {there[0]} to {there[-1]}" if there else "is empty",
        )
    if state.shape[1] != len(names):
        raise InputError(
            _STATE, f"holds {state.shape[1]} numbers, meta/info.json {len(names)} names", "record again"
        )
    return t[mine], names, state[mine]


def _run_name(path: Path, episode: int | None) -> str:
    name = path.stem if path.suffix == ".parquet" else path.resolve().name
    return name if episode is None else f"{name}_episode{episode}"


def _files(path: Path) -> tuple[Path, list[Path]]:
    """The data set's folder and the parquet files to read."""
    if not path.exists():
        raise InputError("", "there is no such data set", "give its folder or one of its .parquet", str(path))
    if path.is_dir():
        files = sorted(path.glob("data/*/*.parquet"))
        if not files:
            raise InputError(
                "", "holds no data/*/*.parquet", "give the folder of a LeRobot data set", str(path)
            )
        return path, files
    root = next((p for p in path.resolve().parents if (p / "meta" / "info.json").is_file()), None)
    if root is None:
        raise InputError(
            "", "stands in no LeRobot data set (no meta/info.json)", "give its folder", str(path)
        )
    return root, [path]


def _names(info: Path) -> list[str]:
    try:
        table = parse_json(read_text(info), "copy the data set again")
        found: Any = table["features"][_STATE]["names"] if isinstance(table, dict) else None
    except (KeyError, TypeError):
        found = None
    except InputError as fault:
        raise fault.in_file(str(info)) from None
    if isinstance(found, dict):  # {"motors": [...]} of older versions
        found = next(iter(found.values()), None)
    if not isinstance(found, list) or not all(isinstance(name, str) for name in found):
        raise InputError(
            f"features.{_STATE}.names", "is missing", "record the data set with names", str(info)
        )
    return found


def _table(file: Path) -> tuple[Array, Array, Array]:
    """Episode (T,), time (T,) [s] and state (T, m) of a file."""
    from pyarrow import ArrowException, BufferReader
    from pyarrow.parquet import read_table

    need_columns = ["episode_index", "timestamp", _STATE]
    try:
        table = read_table(BufferReader(read_bytes(file)), columns=need_columns)
        index, t, rows = (table[name].to_pylist() for name in need_columns)
        state = np.array(rows, dtype=float)
        times, episodes = np.array(t, dtype=float), np.array(index, dtype=float)
    except (ArrowException, OSError, KeyError, ValueError, TypeError) as fault:
        problem = f"is no data file of LeRobot that can be read ({type(fault).__name__})"
        raise InputError("", problem, f"it needs {', '.join(need_columns)}", str(file)) from None
    if state.ndim != 2 or not np.isfinite(times).all() or not np.isfinite(episodes).all():
        raise InputError(_STATE, "is not one list of numbers a frame", "record the data set again", str(file))
    return episodes, times, np.where(np.abs(state) < 1e12, state, np.nan)
