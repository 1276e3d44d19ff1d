"""The same robot as the other convention writes it down: places and directions turned, wheel speeds kept.

Body and floor are turned together by a quarter, so φ, moments, wheel angles and times stay what they are.
A positive wheel speed drives the other end of the drive direction in the other convention
(:mod:`slipmargin.physics.convention`), so drive directions are turned by a quarter and reversed.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.convention import Convention
from slipmargin.robot.robot import Robot
from slipmargin.robot.uncertain import UncertainArray, spread


def vectors(values: Array, old: Convention, new: Convention) -> Array:
    """Vectors (..., 2), or poses, twists and wrenches (..., 3), in the axes of another convention; exact."""
    out = np.array(values, dtype=float)
    right, forward = old.right_forward(values[..., 0], values[..., 1])
    x, y = new.from_right_forward(right, forward)
    out[..., 0], out[..., 1] = x + 0.0, y + 0.0  # no −0, so that files are the same too
    return out


def quarter_rad(old: Convention, new: Convention) -> float:
    """How much larger the angle of a direction is in the axes of another convention [rad]."""
    return new.front_rad - old.front_rad


def robot_in(robot: Robot, new: Convention) -> Robot:
    """The same machine in a convention; itself where it is in it already."""
    old = robot.convention
    if old is new:
        return robot
    back = 180.0 if old.contact_sign > new.contact_sign else -180.0
    turn = math.degrees(quarter_rad(old, new)) + back
    wheels = tuple(
        replace(
            w,
            position_m=vectors(w.position_m, old, new),
            drive_direction_deg=w.drive_direction_deg + turn,
        )
        for w in robot.wheels
    )
    com = robot.body.com_m
    x, y = com.each if isinstance(com, UncertainArray) else com.tolist()
    cells = new.from_right_forward(*old.right_forward(x, y))
    turned = UncertainArray(tuple(v if spread(v) else v + 0.0 for v in cells))
    body = replace(robot.body, com_m=turned)
    return replace(robot, convention=new, wheels=wheels, body=body)
