"""Sentences for numbers that a robot hardly has: the slips that people make when they type a robot file.

What no robot can have is refused when the file is read (:func:`refuse_impossible`); what is only unlikely
is read and answered with a warning (:func:`unlikely`).  Each sentence gives the number and the cure.
"""

from __future__ import annotations

import math

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.robot.robot import Robot, radians_cure, roller_levers

#: Wheel distance over wheel radius: 2 to 10 for most robots; a slip of mm for m makes it 1000 times that.
_FAR, _TOO_FAR = 40.0, 400.0
#: Wheel radius over wheel distance: below 1 unless wheels overlap.
_WIDE, _TOO_WIDE = 1.5, 40.0
#: Radius of gyration over wheel distance: 0.71 for a uniform disc with its wheels at the rim.
_GYRATION, _NO_GYRATION = (0.1, 4.0), (0.005, 200.0)
#: Height of the centre of mass over the wheels' distance.
_TALL, _TOO_TALL = 4.0, 200.0
#: Above this a friction coefficient is more than dry rubber has on a rough floor [1].
_STICKY = 1.5
#: Cosine of the angle to straight ahead below which a wheel drives to the side: within 6° [1].
_SIDEWAYS = 0.1
#: A roller whose grip line passes nearer to the centre than this share of its mirror image's [1].
_SHORT_LEVER = 0.9
#: Above this speed of a wheel's rim a top speed was in turns per minute [m/s].
_FAST_M_S = 8.0
#: Below this fastest speed a motion's times may be in milliseconds [m/s].
_SLOW_M_S = 0.01
#: Above this push over weight a torque was in other units: the strongest robots' motors push 5 times it [1].
_STRONG = 10.0
#: What asks for so many times the grip is a mistake of units or of time stamps [1].
ABSURD_USE = 1e4
#: A pull with more than this is no robot's: the weight of 100 000 t [N].
LARGEST_PULL_N = 1e9


def reach_m(robot: Robot) -> float:
    """The largest distance of a wheel from the wheels' mean position [m]."""
    place = robot.geometry.position_m
    return float(np.max(np.linalg.norm(place - place.mean(axis=0), axis=1)))


def refuse_impossible(robot: Robot) -> None:
    """Refuse sizes that no robot has.

    Raises
    ------
    InputError
        Placed at the key, with the number and the cure.
    """
    reach = reach_m(robot)
    for i, wheel in enumerate(robot.wheels, 1):
        if reach > _TOO_FAR * wheel.radius_m:
            raise InputError(
                f"wheel[{i}].position_m",
                f"puts the wheels {reach:.3g} m from their middle, {reach / wheel.radius_m:.0f} radii",
                "give positions and radii in metres, not millimetres",
            )
        if wheel.radius_m > _TOO_WIDE * reach:
            raise InputError(
                f"wheel[{i}].radius_m",
                f"is {wheel.radius_m:g} m, but the wheels stand {reach:g} m from their middle",
                "give positions and radii in metres, not millimetres",
            )
    gyration = _gyration_m(robot)
    low, high = _NO_GYRATION
    if not low * reach <= gyration <= high * reach:
        raise InputError(
            "body.inertia_kg_m2",
            _spread_of_mass(robot),
            f"give kg, m and kg m²; a uniform disc has {_disc(robot, reach):.3g} kg m²",
        )
    if robot.body.com_height_m > _TOO_TALL * reach:
        raise InputError(
            "body.com_height_m",
            f"is {robot.body.com_height_m:g} m, but the wheels stand {reach:.3g} m from their middle",
            "give the height in metres, not millimetres",
        )


def unlikely(robot: Robot) -> list[str]:
    """One sentence for each number that a robot hardly has."""
    return [
        *_sideways(robot),
        *_radians(robot),
        *_rollers(robot),
        *_sizes(robot),
        *_mass(robot),
        *_sticky(robot),
        *_motor(robot),
    ]


def unlikely_motion(velocity: Array, reach_m: float) -> tuple[str, ...]:
    """Sentences for the units of a motion at (T, 3) velocities; wheels stand ``reach_m`` from the middle."""
    turning = reach_m * float(np.max(np.abs(velocity[:, 2]), initial=0.0))
    fastest = max(float(np.max(np.hypot(velocity[:, 0], velocity[:, 1]), initial=0.0)), turning)
    if turning > _FAST_M_S:
        rate = turning / reach_m
        return (
            f"phi_rad: turns at up to {rate:.3g} rad/s; if it is in degrees, write radians: times 0.01745",
        )
    if 0.0 < fastest < _SLOW_M_S:
        return (
            f"t_s: nothing moves faster than {1e3 * fastest:.3g} mm/s; if the times are in milliseconds, "
            "write seconds: times 0.001",
        )
    return ()


def _sideways(robot: Robot) -> list[str]:
    """A car whose mecanum wheels all drive to the side: its axes are those of the other convention."""
    front = math.degrees(robot.convention.front_rad)
    ahead = [math.cos(math.radians(w.drive_direction_deg - front)) for w in robot.wheels]
    if any(w.roller_angle_deg == 0.0 for w in robot.wheels) or max(map(abs, ahead)) > _SIDEWAYS:
        return []
    x, y = robot.convention.axes
    other = next(c for c in type(robot.convention) if c is not robot.convention)
    return [
        f'wheel: every mecanum wheel drives to the side, as convention = "{robot.convention.value}" has '
        f'+x {x} and +y {y}; write convention = "{other.value}" if +x is {other.axes[0]} in this file'
    ]


def _radians(robot: Robot) -> list[str]:
    cure = radians_cure(robot.wheels)
    return [f"wheel: roller_angle_deg looks like radians; {cure}"] if cure else []


def _rollers(robot: Robot) -> list[str]:
    own, mirrored = (np.abs(lever) for lever in roller_levers(robot.wheels))
    wrong = own < _SHORT_LEVER * mirrored
    if not np.any(wrong):
        return []
    worst = int(np.argmax(np.where(wrong, mirrored - own, -np.inf)))
    names = ", ".join(w.name for w, bad in zip(robot.wheels, wrong, strict=True) if bad)
    return [
        f"wheel {names}: rollers mounted the wrong way round? The grip line of {robot.wheels[worst].name} "
        f"passes {own[worst]:.3g} m from the wheels' middle, mirrored {mirrored[worst]:.3g} m, so the wheels "
        "hold little yaw; change the sign of roller_angle_deg (from above, rollers on the floor make an O)"
    ]


def _sizes(robot: Robot) -> list[str]:
    reach = reach_m(robot)
    height = robot.body.com_height_m
    small, large = (pick(w.radius_m for w in robot.wheels) for pick in (min, max))
    if reach > _FAR * small:
        return [
            f"wheel: the wheels stand {reach:.3g} m from their middle, {reach / small:.0f} times the "
            f"radius of {small:g} m; give both in metres"
        ]
    if large > _WIDE * reach:
        return [
            f"wheel: the radius of {large:g} m exceeds the wheels' distance from their middle, "
            f"{reach:.3g} m; give both in metres"
        ]
    if height > _TALL * reach:
        return [
            f"body.com_height_m: {height:g} m is {height / reach:.1f} times the wheels' distance from their "
            f"middle, so the robot tips at {GRAVITY_M_S2 * reach / height:.2g} m/s² at most; "
            "give the height in metres"
        ]
    return []


def _mass(robot: Robot) -> list[str]:
    reach, gyration = reach_m(robot), _gyration_m(robot)
    low, high = _GYRATION
    if low * reach <= gyration <= high * reach:
        return []
    return [
        f"body: {_spread_of_mass(robot)}; a uniform disc of that mass has {_disc(robot, reach):.3g} kg m²: "
        "check mass_kg (in kg) and inertia_kg_m2"
    ]


def _sticky(robot: Robot) -> list[str]:
    return [
        f"surface.{surface.name}.{key}.{name}: a friction coefficient of {value:g} is more than dry rubber "
        "has on a rough floor (about 1.2); give pulling force over weight"
        for surface in robot.surfaces
        for key, pair in (("roller", surface.roller), ("rigid", surface.rigid))
        for name, value in (("drive", pair.drive), ("transverse", pair.transverse))
        if value > _STICKY
    ]


def _motor(robot: Robot) -> list[str]:
    if robot.motor is None:
        return []
    speed, stall, _ = robot.motor.at_the_wheel()
    torque, stated = 0.0 if stall is None else stall, robot.motor.max_speed_rad_s
    rim = speed * max(w.radius_m for w in robot.wheels)
    said = []
    if rim > _FAST_M_S:
        said.append(
            f"motor.max_speed_rad_s: {stated:.4g} rad/s moves a wheel's rim at {rim:.3g} m/s; if it is in "
            f"turns per minute, write {stated * math.pi / 30.0:.4g}"
        )
    push = sum(torque / w.radius_m for w in robot.wheels) / (robot.body.mass_kg * GRAVITY_M_S2)
    if push > _STRONG:
        said.append(
            f"motor.stall_torque_N_m: {robot.motor.stall_torque_N_m:.4g} N m push with {push:.3g} times the "
            "robot's weight; give N m: kg cm times 0.0981, oz in times 0.00706"
        )
    return said


def _spread_of_mass(robot: Robot) -> str:
    return (
        f"{robot.body.inertia_kg_m2:g} kg m² with {robot.body.mass_kg:g} kg puts the mass "
        f"{_gyration_m(robot):.3g} m from the centre, but the wheels stand {reach_m(robot):.3g} m from "
        "their middle"
    )


def _gyration_m(robot: Robot) -> float:
    return math.sqrt(robot.body.inertia_kg_m2 / robot.body.mass_kg)


def _disc(robot: Robot, reach: float) -> float:
    return 0.5 * robot.body.mass_kg * reach**2
