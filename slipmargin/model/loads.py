"""The load models: how the weight is shared between the wheels (theory, section 3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import GRAVITY_M_S2, Array
from slipmargin.model.parts import Inertia, Loads
from slipmargin.robot import LoadRule, Robot


def sharing_matrix(position_m: Array) -> Array:
    """Loads from their resultant: N = S (W, W x, W y), S (N, 3).

    The minimum-norm solution of Σ N_i = W, Σ N_i p_i = W p: exact for three wheels, equal
    suspension stiffness for more (they are hyperstatic).
    """
    moments = np.vstack([np.ones(len(position_m)), position_m.T])
    return np.asarray(np.linalg.pinv(moments), dtype=np.float64)


def load_centre(position_m: Array, rest_N: Array) -> Array:
    """The point (2,) at which the loads' resultant acts [m]."""
    return np.asarray(position_m.T @ rest_N / rest_N.sum(), dtype=np.float64)


def centred(inertia: Inertia, loads: Loads, position_m: Array) -> Inertia:
    """The inertia with its centre of mass moved as far towards the loads' resultant as they say."""
    if loads.centred == 0.0:
        return inertia
    gap = load_centre(position_m, loads.rest_N) - inertia.com_m
    return replace(inertia, com_m=inertia.com_m + loads.centred * gap)


def tagged(rule: str, tag: str) -> str:
    """The loads' rule with one more remark; the order in which remarks are made does not show."""
    first, *others = rule.split(", ")
    return ", ".join([first, *sorted({*others, tag})])


def nominal_loads(robot: Robot) -> Loads:
    """The loads of a robot by the rule its file names."""
    place = np.array([w.position_m for w in robot.wheels])
    n, weight = len(place), robot.body.mass_kg * GRAVITY_M_S2
    share = sharing_matrix(place)
    still = np.zeros((n, 2))
    if robot.load_rule is LoadRule.EQUAL:
        return Loads(rest_N=np.full(n, weight / n), per_acceleration_kg=still, rule="equal shares m g / N")
    if robot.load_rule is LoadRule.FIXED:
        assert robot.load_fractions is not None
        return Loads(
            rest_N=weight * robot.load_fractions, per_acceleration_kg=still, rule="stated fractions of m g"
        )
    rest = share @ (weight * np.array([1.0, *robot.body.com_m]))
    if robot.load_rule is LoadRule.STATIC:
        return Loads(rest_N=rest, per_acceleration_kg=still, rule=_statics(n))
    # Σ N_i (p_i − com) = −m h a: accelerating forwards presses the rear wheels down.
    shift = -robot.body.mass_kg * robot.body.com_height_m * share[:, 1:]
    return Loads(rest_N=rest, per_acceleration_kg=shift, rule=_statics(n) + ", plus load transfer")


def _statics(n: int) -> str:
    return "statics" if n == 3 else "statics with equal suspension stiffness"


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
