"""What a URDF tells of a robot as a draft of a robot file, and the list of what it cannot tell."""

from __future__ import annotations

import math

import numpy as np

from slipmargin.io.urdf_file import UrdfRobot, UrdfWheel
from slipmargin.physics.frames import moment
from slipmargin.report.robot_draft import GUESS, Draft, Value

_URDF = "URDF"


def urdf_draft(name: str, robot: UrdfRobot) -> tuple[Draft, list[str]]:
    """The draft, and a line for each thing that the URDF does not say."""
    unknown = list(robot.notes)
    middle = np.mean([w.place_m[:2] for w in robot.wheels], axis=0)
    reach = float(np.max([math.hypot(*(w.place_m[:2] - middle)) for w in robot.wheels]))
    radii = [_radius(w, robot, unknown) for w in robot.wheels]
    height = _height(robot, float(np.mean([r.value for r in radii])), unknown)
    rollers = [_roller(w, robot, middle) for w in robot.wheels]
    guessed = [w.name for w, r in zip(robot.wheels, rollers, strict=True) if r.said.startswith(GUESS)]
    if guessed:
        unknown.append(
            f"roller_angle_deg of {', '.join(guessed)}: guessed, the file has no rollers (0 for omni wheels, "
            "±45 for wheels that all drive the same way)"
        )
    unknown.append("rigid_fraction, and how many rollers, unless they are joints of the file")
    unknown.append("the friction coefficients of your floor, and how the weight is shared")
    motor = _motor(robot, unknown)
    wheels = [
        {
            "name": Value(value=w.name, said=""),
            "position_m": Value(value=_short(w.place_m[:2]), said=f"{_URDF}, from {robot.frame}"),
            "drive_direction_deg": Value(
                value=round(w.drive_deg, 6) + 0.0, said=f"{_URDF}: joint axis × up; the joint's sign"
            ),
            "radius_m": radius,
            "roller_angle_deg": roller,
            "rollers": Value(value=w.rollers, said=_URDF)
            if w.rollers
            else Value(value=10, said=f"{GUESS}; count them"),
            "rigid_fraction": Value(value=0.0, said=f"{GUESS}; share of rigid rim between rollers"),
        }
        for w, radius, roller in zip(robot.wheels, radii, rollers, strict=True)
    ]
    return (
        Draft(
            name=name,
            head=(
                f"Made from the URDF of {robot.name}; values marked {_URDF} are from there.",
                f"Values marked {GUESS} are not: the file cannot say them.",
                "`slipmargin robots check FILE --plot robot.png` says what each wheel does.",
            ),
            body=_body(robot, height, reach, unknown),
            motor=motor,
            wheels=wheels,
        ),
        unknown,
    )


def _short(values: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(v), 6) + 0.0 for v in values)


def _body(robot: UrdfRobot, height: Value, reach: float, unknown: list[str]) -> dict[str, Value]:
    if robot.mass_kg <= 0.0:
        unknown.append("mass, inertia and centre of mass: no link has an <inertial>")
        middle = np.mean([w.place_m[:2] for w in robot.wheels], axis=0)
        return {
            "mass_kg": Value(value=10.0),
            "inertia_kg_m2": Value(value=round(5.0 * reach**2, 6)),
            "com_m": Value(value=_short(middle)),
            "com_height_m": height,
        }
    inertia = Value(value=float(f"{robot.inertia_kg_m2:.6g}"), said=f"{_URDF}, all links, about com_m")
    if robot.inertia_kg_m2 <= 0.0:
        unknown.append("inertia: the links' tensors are zero")
        inertia = Value(value=float(f"{0.5 * robot.mass_kg * reach**2:.6g}"), said=f"{GUESS}; a uniform disc")
    return {
        "mass_kg": Value(value=float(f"{robot.mass_kg:.6g}"), said=f"{_URDF}, all links"),
        "inertia_kg_m2": inertia,
        "com_m": Value(value=_short(robot.com_m[:2]), said=f"{_URDF}; forward, left of {robot.frame}"),
        "com_height_m": height,
    }


def _radius(wheel: UrdfWheel, robot: UrdfRobot, unknown: list[str]) -> Value:
    if wheel.radius_m is not None:
        return Value(value=round(wheel.radius_m, 6), said=_URDF)
    if robot.floor_z_m is not None and wheel.place_m[2] > robot.floor_z_m:
        return Value(
            value=round(float(wheel.place_m[2]) - robot.floor_z_m, 6), said=f"{_URDF}: height of its axle"
        )
    unknown.append(f"radius of {wheel.name}: its link has no cylinder or sphere (a mesh is not measured)")
    return Value(value=0.05, said=f"{GUESS}; measure it")


def _height(robot: UrdfRobot, radius_m: float, unknown: list[str]) -> Value:
    if robot.mass_kg <= 0.0:
        return Value(value=round(2.0 * radius_m, 6))
    floor = robot.floor_z_m
    if floor is None:
        floor = float(np.mean([w.place_m[2] for w in robot.wheels])) - radius_m
    height = float(robot.com_m[2]) - floor
    if height < 0.0:
        unknown.append(
            f"height of the centre of mass: the links' masses put it {-height:.3g} m below the floor"
        )
        return Value(value=round(2.0 * radius_m, 6))
    return Value(value=round(height, 6), said=f"{_URDF}, above the floor")


def _roller(wheel: UrdfWheel, robot: UrdfRobot, middle: np.ndarray) -> Value:
    if wheel.roller_deg is not None:
        return Value(value=round(wheel.roller_deg, 4) + 0.0, said=f"{_URDF}: axis of its lowest roller")
    first = math.radians(robot.wheels[0].drive_deg)
    way = [math.radians(w.drive_deg) - first for w in robot.wheels]
    if len(robot.wheels) < 4 or any(abs(math.sin(w)) > 1e-3 for w in way):
        return Value(value=0.0, said=f"{GUESS}: an omni wheel")
    ahead, left = (float(v) for v in wheel.place_m[:2] - middle)
    levers = {}
    for sign in (1.0, -1.0):
        grip = math.radians(wheel.drive_deg + 45.0 * sign)
        levers[sign] = abs(moment(ahead, left, math.cos(grip), math.sin(grip)))
    sign = max(levers, key=lambda s: levers[s])  # rollers on the floor make an O
    return Value(value=45.0 * sign, said=f"{GUESS}: a mecanum wheel, rollers on the floor make an O")


def _motor(robot: UrdfRobot, unknown: list[str]) -> dict[str, Value]:
    speeds = [w.max_speed_rad_s for w in robot.wheels]
    torques = [w.max_torque_N_m for w in robot.wheels]
    if any(v is None for v in speeds):
        unknown.append(
            "the motors' top speed (and torque): the wheel joints have no <limit>; add a [motor] table"
        )
        return {}
    motor = {
        "max_speed_rad_s": Value(value=min(v for v in speeds if v is not None), said=f"{_URDF}: joint limit")
    }
    if all(v is not None for v in torques):
        motor["stall_torque_N_m"] = Value(
            value=min(v for v in torques if v is not None), said=f"{_URDF}: joint limit (effort)"
        )
    else:
        unknown.append("the motors' stall torque: the wheel joints' <limit> has no effort")
    return motor
