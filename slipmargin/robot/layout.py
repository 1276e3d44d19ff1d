"""The wheel angle δ of a three-wheel robot (Fig. 3), set on any robot of that layout."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipmargin.checks import real
from slipmargin.errors import InputError
from slipmargin.physics.frames import directions
from slipmargin.robot.robot import Robot, Wheel

#: How far a wheel may stand from its place in the layout, as a share of its distance [1].
_OFF = 0.02


def with_wheel_angle(robot: Robot, delta_deg: float) -> Robot:
    """The same robot with its two front wheels' axles at (±cos δ, sin δ), drive lines at δ from +Y.

    Each front wheel keeps its distance from the origin, its own turn against its axle and its sense;
    the rear wheel stays.  δ = 15° is the paper's robot, δ = 30° the symmetric one.

    Raises
    ------
    InputError
        If the robot is not one rear wheel on −Y and two front wheels mirrored about Y, or δ is not
        within −60° … 85°.
    """
    delta = real("delta_deg", delta_deg, low=-60.0, high=85.0, cure="give δ between -60 and 85 degrees")
    rear = _rear(robot)
    wheels = tuple(w if w is rear else _turned(w, math.radians(delta)) for w in robot.wheels)
    return replace(robot, wheels=wheels)


def wheel_angle_deg(robot: Robot) -> float:
    """The robot's δ: the angle of the front wheels' places above the x axis [deg].

    Raises
    ------
    InputError
        If the robot has not the layout.
    """
    rear = _rear(robot)
    right = max((w for w in robot.wheels if w is not rear), key=lambda w: float(w.position_m[0]))
    return math.degrees(math.atan2(right.position_m[1], right.position_m[0]))


def _rear(robot: Robot) -> Wheel:
    if len(robot.wheels) == 3:
        rear = min(robot.wheels, key=lambda w: float(w.position_m[1]))
        one, two = (w.position_m for w in robot.wheels if w is not rear)
        size = float(np.hypot(*rear.position_m))
        mirrored = float(np.hypot(one[0] + two[0], one[1] - two[1])) <= _OFF * float(np.hypot(*one))
        if abs(rear.position_m[0]) <= _OFF * size and rear.position_m[1] < 0.0 and mirrored:
            return rear
    raise InputError(
        "delta_deg",
        f"means nothing for robot {robot.name!r}",
        "give a robot with a rear wheel on −Y and two front wheels mirrored about Y",
    )


def _turned(wheel: Wheel, delta: float) -> Wheel:
    old = math.atan2(wheel.position_m[1], wheel.position_m[0])
    new = delta if wheel.position_m[0] > 0.0 else math.pi - delta
    drive = wheel.drive_direction_deg + math.degrees(new - old)
    return replace(
        wheel,
        position_m=float(np.hypot(*wheel.position_m)) * directions(new),
        drive_direction_deg=math.remainder(drive, 360.0),
    )
