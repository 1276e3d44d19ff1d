"""Angles of the wheels: δ of a three-wheel robot (Fig. 3), front and rear angle of a four-wheel one."""

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
    """The same robot with its two front wheels' axles at (±cos δ, sin δ) to the right and forwards.

    Their drive lines then stand at δ from straight ahead.  Each front wheel keeps its distance from the
    origin, its own turn against its axle and its sense; the rear wheel stays.  δ = 15° is the paper's robot,
    δ = 30° the symmetric one.

    Raises
    ------
    InputError
        If the robot is not one wheel at the rear and two front wheels mirrored, or δ is not
        within −60° … 85°.
    """
    delta = real("delta_deg", delta_deg, low=-60.0, high=85.0, cure="give δ between -60 and 85 degrees")
    rear = _rear(robot)
    wheels = tuple(w if w is rear else _turned(robot, w, math.radians(delta)) for w in robot.wheels)
    return replace(robot, wheels=wheels)


def wheel_angle_deg(robot: Robot) -> float:
    """The robot's δ: the angle of the front wheels' places ahead of the line across the robot [deg].

    Raises
    ------
    InputError
        If the robot has not the layout.
    """
    rear = _rear(robot)
    right, ahead = max(_place(robot, w) for w in robot.wheels if w is not rear)
    return math.degrees(math.atan2(ahead, right))


def with_pair_angle(robot: Robot, angle_deg: float, *, front: bool) -> Robot:
    """The same robot with its two front (or rear) wheels at an angle from straight ahead (or behind).

    Each wheel of the pair keeps its distance from the origin and its own turn against its axle.

    Raises
    ------
    InputError
        If the robot is not two front and two rear omni wheels, each pair mirrored, or the angle is not
        within 5° … 85°.
    """
    name = _pair_name(front)
    angle = real(name, angle_deg, low=5.0, high=85.0, cure="give an angle between 5 and 85 degrees")
    pair = _pair(robot, front)
    ahead = 0.5 * math.pi - math.radians(angle)  # from the line across the robot
    new = ahead if front else -ahead
    wheels = tuple(_turned(robot, w, new) if any(w is one for one in pair) else w for w in robot.wheels)
    return replace(robot, wheels=wheels)


def pair_angle_deg(robot: Robot, *, front: bool) -> float:
    """Angle of the front (rear) wheels' places from straight ahead (behind) [deg].

    Raises
    ------
    InputError
        If the robot has not the layout.
    """
    right, ahead = max(_place(robot, w) for w in _pair(robot, front))
    return math.degrees(math.atan2(right, abs(ahead)))


def _pair_name(front: bool) -> str:
    return "front_angle_deg" if front else "rear_angle_deg"


def _pair(robot: Robot, front: bool) -> tuple[Wheel, Wheel]:
    """The two wheels ahead of (or behind) the origin, mirrored about the line ahead."""
    places = [(w, *_place(robot, w)) for w in robot.wheels]
    omni = all(w.roller_angle_deg == 0.0 for w in robot.wheels)
    for side in (1.0, -1.0):
        pair = [(w, x, y) for w, x, y in places if side * y > 0.0]
        if len(places) != 4 or len(pair) != 2 or not omni:
            break
        (one, x, y), (two, u, v) = pair
        if math.hypot(x + u, y - v) > _OFF * math.hypot(x, y):
            break
        if (side > 0.0) is front:
            return one, two
    raise InputError(
        _pair_name(front),
        f"means nothing for robot {robot.name!r}",
        "give a robot with two front and two rear omni wheels, each pair mirrored about the line ahead",
    )


def _rear(robot: Robot) -> Wheel:
    if len(robot.wheels) == 3:
        rear = min(robot.wheels, key=lambda w: _place(robot, w)[1])
        one, two = (_place(robot, w) for w in robot.wheels if w is not rear)
        right, ahead = _place(robot, rear)
        mirrored = math.hypot(one[0] + two[0], one[1] - two[1]) <= _OFF * math.hypot(*one)
        if abs(right) <= _OFF * math.hypot(right, ahead) and ahead < 0.0 and mirrored:
            return rear
    raise InputError(
        "delta_deg",
        f"means nothing for robot {robot.name!r}",
        "give a robot with one wheel at the rear and two front wheels mirrored about the line ahead",
    )


def _place(robot: Robot, wheel: Wheel) -> tuple[float, float]:
    """Where a wheel stands: to the right and forwards [m]."""
    right, ahead = robot.convention.right_forward(*wheel.position_m)
    return float(right), float(ahead)


def _turned(robot: Robot, wheel: Wheel, delta: float) -> Wheel:
    right, ahead = _place(robot, wheel)
    old = math.atan2(ahead, right)
    new = delta if right > 0.0 else math.pi - delta
    place = np.array(robot.convention.from_right_forward(*directions(new)))
    drive = wheel.drive_direction_deg + math.degrees(new - old)
    return replace(
        wheel,
        position_m=math.hypot(right, ahead) * place,
        drive_direction_deg=math.remainder(drive, 360.0),
    )
