"""The load models: how the weight is shared between the wheels (docs/theory.md, section 3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.model.parts import Inertia
from slipmargin.physics.loads import Loads, load_centre, uneven_shifts, wheel_loads
from slipmargin.robot import Robot


def centred(inertia: Inertia, loads: Loads, position_m: Array) -> Inertia:
    """The inertia with its centre of mass moved as far as the loads say: sideways and up."""
    if loads.centred == 0.0 and loads.raised_m == 0.0:
        return inertia
    gap = load_centre(position_m, loads.rest_N) - inertia.com_m
    return replace(
        inertia,
        com_m=inertia.com_m + loads.centred * gap,
        com_height_m=inertia.com_height_m + loads.raised_m,
    )


def tagged(rule: str, tag: str) -> str:
    """The loads' rule with one more remark; the order in which remarks are made does not show."""
    first, *others = rule.split(", ")
    return ", ".join([first, *sorted({*others, tag})])


def nominal_loads(robot: Robot) -> Loads:
    """The loads of a robot by the rule its file names, with the band of an uneven floor if it gives one."""
    place, uneven = np.array([w.position_m for w in robot.wheels]), None
    if robot.suspension_N_per_mm is not None and robot.unevenness_mm is not None:
        uneven = uneven_shifts(place, 1e3 * robot.suspension_N_per_mm, 1e-3 * robot.unevenness_mm)
    return wheel_loads(
        robot.load_rule,
        place,
        mass_kg=robot.body.mass_kg,
        com_m=robot.body.com_m,
        com_height_m=robot.body.com_height_m,
        fractions=robot.load_fractions,
        uneven_N=uneven,
    )
