"""Wheels of a mecanum drive as other tools log them: by their corners, positive where they drive ahead."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.importers.ros_names import joints_of_wheels
from slipmargin.robot import Robot

#: A wheel that drives this much across the robot's front has no forward sense (cosine of the angle).
_ACROSS = 0.3


def corner_columns(robot: Robot, corners: Sequence[str]) -> list[int]:
    """For each wheel of the robot, which of a log's columns is its own, by the names of the corners.

    Raises
    ------
    InputError
        Where a wheel's name says no corner, or the robot has another number of wheels.
    """
    names = tuple(w.name for w in robot.wheels)
    cure = "this log is of a mecanum drive: name the robot file's four wheels fl, fr, rl and rr"
    if len(names) != len(corners):
        raise InputError("wheel", f"{robot.name} has {len(names)} wheels, the log {len(corners)}", cure)
    try:
        found = joints_of_wheels(names, tuple(corners), "the log")
    except InputError as fault:
        raise InputError("wheel", fault.problem, cure) from None
    return [list(corners).index(name) for name in found]


def forward_signs(robot: Robot) -> Array:
    """(N,) +1 where a wheel's positive speed drives the robot forwards, −1 where backwards.

    Raises
    ------
    InputError
        For a wheel that drives across the robot's front: it has no forward sense.
    """
    front = robot.convention.front_rad
    ahead = [math.cos(math.radians(w.drive_direction_deg) - front) for w in robot.wheels]
    for wheel, share in zip(robot.wheels, ahead, strict=True):
        if abs(share) < _ACROSS:
            raise InputError(
                f"wheel {wheel.name}",
                "drives across the robot's front, so a forward speed has no sign",
                "use import csv with --wheel, where you say the sign",
            )
    return np.asarray(-robot.convention.contact_sign * np.sign(ahead))
