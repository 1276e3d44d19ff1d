"""Wheels as a log counts them by the way in which they turn the robot, in the signs of its robot file."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.robot import Robot


def turning_signs(robot: Robot, count: int) -> Array:
    """(N,) +1 where a positive wheel speed carries the robot counter-clockwise, −1 where clockwise.

    Raises
    ------
    InputError
        Where the log, of ``count`` wheels, is of another robot.
    """
    if len(robot.wheels) != count:
        problem = f"{robot.name} has {len(robot.wheels)} wheels, the log {count}"
        raise InputError("wheel", problem, "give the file of the log's robot")
    (x, y), (s_x, s_y) = robot.geometry.position_m.T, robot.geometry.drive.T
    return np.asarray(np.copysign(1.0, y * s_x - x * s_y))  # the robot goes the other way than the contact
