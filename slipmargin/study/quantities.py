"""The quantities that a study may vary, by name.

A quantity has a function that reads it from a design and one that returns the design with another value.
A key of the robot file that ``--vary`` sets directly is described by its
:class:`~slipmargin.robot.fields.Key`; this file lists those that act on several keys at once.

Quantities are applied in the order of :data:`QUANTITIES` whatever the order they are asked in: layouts
first, so that a circle radius or a roller angle acts on the wheels that are finally there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from typing import Any, final

import numpy as np

from slipmargin.errors import InputError
from slipmargin.robot import Coefficients, LoadRule, Robot, Surface
from slipmargin.robot.fields import Key, Kind, keys
from slipmargin.robot.layout import pair_angle_deg, wheel_angle_deg, with_pair_angle, with_wheel_angle
from slipmargin.robot.sections import SECTIONS, Section
from slipmargin.study.layouts import circle_radius_m, ring, rows, scaled
from slipmargin.study.robot_on_surface import RobotOnSurface

#: A number, or a word where the quantity is a choice.
Value = float | str


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One thing to vary.

    ``get`` raises or returns None where the design has no such value; ``words`` are the values of a
    choice (empty: a number); ``whole`` marks counts.
    """

    key: str
    unit: str
    meaning: str
    put: Callable[[RobotOnSurface, Any], RobotOnSurface]
    get: Callable[[RobotOnSurface], Value | None]
    words: tuple[str, ...] = ()
    whole: bool = False


def own_value(quantity: Quantity, design: RobotOnSurface) -> Value | None:
    """The design's present value; None where it has none (δ of a four-wheeled robot)."""
    try:
        return quantity.get(design)
    except InputError:
        return None


def _robot(change: Callable[[Robot, Any], Robot]) -> Callable[[RobotOnSurface, Any], RobotOnSurface]:
    return lambda design, value: design.with_robot(change(design.robot, value))


def _surfaces(change: Callable[[Surface, Any], Surface]) -> Callable[[RobotOnSurface, Any], RobotOnSurface]:
    return _robot(lambda r, v: replace(r, surfaces=tuple(change(s, v) for s in r.surfaces)))


def _com(axis: int) -> Callable[[RobotOnSurface, Any], RobotOnSurface]:
    def change(robot: Robot, value: float) -> Robot:
        com = np.array(robot.body.com_m)
        com[axis] = value
        return replace(robot, body=replace(robot.body, com_m=com))

    return _robot(change)


def _loads(robot: Robot, word: str) -> Robot:
    return replace(robot, load_rule=LoadRule(word), load_fractions=None)


def _floor(design: RobotOnSurface) -> Surface:
    return design.robot.surface(design.surface)


def _pair(s: Surface, **change: float) -> Surface:
    return replace(s, roller=replace(s.roller, **change))


def _roller_angles(robot: Robot, size: float) -> Robot:
    if size < 0.0:
        raise InputError(
            "roller_angle_deg",
            f"is {size:g}, and each wheel keeps the sign that the file gives it",
            "give sizes from 0",
        )
    signs = (-1.0 if w.roller_angle_deg < 0.0 else 1.0 for w in robot.wheels)
    pairs = zip(robot.wheels, signs, strict=True)
    return replace(robot, wheels=tuple(replace(w, roller_angle_deg=sign * size) for w, sign in pairs))


def _pair_angle(robot: Robot, angle_deg: float, *, front: bool) -> Robot:
    return with_pair_angle(robot, angle_deg, front=front)


def _own_pair_angle(design: RobotOnSurface, *, front: bool) -> Value:
    return pair_angle_deg(design.robot, front=front)


def _mean_size(field: str) -> Callable[[RobotOnSurface], Value]:
    return lambda m: float(np.mean([abs(getattr(w, field)) for w in m.robot.wheels]))


def _from_file(section: Section, field: str, key: Key, name: str) -> Quantity:
    """The quantity that sets one key of the file: of every wheel where it is a wheel's."""

    def put(robot: Robot, value: Any) -> Robot:
        value = key.from_word(value) if key.kind is Kind.WORD else value
        part = getattr(robot, section.path)
        if part is None:
            missing = [k.name for f, k in keys(section.kind).items() if k.required and f != field]
            if missing:
                problem = f"is given but the robot has no {section.path}"
                raise InputError(key.name, problem, f"vary {', '.join(missing)} as well")
            new: Any = section.kind(**{field: value})
        elif isinstance(part, tuple):
            new = tuple(replace(one, **{field: value}) for one in part)
        else:
            new = replace(part, **{field: value})
        change: dict[str, Any] = {section.path: new}
        return replace(robot, **change)

    def get(design: RobotOnSurface) -> Value | None:
        part = getattr(design.robot, section.path)
        if isinstance(part, tuple):
            return float(np.mean([getattr(p, field) for p in part]))
        value: Value | Enum | None = getattr(part, field) if part is not None else None
        return value.value if isinstance(value, Enum) else value

    meaning = f"{key.meaning}, every wheel" if section.path == "wheels" else key.meaning
    return Quantity(key=name, unit=key.unit, meaning=meaning, put=_robot(put), get=get, words=key.choices)


#: What a study does to the wheels and the floor as a whole.
_LAYOUTS = (
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
    *(
        Quantity(
            key=f"{word}_angle_deg",
            unit="deg",
            meaning=f"{word} wheels' angle from straight {where}, four omni wheels",
            put=_robot(partial(_pair_angle, front=word == "front")),
            get=partial(_own_pair_angle, front=word == "front"),
        )
        for word, where in (("front", "ahead"), ("rear", "behind"))
    ),
    Quantity(
        key="circle_radius_m",
        unit="m",
        meaning="mean distance of the wheels from the origin",
        put=_robot(scaled),
        get=lambda m: circle_radius_m(m.robot),
    ),
)
#: What acts on parts of keys, or on several keys.
_COMBINED = (
    Quantity(
        key="roller_angle_deg",
        unit="deg",
        meaning="roller angle of every wheel, signs kept",
        put=_robot(_roller_angles),
        get=_mean_size("roller_angle_deg"),
    ),
    Quantity(
        key="com_x_m",
        unit="m",
        meaning="centre of mass along the body's x",
        put=_com(0),
        get=lambda m: float(m.robot.body.com_m[0]),
    ),
    Quantity(
        key="com_y_m",
        unit="m",
        meaning="centre of mass along the body's y",
        put=_com(1),
        get=lambda m: float(m.robot.body.com_m[1]),
    ),
    Quantity(
        key="load_model",
        unit="",
        meaning="how the weight is shared",
        put=_robot(_loads),
        get=lambda m: m.robot.load_rule.value,
        words=tuple(r.value for r in LoadRule if r is not LoadRule.FIXED),
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
)
_OWN = {q.key for q in (*_LAYOUTS, *_COMBINED)}
#: Every quantity by name, in the order in which they are applied.
QUANTITIES: tuple[Quantity, ...] = (
    *_LAYOUTS,
    *(
        _from_file(section, field, key, name)
        for section in SECTIONS
        for field, key in keys(section.kind, section.table).items()
        for name in key.vary
        if name not in _OWN
    ),
    *_COMBINED,
)
