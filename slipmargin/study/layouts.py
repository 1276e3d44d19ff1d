"""Regular layouts with any number of wheels, made from a robot's own wheel.

Ring: N wheels evenly round the origin, drives tangential, ŝ = ẑ × r̂ as in Fig. 3; an odd ring has a wheel
at the rear (N = 3 is δ = 30°), an even one a gap.  Rows: N/2 wheels a side, all driving straight ahead,
roller angles of alternating sign (the usual mecanum car; seen from above the rollers on the floor make an O).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from slipmargin.errors import InputError
from slipmargin.physics.frames import directions
from slipmargin.robot import LoadRule, Robot

#: The most wheels a layout makes.
MOST = 12


def circle_radius_m(robot: Robot) -> float:
    """Mean distance of the wheels from the body's origin [m]."""
    return float(np.mean([np.hypot(*w.position_m) for w in robot.wheels]))


def ring(robot: Robot, count: int) -> Robot:
    """The robot on a regular ring of ``count`` copies of its first wheel, on its own mean circle.

    Raises
    ------
    InputError
        For fewer than three or more than :data:`MOST` wheels, or stated load fractions.
    """
    _check("wheels", robot, count)
    first, radius = robot.wheels[0], circle_radius_m(robot)
    start = math.degrees(robot.convention.front_rad) - 180.0 + (0.0 if count % 2 else 180.0 / count)
    angles = start + 360.0 / count * np.arange(count)
    wheels = (
        replace(
            first,
            name=str(k),
            position_m=radius * directions(math.radians(angle)),
            drive_direction_deg=math.remainder(angle + 90.0, 360.0),
        )
        for k, angle in enumerate(angles.tolist(), 1)
    )
    return replace(robot, wheels=tuple(wheels))


def rows(robot: Robot, count: int) -> Robot:
    """The robot as a mecanum car: two straight rows of ``count`` / 2 wheels on its own outline.

    The roller angle is that of the first wheel, 45° where that is an omni wheel.

    Raises
    ------
    InputError
        For an odd number, fewer than four wheels, or stated load fractions.
    """
    if count % 2 or count < 4:
        raise InputError("wheels_in_rows", f"is {count}", "give an even number of wheels, 4 or more")
    _check("wheels_in_rows", robot, count)
    place = np.array([w.position_m for w in robot.wheels])
    half = np.abs(robot.convention.right_forward(*np.max(np.abs(place), axis=0)))
    angle = abs(robot.wheels[0].roller_angle_deg) or 45.0
    wheels = (
        replace(
            robot.wheels[0],
            name=f"{name}-{k + 1}",
            position_m=np.array(robot.convention.from_right_forward(side * half[0], y)),
            drive_direction_deg=math.degrees(robot.convention.front_rad),
            roller_angle_deg=side * angle * (-1.0) ** k,
        )
        for side, name in ((1.0, "right"), (-1.0, "left"))
        for k, y in enumerate(np.linspace(half[1], -half[1], count // 2))
    )
    return replace(robot, wheels=tuple(wheels))


def scaled(robot: Robot, radius_m: float) -> Robot:
    """The robot with every wheel moved along its ray from the origin to make the mean circle ``radius_m``."""
    factor = radius_m / circle_radius_m(robot)
    return replace(robot, wheels=tuple(replace(w, position_m=factor * w.position_m) for w in robot.wheels))


def _check(place: str, robot: Robot, count: int) -> None:
    if not 3 <= count <= MOST:
        raise InputError(place, f"is {count}", f"give 3 to {MOST} wheels")
    if robot.load_rule is LoadRule.FIXED:
        raise InputError(place, "does not fit stated load fractions", 'use another load model, e.g. "static"')
