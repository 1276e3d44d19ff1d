"""The load models: how the weight is shared between the wheels (docs/theory.md, section 3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.model.parts import Inertia
from slipmargin.physics.loads import LoadRule, Loads, load_centre, sharing_matrix, wheel_loads
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
    """The loads of a robot by the rule its file names."""
    return wheel_loads(
        robot.load_rule,
        np.array([w.position_m for w in robot.wheels]),
        mass_kg=robot.body.mass_kg,
        com_m=robot.body.com_m,
        com_height_m=robot.body.com_height_m,
        fractions=robot.load_fractions,
    )


def contradiction(robot: Robot) -> str | None:
    """The warning a robot deserves whose published equal loads contradict its centre of mass.

    Returns
    -------
    str or None
        By how much each wheel's load is off and where the centre of mass would have to be, or None
        where the loads agree to 1 % of m g / N.
    """
    place = np.array([w.position_m for w in robot.wheels])
    n = len(place)
    fractions = np.full(n, 1.0 / n) if robot.load_rule is LoadRule.EQUAL else robot.load_fractions
    if fractions is None:
        return None
    static = sharing_matrix(place) @ np.array([1.0, *robot.body.com_m])
    gap = fractions - static
    if np.max(np.abs(gap)) < 0.01 / n:
        return None
    worst = int(np.argmax(np.abs(gap)))
    need = np.round(load_centre(place, fractions), 9) + 0.0  # no minus zero, no 1e-19
    return (
        f"loads: the {robot.load_rule.value} load model gives wheel {robot.wheels[worst].name} "
        f"{fractions[worst]:.4f} m g, but statics with the centre of mass at "
        f"({robot.body.com_m[0]:.4g}, {robot.body.com_m[1]:.4g}) m gives it {static[worst]:.4f} m g; "
        f"these loads need the centre of mass at ({need[0]:.4g}, {need[1]:.4g}) m"
    )
