"""Trajectories as Choreo, PathPlanner and Road Runner write them, in JSON; headings are those of the
robot's front.

All three have the robot's front along its x axis and its left along y, and measure the heading θ from the
field's x axis, anticlockwise: "the positive X axis points ahead, the positive Y axis points left"
(docs.wpilib.org, Coordinate System).  :func:`~slipmargin.io.trajectory_file.read_trajectory` turns θ into
φ.  Positions and velocities stay: the floor frame is the tool's field frame.

Choreo: ``trajectory.samples`` of ``t, x, y, heading`` [s, m, m, rad] and ``vx, vy, omega, ax, ay, alpha``
in the field frame (choreolib ``SwerveSample``), or, up to 2024, ``samples`` of
``timestamp, x, y, heading, velocityX, velocityY, angularVelocity``.

PathPlanner: a list of states, bare or under ``states``, of ``time``, ``pose.translation.x/y``,
``pose.rotation.radians`` (the direction of travel), ``velocity`` and ``acceleration`` (along the path),
``holonomicRotation`` [deg] and ``holonomicAngularVelocity`` [deg/s] (its ``TrajectoryState.toJson``).

Road Runner: the log of the quickstart (:mod:`~slipmargin.io.roadrunner_log`), lengths in inches.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from slipmargin.checks import LARGEST, Array
from slipmargin.errors import InputError
from slipmargin.io.json_read import parse_json
from slipmargin.io.roadrunner_log import LENGTHS, POSE, TARGET, is_road_runner, of_table

#: What is read, for the refusal of anything else.
FORMS = (
    "a CSV with t_s,x_m,y_m,phi_rad, a Choreo .traj, a PathPlanner trajectory JSON, a Road Runner log or a "
    "ROS bag with a nav_msgs/Path"
)
#: Samples this close in time [s] and in pose [m, rad] repeat each other: the tools round to 5 decimals.
SAME_TIME, SAME_POSE = 1e-3, 2e-5


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Claim:
    """A rate (T, k) that a file states, beside the values (T, k) that it is the rate of."""

    name: str
    unit: str
    values: Array
    rate: Array


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Samples:
    """A trajectory from a file: t [s] (T,), x [m], y [m], φ or θ [rad] (T, 3).

    ``form`` names what the file is, ``claims`` are velocities and accelerations that it states, ``notes``
    what a user must know about the reading.
    """

    form: str
    t_s: Array
    pose: Array
    claims: tuple[Claim, ...] = ()
    notes: tuple[str, ...] = ()


def samples_from_json(text: str) -> Samples:
    """The trajectory in the text of a Choreo, PathPlanner or Road Runner file.

    Raises
    ------
    InputError
        Placed at ``line:column`` or at the key, where it is no JSON, of no known form, or damaged.
    """
    found = parse_json(text, "export the trajectory again")
    if isinstance(found, dict) and is_road_runner(found):
        return _road_runner(found)
    if isinstance(found, dict) and "trajectory" in found:
        return _choreo(_member(found, "trajectory", "", dict), "trajectory.")
    if isinstance(found, dict) and "samples" in found:
        return _choreo(found, "")
    if isinstance(found, dict) and "states" in found:
        return _pathplanner(found["states"], "states")
    if isinstance(found, list):
        return _pathplanner(found, "")
    raise unknown_form()


def _road_runner(table: Mapping[str, Any]) -> Samples:
    """The pose that a log of Road Runner was to follow; the one it reached, where it has no other."""
    log = of_table(table)
    followed = log.has(TARGET[0])
    pose = log.pose(TARGET if followed else POSE, LENGTHS["in"])
    (t_s, pose), notes = without_repetitions("nsTimes", log.t_s, pose)
    if not followed:
        notes += ("there is no pose to follow (targetXs): the estimated one is read",)
    elif log.has(POSE[0]) and table[POSE[0]] != table[TARGET[0]]:
        notes += ("the pose to follow (targetXs) is read; the estimated one is another",)
    return Samples(form="Road Runner", t_s=t_s, pose=pose, notes=notes)


def unknown_form() -> InputError:
    """The refusal of a file that is no trajectory."""
    return InputError("", "is no trajectory of a known form", f"give {FORMS}")


def without_repetitions(
    place: str, t_s: Array, pose: Array, *rest: Array
) -> tuple[list[Array], tuple[str, ...]]:
    """Time, pose and further columns without samples that repeat the one before, and a note that says so.

    Raises
    ------
    InputError
        Placed at ``place[row]``, counted from 0, where time goes back or stands still while the pose moves.
    """
    keep = [0]
    for row in range(1, len(t_s)):
        step, moved = t_s[row] - t_s[keep[-1]], float(np.max(np.abs(pose[row] - pose[keep[-1]])))
        if 0.0 <= step <= SAME_TIME and moved <= SAME_POSE:
            continue
        if step <= 0.0:
            raise InputError(
                f"{place}[{row}]",
                f"is at {t_s[row]:g} s, not after {t_s[keep[-1]]:g} s",
                "time must increase from sample to sample",
            )
        keep.append(row)
    left_out = len(t_s) - len(keep)
    plural = "sample repeats the one" if left_out == 1 else "samples repeat those"
    note = f"{left_out} {plural} before within rounding and {'is' if left_out == 1 else 'are'} left out"
    return [a[keep] for a in (t_s, pose, *rest)], ((note,) if left_out else ())


def _choreo(holder: Mapping[str, Any], prefix: str) -> Samples:
    place = f"{prefix}samples"
    rows = _rows(_member(holder, "samples", prefix, list), place, "generate the trajectory in Choreo first")
    new = "t" in rows[0]
    time, rates = ("t", ("vx", "vy", "omega")) if new else ("timestamp", OLD_RATES)
    groups = [g for g in (rates, ("ax", "ay", "alpha")) if any(key in rows[0] for key in g)]
    names = [time, "x", "y", "heading", *(key for group in groups for key in group)]
    table = np.array([[_number(r, key, f"{place}[{i}]") for key in names] for i, r in enumerate(rows)])
    pose = np.column_stack([table[:, 1:3], np.unwrap(table[:, 3])])
    (t_s, pose, table), notes = without_repetitions(place, table[:, 0], pose, table)
    claims, of = [], pose
    for k, group in enumerate(groups):
        given = table[:, 4 + 3 * k : 7 + 3 * k]
        kind = "acceleration" if group[0] == "ax" else "velocity"
        if kind == "velocity" or k == 1:
            claims += _claims(kind, of, given)
        of = given
    return Samples(form="Choreo", t_s=t_s, pose=pose, claims=tuple(claims), notes=notes)


#: Names of the velocities in Choreo's files up to 2024.
OLD_RATES = ("velocityX", "velocityY", "angularVelocity")


def _claims(kind: str, values: Array, rate: Array) -> list[Claim]:
    power = "²" if kind == "acceleration" else ""
    return [
        Claim(name=kind, unit=f"m/s{power}", values=values[:, :2], rate=rate[:, :2]),
        Claim(name=f"angular {kind}", unit=f"rad/s{power}", values=values[:, 2:], rate=rate[:, 2:]),
    ]


def _pathplanner(states: Any, prefix: str) -> Samples:
    rows = _rows(states, prefix, "generate the trajectory in PathPlanner first")
    first = rows[0]
    time = next((key for key in ("time", "timeSeconds") if key in first), None)
    if time is None or not ("pose" in first or "translation" in first):
        raise unknown_form()
    turned = "holonomicRotation" in first
    optional = [k for k in ("velocity", "acceleration", "holonomicAngularVelocity") if k in first]
    table = np.array([_state(row, time, turned, optional, f"{prefix}[{i}]") for i, row in enumerate(rows)])
    pose = np.column_stack([table[:, 1:3], np.unwrap(table[:, 3])])
    (t_s, pose, table), notes = without_repetitions(prefix, table[:, 0], pose, table)
    if not turned:
        notes += (
            "the states have no holonomicRotation: pose.rotation is taken as the robot's heading "
            "(PathPlanner writes the direction of travel there)",
        )
    given = {key: table[:, 4 + k : 5 + k] for k, key in enumerate(optional)}
    claims = []
    if "velocity" in given:
        step = np.hypot(*np.diff(pose[:, :2], axis=0).T)
        way = np.concatenate([[0.0], np.cumsum(step)])[:, None]
        claims.append(Claim(name="velocity", unit="m/s", values=way, rate=np.abs(given["velocity"])))
        if "acceleration" in given:
            claims.append(
                Claim(name="acceleration", unit="m/s²", values=given["velocity"], rate=given["acceleration"])
            )
    if turned and "holonomicAngularVelocity" in given:
        turning = np.deg2rad(given["holonomicAngularVelocity"])
        claims.append(Claim(name="angular velocity", unit="rad/s", values=pose[:, 2:], rate=turning))
    return Samples(form="PathPlanner", t_s=t_s, pose=pose, claims=tuple(claims), notes=notes)


def _state(
    row: Mapping[str, Any], time: str, turned: bool, optional: Sequence[str], place: str
) -> list[float]:
    """Time, x, y, heading θ [rad] and the optional numbers of a state."""
    pose, inside = (
        (_member(row, "pose", f"{place}.", dict), f"{place}.pose") if "pose" in row else (row, place)
    )
    where = _member(pose, "translation", f"{inside}.", dict)
    if turned:
        theta = math.radians(_number(row, "holonomicRotation", place))
    elif isinstance(pose.get("rotation"), dict):
        theta = _number(pose["rotation"], "radians", f"{inside}.rotation")
    else:
        theta = _number(pose, "rotation", inside)
    x, y = (_number(where, key, f"{inside}.translation") for key in ("x", "y"))
    return [_number(row, time, place), x, y, theta, *(_number(row, key, place) for key in optional)]


def _rows(value: Any, place: str, cure: str) -> list[dict[str, Any]]:
    if not isinstance(value, list):
        raise InputError(place, f"is {_shown(value)}, not a list of samples", "export the trajectory again")
    if not value:
        raise InputError(place, "holds no sample", cure)
    for i, row in enumerate(value):
        if not isinstance(row, dict):
            raise InputError(
                f"{place}[{i}]", f"is {_shown(row)}, not a sample", "export the trajectory again"
            )
    return value


def _member(holder: Mapping[str, Any], key: str, prefix: str, kind: type) -> Any:
    found = holder.get(key)
    if not isinstance(found, kind):
        problem = f"is {_shown(found)}, not {'a list' if kind is list else 'an object'}"
        raise InputError(
            f"{prefix}{key}", problem if key in holder else "is missing", "export the trajectory again"
        )
    return found


def _number(holder: Mapping[str, Any], key: str, place: str) -> float:
    value = holder.get(key)
    at = f"{place}.{key}"
    if key not in holder:
        raise InputError(at, "is missing", "export the trajectory again")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(at, f"is {_shown(value)}, not a number", "give a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not abs(number) < LARGEST:
        raise InputError(at, f"is {_shown(value)}", "give a finite number below 1e12")
    return number


def _shown(value: Any) -> str:
    return repr(value)[:40] if not isinstance(value, int) or abs(value) < 10**30 else "a huge number"
