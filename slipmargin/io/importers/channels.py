"""Logs of named channels, each with its own stamps: which hold the pose and which the wheels, and the run
in them.

FRC's logs (WPILOG, AdvantageScope's CSV) hold a value where it changed.  Until the next change it holds, so a
gap is filled with the old value one usual step before the new one.  Poses are those of WPILib: "the
positive X
axis points ahead, the positive Y axis points left" and angles are counter-clockwise (docs.wpilib.org,
Coordinate System); wheel speeds of a mecanum drive are positive forwards [m/s], front left, front right, rear
left, rear right.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.importers.csv_options import wheel_columns
from slipmargin.io.importers.loose_table import increasing, left_out
from slipmargin.io.importers.mecanum import corner_columns, forward_signs
from slipmargin.io.importers.plug import Reading
from slipmargin.robot import Robot

#: The wheels of WPILib's mecanum structures, in their order.
CORNERS = ("front left", "front right", "rear left", "rear right")
#: Words in the name of a pose that nobody measured.
_NOT_MEASURED = ("target", "goal", "setpoint", "trajectory", "desired", "reference", "sim", "start", "reset")
#: Words in the name of a pose that is computed from the wheels, at least in part.
_OF_WHEELS = ("odom", "estimat", "robotpose")
#: A gap longer than this many usual steps is a time in which the value held.
_GAP = 1.5


class Kind(Enum):
    """What a channel's values (K, m) are."""

    POSE = "pose"  #: x, y [m], heading [rad]
    SPEEDS = "mecanum wheel speeds"  #: four [m/s]
    POSITIONS = "mecanum wheel positions"  #: four [m]
    WHEELS = "mecanum wheels"  #: four, of which the log does not say whether speeds or positions
    NUMBER = "number"
    NUMBERS = "numbers"
    SWERVE = "swerve modules"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Channel:
    """One channel: its stamps (K,) [s] and values (K, m)."""

    kind: Kind
    t_s: Array
    values: Array


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What a user says of a log: the pose's channel (``KEY`` or ``KEY:deg``) and the wheels'
    (``KEY:UNIT``)."""

    robot: Robot
    pose: str | None = None
    wheels: tuple[str, ...] = ()


def reading(path: Path, channels: Mapping[str, Channel], wanted: Wanted) -> Reading:
    """The run in the channels of a log.

    Raises
    ------
    InputError
        Where the log holds swerve modules, or no pose or wheels that are clearly meant.
    """
    notes: list[str] = []
    name, pose = _pose(channels, wanted.pose, notes)
    found = _wheels(channels, wanted, notes)
    keep, order = increasing(pose.t_s)
    why = "its stamp does not come after the one before"
    dropped = left_out(np.setdiff1d(np.arange(len(pose.t_s)), keep), why)
    finite = np.isfinite(pose.values[keep]).all(axis=1)
    dropped += left_out(np.sort(keep[~finite]), "its pose is not finite")
    keep = keep[finite]
    t, where = held(pose.t_s[keep], pose.values[keep])
    if not np.array_equal(t, pose.t_s[keep]):
        notes.append(
            f"{name} holds from change to change: of {len(keep)} poses come {len(t)} rows of the run"
        )
    if len(t) < 2:
        raise InputError(name, f"holds {len(t)} poses", "give the log of a whole run")
    heading = wanted.robot.convention.phi_of_yaw(np.unwrap(where[:, 2]))
    record = Record(
        name=path.stem,
        t_s=t - t[0],
        pose=np.column_stack([where[:, :2], heading]),
        theta=_at(t, found.get("theta")),
        omega=_at(t, found.get("omega")),
    )
    if not any(np.isfinite(c).any(axis=0).all() for c in (record.theta, record.omega) if c is not None):
        raise InputError(name, "its times are not those of the wheels", "log pose and wheels together")
    return Reading(
        source=str(path),
        record=record,
        rows=len(pose.t_s),
        dropped=tuple(sorted(dropped, key=lambda part: part.line)),
        notes=(*notes, *order),
    )


def held(t: Array, values: Array) -> tuple[Array, Array]:
    """A channel that is logged where it changes, with the value that held until just before each change."""
    if len(t) < 3:
        return t, values
    keep = np.concatenate([[True], np.any(values[1:] != values[:-1], axis=1)])
    keep[-1] = True
    t, values = t[keep], values[keep]
    if len(t) < 3:
        return t, values
    step = float(np.median(np.diff(t)))
    gap = np.flatnonzero(np.diff(t) > _GAP * step) + 1
    return np.insert(t, gap, t[gap] - step), np.insert(values, gap, values[gap - 1], axis=0)


_Signals = dict[str, list[tuple[Array, Array]]]


def _at(t: Array, columns: list[tuple[Array, Array]] | None) -> Array | None:
    """Every wheel's signal at the times of the poses; outside its own times nothing is known."""
    if columns is None:
        return None
    return np.stack([np.interp(t, *column, left=np.nan, right=np.nan) for column in columns], axis=1)


def _pose(channels: Mapping[str, Channel], word: str | None, notes: list[str]) -> tuple[str, Channel]:
    poses = [name for name, channel in channels.items() if channel.kind is Kind.POSE]
    if word is not None:
        return _named_pose(channels, word, poses)
    poses = [name for name in poses if not any(w in name.lower() for w in _NOT_MEASURED)]
    if len(poses) != 1:
        problem = (
            f"{len(poses)} channels may be the pose" if poses else "no channel is a pose (Pose2d, Pose3d)"
        )
        cure = "name one with --pose"
        cure += f": {_some(poses)}" if poses else "; without a measured pose nothing shows slip"
        raise InputError("--pose", problem, cure)
    (name,) = poses
    notes.append(f"{name} is taken as the pose by its type")
    if any(word in name.lower() for word in _OF_WHEELS):
        notes.append(f"{name}: if it is computed from the wheels alone, it cannot show that they slip")
    return name, channels[name]


def _named_pose(channels: Mapping[str, Channel], word: str, poses: Sequence[str]) -> tuple[str, Channel]:
    name, unit = word, ""
    if word not in channels and word.rpartition(":")[2] in ("deg", "rad"):
        name, _, unit = word.rpartition(":")
    channel = channels.get(name)
    if channel is None:
        raise InputError("--pose", f"{name!r} is not a channel of the log", f"use one of: {_some(poses)}")
    if channel.kind is Kind.POSE:
        if unit == "deg":
            raise InputError("--pose", f"{name!r} is a pose, whose heading is in rad", "leave :deg out")
        return name, channel
    if channel.kind is not Kind.NUMBERS or channel.values.shape[1] != 3:
        raise InputError("--pose", f"{name!r} is no pose", f"use one of: {_some(poses)}")
    if not unit:
        raise InputError(
            "--pose", f"{name!r} is three numbers", f"say its heading's unit: {name}:deg or :rad"
        )
    turn = math.pi / 180.0 if unit == "deg" else 1.0
    return name, Channel(kind=Kind.POSE, t_s=channel.t_s, values=channel.values * [1.0, 1.0, turn])


def _wheels(channels: Mapping[str, Channel], wanted: Wanted, notes: list[str]) -> _Signals:
    words = wanted.wheels
    if words:
        name, unit = _key(channels, words[0])
        if len(words) == 1 and name in channels and channels[name].values.shape[1] == len(CORNERS):
            return _corners(name, channels[name], unit, wanted.robot, notes)
        return _single(channels, wanted, notes)
    groups = (Kind.POSITIONS, Kind.SPEEDS, Kind.WHEELS)
    found = [n for kind in groups for n, c in channels.items() if c.kind is kind]
    measured = [n for n in found if not any(w in n.lower() for w in _NOT_MEASURED)]
    if not measured and any(c.kind is Kind.SWERVE for c in channels.values()):
        raise InputError(
            next(n for n, c in channels.items() if c.kind is Kind.SWERVE),
            "is of swerve modules",
            "slipmargin is for omni and mecanum wheels on fixed axles; give the log of such a robot",
        )
    first = [n for n in measured if channels[n].kind is channels[measured[0]].kind]
    if len(first) != 1:
        problem = (
            f"{len(first)} channels may be the wheels: {_some(first)}"
            if first
            else "no channel is clearly wheels"
        )
        numbers = [n for n, c in channels.items() if c.kind is Kind.NUMBER]
        raise InputError(
            "--wheel",
            problem,
            "name one, or one number KEY:UNIT for each wheel" + ("" if first else f", of: {_some(numbers)}"),
        )
    name = first[0]
    notes.append(f"{name} ({channels[name].kind.value}) is taken as the wheels by its type")
    return _corners(name, channels[name], "", wanted.robot, notes)


def _corners(name: str, channel: Channel, unit: str, robot: Robot, notes: list[str]) -> _Signals:
    """Angles or speeds of four wheels, of which a log may hold the way or the speed along the floor."""
    unit = unit or {Kind.POSITIONS: "m", Kind.SPEEDS: "m/s"}.get(channel.kind, "")
    if not unit:
        raise InputError(
            "--wheel", f"{name} may be speeds or positions", f"say which: {name}:m/s or {name}:m"
        )
    order, sign = corner_columns(robot, CORNERS), forward_signs(robot)
    if unit in ("m", "m/s"):
        field, factor = "theta" if unit == "m" else "omega", sign / [w.radius_m for w in robot.wheels]
    else:
        try:
            ((field, column),) = wheel_columns([f"{name}:{unit}"])
        except InputError as fault:
            raise InputError(fault.place, fault.problem, f"{fault.cure}, or m, m/s", fault.source) from None
        factor = sign * column.factor
    t, values = held(*_ordered(name, channel, notes))
    return {field: [(t, factor[i] * values[:, k]) for i, k in enumerate(order)]}


def _single(channels: Mapping[str, Channel], wanted: Wanted, notes: list[str]) -> _Signals:
    words, robot = wanted.wheels, wanted.robot
    if len(words) != len(robot.wheels):
        raise InputError("--wheel", f"are {len(words)}", f"give one for each of {len(robot.wheels)} wheels")
    out: _Signals = {}
    plain = [f"{word}:rad/s" if _plain(channels, word) else word for word in words]
    for field, column in wheel_columns(plain):
        channel = channels.get(column.name)
        if channel is None or channel.kind is not Kind.NUMBER:
            numbers = [n for n, c in channels.items() if c.kind is Kind.NUMBER]
            raise InputError(
                "--wheel", f"{column.name!r} is not a channel of numbers", f"use one of: {_some(numbers)}"
            )
        t, values = held(*_ordered(column.name, channel, notes))
        out.setdefault(field, []).append((t, column.factor * values[:, 0]))
    if len(out) != 1:
        raise InputError("--wheel", "mixes angles and speeds", "give the same of every wheel")
    return out


def _ordered(name: str, channel: Channel, notes: list[str]) -> tuple[Array, Array]:
    keep, _ = increasing(channel.t_s)
    keep = keep[np.isfinite(channel.values[keep]).all(axis=1)] if len(keep) else keep
    if len(keep) < 2:
        raise InputError(name, f"holds {len(keep)} samples", "give the log of a whole run")
    count = len(channel.t_s)
    if len(keep) < count:
        why = "out of order, not finite or of another length"
        notes.append(f"{name}: {count - len(keep)} of {count} samples left out, {why}")
    return channel.t_s[keep], channel.values[keep]


def _plain(channels: Mapping[str, Channel], word: str) -> bool:
    return word.removeprefix("-") in channels


def _key(channels: Mapping[str, Channel], word: str) -> tuple[str, str]:
    """Channel and unit of a word; a channel's own name may hold a colon."""
    if word in channels or ":" not in word:
        return word, ""
    name, _, unit = word.rpartition(":")
    return name, unit


def _some(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + (" …" if len(names) > 8 else "") if names else "(the log has none)"
