"""Kinds of robots that people build, each as a draft of a robot file with typical values marked as guesses.

Sources: LeKiwi's wheel order, places, radius and top speed are those of its driver (LeRobot, ``lekiwi.py``:
wheels left, back, right at 240°, 0° and 120° less 90°, radius 0.05 m, 0.125 m from the centre, 3000 of 4096
steps a second); the mecanum car's rollers are mounted as in Lynch and Park, Modern Robotics, section 13.2.
All other numbers are typical of such robots and nobody measured them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, final

from slipmargin.report.robot_draft import GUESS, Draft, Value

#: Where each wheel is from its robot's centre: angle from the front, counter-clockwise [deg], and name.
_Ring = Sequence[tuple[float, str]]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RobotType:
    """A kind of robot: what it is, and its typical numbers [kg, m, rad/s, N m]."""

    said: str
    mass_kg: float
    com_height_m: float
    wheel_radius_m: float
    rollers: int
    max_speed_rad_s: float
    stall_torque_N_m: float
    reach_m: float
    ring: _Ring = ()  #: omni wheels, driving at right angles to their axle; else a mecanum car
    known: str = ""  #: where wheel radius, places and speed are from, if they are no guesses


_DIAGONAL = ((45.0, "fl"), (-45.0, "fr"), (135.0, "rl"), (-135.0, "rr"))

TYPES = {
    "lekiwi": RobotType(
        said="LeKiwi: three omni wheels 120° apart, one at the rear (wheel order of its driver)",
        mass_kg=4.0,
        com_height_m=0.1,
        wheel_radius_m=0.05,
        rollers=10,
        max_speed_rad_s=4.6,
        stall_torque_N_m=1.6,
        reach_m=0.125,
        ring=((60.0, "left"), (180.0, "back"), (-60.0, "right")),
        known="as its driver has it",
    ),
    "kiwi": RobotType(
        said="Kiwi drive: three omni wheels 120° apart, one at the rear",
        mass_kg=5.0,
        com_height_m=0.06,
        wheel_radius_m=0.03,
        rollers=10,
        max_speed_rad_s=30.0,
        stall_torque_N_m=0.8,
        reach_m=0.12,
        ring=((60.0, "left"), (-60.0, "right"), (180.0, "rear")),
    ),
    "xdrive": RobotType(
        said="X-drive: four omni wheels at the corners, axles towards the middle",
        mass_kg=12.0,
        com_height_m=0.1,
        wheel_radius_m=0.048,
        rollers=10,
        max_speed_rad_s=32.0,
        stall_torque_N_m=2.3,
        reach_m=0.2,
        ring=_DIAGONAL,
    ),
    "mecanum": RobotType(
        said="Mecanum car: four wheels straight ahead, rollers at 45° (from above an X, on the floor an O)",
        mass_kg=12.0,
        com_height_m=0.1,
        wheel_radius_m=0.052,
        rollers=10,
        max_speed_rad_s=32.0,
        stall_torque_N_m=2.3,
        reach_m=0.0,
    ),
    "ssl": RobotType(
        said="RoboCup small size robot: four omni wheels, front ones 60° and rear ones 135° from the front",
        mass_kg=2.6,
        com_height_m=0.04,
        wheel_radius_m=0.0275,
        rollers=18,
        max_speed_rad_s=120.0,
        stall_torque_N_m=0.3,
        reach_m=0.08,
        ring=((60.0, "fl"), (-60.0, "fr"), (135.0, "rl"), (-135.0, "rr")),
    ),
}

_CAR = (("fl", 1.0, 1.0), ("fr", 1.0, -1.0), ("rl", -1.0, 1.0), ("rr", -1.0, -1.0))


def draft_of(name: str, kind: RobotType) -> Draft:
    """The draft of a robot of a type."""
    wheels = _ring(kind) if kind.ring else _car(kind)
    reach = kind.reach_m or 0.22
    return Draft(
        name=name,
        head=(
            f"{kind.said}.",
            f"Values marked {GUESS} are typical of such a robot; nobody measured them on yours.",
            "After each change: `slipmargin robots check FILE --plot robot.png` says what each wheel does.",
        ),
        body={
            "mass_kg": Value(value=kind.mass_kg, said=f"{GUESS}; MEASURE FIRST (3)"),
            "inertia_kg_m2": Value(
                value=round(0.5 * kind.mass_kg * reach**2, 4), said=f"{GUESS}; a uniform disc of that mass"
            ),
            "com_m": Value(value=(0.0, 0.0), said=f"{GUESS}; forward, left; MEASURE FIRST (2)"),
            "com_height_m": Value(
                value=kind.com_height_m, said=f"{GUESS}; above the floor; MEASURE FIRST (2)"
            ),
        },
        motor={
            "max_speed_rad_s": Value(value=kind.max_speed_rad_s, said=kind.known or f"{GUESS}; without load"),
            "stall_torque_N_m": Value(value=kind.stall_torque_N_m, said=f"{GUESS}; data sheet of the motor"),
        },
        wheels=wheels,
    )


def _ring(kind: RobotType) -> list[dict[str, Value]]:
    found = []
    for angle, name in kind.ring:
        way = math.radians(angle)
        place = tuple(round(kind.reach_m * f(way), 5) + 0.0 for f in (math.cos, math.sin))
        drive = math.remainder(angle + 90.0, 360.0)
        found.append(
            _wheel(kind, name, place, drive, 0.0, "omni: a positive speed turns the robot to the left")
        )
    return found


def _car(kind: RobotType) -> list[dict[str, Value]]:
    return [
        _wheel(kind, name, (0.17 * ahead, 0.15 * left), 0.0, -45.0 * ahead * left, "mecanum")
        for name, ahead, left in _CAR
    ]


def _wheel(
    kind: RobotType, name: str, place: Any, drive: float, roller: float, said: str
) -> dict[str, Value]:
    where = kind.known or f"{GUESS}; forward, left of the centre"
    return {
        "name": Value(value=name, said=""),
        "position_m": Value(value=place, said=where),
        "drive_direction_deg": Value(value=drive, said="where a positive speed drives; 0 is forwards"),
        "radius_m": Value(value=kind.wheel_radius_m, said=kind.known or GUESS),
        "roller_angle_deg": Value(value=roller, said=said),
        "rollers": Value(value=kind.rollers, said=f"{GUESS}; count them"),
        "rigid_fraction": Value(value=0.0, said="share of rigid rim between rollers; 0 for two rows"),
    }
