"""What the sliders set: a robot on a surface with a few of its numbers changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from slipmargin.checks import real
from slipmargin.errors import InputError
from slipmargin.limits.bounds_inside import YAW_SHARE
from slipmargin.robot import Coefficients, LoadRule, Surface
from slipmargin.study.quantities import QUANTITIES, own_value
from slipmargin.study.robot_on_surface import RobotOnSurface

#: Margin that the page opens with, as the commands have it [1].
MARGIN = 0.1
_BY_KEY = {q.key: q for q in QUANTITIES}
#: Angles that a robot may have, in the order asked; a robot has those that mean something for it.
_ANGLES = (
    ("delta_deg", "Wheel angle δ", -20.0, 60.0),
    ("front_angle_deg", "Front wheels, from straight ahead", 15.0, 75.0),
    ("rear_angle_deg", "Rear wheels, from straight behind", 15.0, 75.0),
    ("roller_angle_deg", "Roller angle", 20.0, 70.0),
)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Slider:
    """One slider: its key, what it is called, unit, range, step and the value it starts from."""

    key: str
    label: str
    unit: str
    low: float
    high: float
    step: float
    value: float
    note: str = ""


def sliders(design: RobotOnSurface) -> tuple[Slider, ...]:
    """The sliders that mean something for this robot.

    Each range contains the robot's own value.
    """
    robot, floor = design.robot, design.robot.surface(design.surface)
    place = np.array([w.position_m for w in robot.wheels])
    reach = float(np.max(np.hypot(place[:, 0], place[:, 1])))
    x, y = robot.convention.axes
    height = float(robot.body.com_height_m)
    fixed = robot.load_rule is LoadRule.FIXED
    note = (
        "" if robot.load_rule is LoadRule.QUASI_STATIC else f"no effect with loads “{robot.load_rule.value}”"
    )
    still = note if robot.load_rule is not LoadRule.STATIC else ""
    found = [
        Slider(
            key="mu",
            label="Friction μ along the drive",
            unit="",
            low=0.05,
            high=max(1.2, 1.5 * floor.roller.drive),
            step=0.01,
            value=float(floor.roller.drive),
            note="the floor's other coefficients keep their ratio to it",
        ),
        Slider(
            key="com_height_m",
            label="Height of the centre of mass",
            unit="m",
            low=0.0,
            high=max(2.0 * reach, 1.5 * height),
            step=0.005,
            value=height,
            note=note,
        ),
    ]
    for key, axis, at in (("com_x_m", x, 0), ("com_y_m", y, 1)):
        own, far = float(robot.body.com_m[at]), 0.6 * float(np.max(np.abs(place[:, at])))
        found.append(
            Slider(
                key=key,
                label=f"Centre of mass, {axis}",
                unit="m",
                low=min(-far, own),
                high=max(far, own),
                step=0.002,
                value=own,
                note="no effect on stated load fractions" if fixed else still,
            )
        )
    for key, label, low, high in _ANGLES:
        own_angle = own_value(_BY_KEY[key], design)
        if isinstance(own_angle, float) and (key != "roller_angle_deg" or own_angle > 1.0):
            found.append(
                Slider(
                    key=key,
                    label=label,
                    unit="°",
                    low=min(low, own_angle),
                    high=max(high, own_angle),
                    step=0.5,
                    value=own_angle,
                )
            )
    return (
        *found,
        Slider(
            key="margin",
            label="Slip margin",
            unit="",
            low=0.0,
            high=0.6,
            step=0.01,
            value=MARGIN,
            note="the share of the grip kept in reserve",
        ),
        Slider(
            key="yaw_share",
            label="Kept for turning",
            unit="",
            low=0.0,
            high=0.5,
            step=0.01,
            value=YAW_SHARE,
            note="the share of spinning on the spot that the exported limits keep in reserve",
        ),
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Settings:
    """A robot on a surface as the sliders have it, the margin and the share kept for turning."""

    design: RobotOnSurface
    margin: float
    yaw_share: float
    changed: bool  #: whether the robot differs from its file


def settings(design: RobotOnSurface, values: Mapping[str, float]) -> Settings:
    """The robot with the sliders at ``values``; a slider at its own value changes nothing.

    Raises
    ------
    InputError
        For an unknown slider, a value outside its range, or a robot that is impossible so.
    """
    known = {s.key: s for s in sliders(design)}
    given: dict[str, float] = {}
    for key, value in values.items():
        if key not in known:
            raise InputError(key, "is no slider of this robot", f"use one of: {', '.join(known)}")
        one = known[key]
        given[key] = real(
            key, value, low=one.low - 1e-9, high=one.high + 1e-9, cure=f"{one.low:g} to {one.high:g}"
        )
    margin = given.pop("margin", MARGIN)
    share = given.pop("yaw_share", YAW_SHARE)
    moved = {k: v for k, v in given.items() if v != known[k].value}
    mu = moved.pop("mu", None)
    for quantity in QUANTITIES:  # in their order, whatever the order of the sliders
        if quantity.key in moved:
            design = quantity.put(design, moved[quantity.key])
    if mu is not None:
        design = _with_friction(design, mu)
    return Settings(design=design, margin=margin, yaw_share=share, changed=bool(moved) or mu is not None)


def _with_friction(design: RobotOnSurface, mu: float) -> RobotOnSurface:
    """The design's floor with every coefficient multiplied, so that the drive coefficient is ``mu``."""
    floor = design.robot.surface(design.surface)
    factor = mu / floor.roller.drive

    def scaled(pair: Coefficients) -> Coefficients:
        return Coefficients(drive=factor * pair.drive, transverse=factor * pair.transverse)

    new: Surface = replace(
        floor,
        library=None,
        roller=replace(scaled(floor.roller), drive=mu),
        rigid=scaled(floor.rigid),
    )
    surfaces = tuple(new if s.name == floor.name else s for s in design.robot.surfaces)
    change: dict[str, Any] = {"surfaces": surfaces}
    return design.with_robot(replace(design.robot, **change))
