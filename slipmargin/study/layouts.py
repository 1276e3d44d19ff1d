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
from slipmargin.robot import LoadRule, Robot, Wheel

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
    radius, start = circle_radius_m(robot), -90.0 if count % 2 else -90.0 + 180.0 / count
    wheels = []
    for k in range(count):
        angle = math.radians(start + 360.0 * k / count)
        place = radius * np.array([math.cos(angle), math.sin(angle)])
        wheels.append(
            _copy(
                robot.wheels[0],
                str(k + 1),
                place,
                math.degrees(angle) + 90.0,
                robot.wheels[0].roller_angle_deg,
            )
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
    half = np.max(np.abs(place), axis=0)
    angle = abs(robot.wheels[0].roller_angle_deg) or 45.0
    wheels = []
    for side, name in ((1.0, "right"), (-1.0, "left")):
        for k, y in enumerate(np.linspace(half[1], -half[1], count // 2)):
            sign = side * (1.0 if k % 2 == 0 else -1.0)
            wheels.append(
                _copy(robot.wheels[0], f"{name}-{k + 1}", np.array([side * half[0], y]), 90.0, sign * angle)
            )
    return replace(robot, wheels=tuple(wheels))


def scaled(robot: Robot, radius_m: float) -> Robot:
    """The robot with every wheel moved along its ray from the origin to make the mean circle ``radius_m``."""
    factor = radius_m / circle_radius_m(robot)
    return replace(robot, wheels=tuple(replace(w, position_m=factor * w.position_m) for w in robot.wheels))


def _copy(
    wheel: Wheel,
    name: str,
    place: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    drive_deg: float,
    roller_deg: float,
) -> Wheel:
    return replace(
        wheel,
        name=name,
        position_m=place,
        drive_direction_deg=math.remainder(drive_deg, 360.0),
        roller_angle_deg=roller_deg,
    )


def _check(place: str, robot: Robot, count: int) -> None:
    if not 3 <= count <= MOST:
        raise InputError(place, f"is {count}", f"give 3 to {MOST} wheels")
    if robot.load_rule is LoadRule.FIXED:
        raise InputError(place, "does not fit stated load fractions", 'use another load model, e.g. "static"')
