"""What a study may vary: every quantity of a robot file by name, as data.

A quantity knows how to read itself off a machine and how to make the machine with another value.
Quantities are applied in the order of :data:`QUANTITIES` whatever the order they are asked in: layouts
first, so that a circle radius or a roller angle acts on the wheels that are finally there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from slipmargin.errors import InputError
from slipmargin.robot import Coefficients, GripShape, LoadRule, Motor, Robot, Surface, Wheel
from slipmargin.robot.layout import wheel_angle_deg, with_wheel_angle
from slipmargin.study.layouts import circle_radius_m, ring, rows, scaled
from slipmargin.study.machine import Machine

#: A number, or a word where the quantity is a choice.
Value = float | str


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One thing to vary.

    ``get`` raises or returns None where the machine has no such value; ``words`` are the values of a
    choice (empty: a number); ``whole`` marks counts.
    """

    key: str
    unit: str
    meaning: str
    put: Callable[[Machine, Any], Machine]
    get: Callable[[Machine], Value | None]
    words: tuple[str, ...] = ()
    whole: bool = False


def own_value(quantity: Quantity, machine: Machine) -> Value | None:
    """The machine's present value; None where it has none (δ of a four-wheeled robot)."""
    try:
        return quantity.get(machine)
    except InputError:
        return None


def _robot(change: Callable[[Robot, Any], Robot]) -> Callable[[Machine, Any], Machine]:
    return lambda machine, value: machine.with_robot(change(machine.robot, value))


def _body(field: str) -> Callable[[Machine, Any], Machine]:
    return _robot(lambda r, v: replace(r, body=replace(r.body, **{field: v})))


def _wheels(change: Callable[[Wheel, Any], Wheel]) -> Callable[[Machine, Any], Machine]:
    return _robot(lambda r, v: replace(r, wheels=tuple(change(w, v) for w in r.wheels)))


def _surfaces(change: Callable[[Surface, Any], Surface]) -> Callable[[Machine, Any], Machine]:
    return _robot(lambda r, v: replace(r, surfaces=tuple(change(s, v) for s in r.surfaces)))


def _com(axis: int) -> Callable[[Machine, Any], Machine]:
    def change(robot: Robot, value: float) -> Robot:
        com = np.array(robot.body.com_m)
        com[axis] = value
        return replace(robot, body=replace(robot.body, com_m=com))

    return _robot(change)


def _motor(field: str) -> Callable[[Machine, Any], Machine]:
    def change(robot: Robot, value: float) -> Robot:
        if robot.motor is None:
            if field != "max_speed_rad_s":
                raise InputError(field, "is given but the robot has no motor", "vary max_speed_rad_s as well")
            return replace(robot, motor=Motor(max_speed_rad_s=value))
        return replace(robot, motor=replace(robot.motor, **{field: value}))

    return _robot(change)


def _loads(robot: Robot, word: str) -> Robot:
    return replace(robot, load_rule=LoadRule(word), load_fractions=None)


def _floor(machine: Machine) -> Surface:
    return machine.robot.surface(machine.surface)


def _pair(s: Surface, **change: float) -> Surface:
    return replace(s, roller=replace(s.roller, **change))


def _signed(wheel: Wheel, size: float) -> Wheel:
    return replace(wheel, roller_angle_deg=-size if wheel.roller_angle_deg < 0.0 else size)


def _mean(field: str) -> Callable[[Machine], Value | None]:
    return lambda m: float(np.mean([abs(getattr(w, field)) for w in m.robot.wheels]))


QUANTITIES: tuple[Quantity, ...] = (
    Quantity(
        key="surface",
        unit="",
        meaning="floor, by its name in the robot file",
        put=lambda m, v: replace(m, surface=v),
        get=lambda m: m.surface,
        words=("*",),
    ),
    Quantity(
        key="wheels",
        unit="1",
        meaning="regular ring of copies of the first wheel",
        whole=True,
        put=_robot(ring),
        get=lambda m: float(len(m.robot.wheels)),
    ),
    Quantity(
        key="wheels_in_rows",
        unit="1",
        meaning="two straight rows of mecanum wheels",
        whole=True,
        put=_robot(rows),
        get=lambda m: float(len(m.robot.wheels)),
    ),
    Quantity(
        key="delta_deg",
        unit="deg",
        meaning="wheel angle δ of a three-wheel robot (Fig. 3)",
        put=_robot(with_wheel_angle),
        get=lambda m: wheel_angle_deg(m.robot),
    ),
    Quantity(
        key="circle_radius_m",
        unit="m",
        meaning="mean distance of the wheels from the origin",
        put=_robot(scaled),
        get=lambda m: circle_radius_m(m.robot),
    ),
    Quantity(
        key="roller_angle_deg",
        unit="deg",
        meaning="roller angle of every wheel, signs kept",
        put=_wheels(_signed),
        get=_mean("roller_angle_deg"),
    ),
    Quantity(
        key="wheel_radius_m",
        unit="m",
        meaning="radius of every wheel",
        put=_wheels(lambda w, v: replace(w, radius_m=v)),
        get=_mean("radius_m"),
    ),
    Quantity(
        key="rigid_fraction",
        unit="1",
        meaning="rigid share of every wheel's circumference",
        put=_wheels(lambda w, v: replace(w, rigid_fraction=v)),
        get=_mean("rigid_fraction"),
    ),
    Quantity(
        key="com_x_m",
        unit="m",
        meaning="centre of mass, to the right",
        put=_com(0),
        get=lambda m: float(m.robot.body.com_m[0]),
    ),
    Quantity(
        key="com_y_m",
        unit="m",
        meaning="centre of mass, forwards",
        put=_com(1),
        get=lambda m: float(m.robot.body.com_m[1]),
    ),
    Quantity(
        key="com_height_m",
        unit="m",
        meaning="height of the centre of mass",
        put=_body("com_height_m"),
        get=lambda m: m.robot.body.com_height_m,
    ),
    Quantity(
        key="mass_kg", unit="kg", meaning="mass", put=_body("mass_kg"), get=lambda m: m.robot.body.mass_kg
    ),
    Quantity(
        key="inertia_kg_m2",
        unit="kg m²",
        meaning="yaw inertia about the centre of mass",
        put=_body("inertia_kg_m2"),
        get=lambda m: m.robot.body.inertia_kg_m2,
    ),
    Quantity(
        key="load_model",
        unit="",
        meaning="how the weight is shared",
        put=_robot(_loads),
        get=lambda m: m.robot.load_rule.value,
        words=("equal", "static", "quasi-static"),
    ),
    Quantity(
        key="grip",
        unit="",
        meaning="set a wheel's friction force lies in",
        put=_robot(lambda r, v: replace(r, friction=replace(r.friction, grip=GripShape(v)))),
        get=lambda m: m.robot.friction.grip.value,
        words=tuple(g.value for g in GripShape),
    ),
    Quantity(
        key="k_s_per_m",
        unit="s/m",
        meaning="steepness of the friction law, eq. (11)",
        put=_robot(lambda r, v: replace(r, friction=replace(r.friction, k_s_per_m=v))),
        get=lambda m: m.robot.friction.k_s_per_m,
    ),
    Quantity(
        key="mu_drive",
        unit="1",
        meaning="drive coefficient on rollers, every surface",
        put=_surfaces(lambda s, v: _pair(s, drive=v)),
        get=lambda m: _floor(m).roller.drive,
    ),
    Quantity(
        key="mu_transverse",
        unit="1",
        meaning="transverse coefficient on rollers, every surface",
        put=_surfaces(lambda s, v: _pair(s, transverse=v)),
        get=lambda m: _floor(m).roller.transverse,
    ),
    Quantity(
        key="coefficient_ratio",
        unit="1",
        meaning="transverse over drive coefficient on rollers",
        put=_surfaces(lambda s, v: _pair(s, transverse=v * s.roller.drive)),
        get=lambda m: _floor(m).roller.transverse / _floor(m).roller.drive,
    ),
    Quantity(
        key="mu_rigid",
        unit="1",
        meaning="both coefficients on rigid material, every surface",
        put=_surfaces(lambda s, v: replace(s, rigid=Coefficients(drive=v, transverse=v))),
        get=lambda m: _floor(m).rigid.drive,
    ),
    Quantity(
        key="max_speed_rad_s",
        unit="rad/s",
        meaning="top speed of the motors",
        put=_motor("max_speed_rad_s"),
        get=lambda m: None if m.robot.motor is None else m.robot.motor.max_speed_rad_s,
    ),
    Quantity(
        key="stall_torque_N_m",
        unit="N m",
        meaning="stall torque of the motors",
        put=_motor("stall_torque_N_m"),
        get=lambda m: None if m.robot.motor is None else m.robot.motor.stall_torque_N_m,
    ),
)
