"""A sweep's numbers checked by a road that knows no facets: the support function alone.

F_emax = min over n with −n·d = 1 of h(n) + n·w_b, where d is the pull's wrench per newton, w_b the wrench of
the losses and h the support of the friction wrenches, in closed form for every grip (strong duality; a
smaller value anywhere would prove the sweep too high, none as small would prove it too low).
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bias import bias_wrench
from slipmargin.limits.pull import Pull
from slipmargin.limits.wrench_set import WrenchSet, wrench_set
from slipmargin.model import Model
from slipmargin.sets.facets import length_scale

#: Points a side of the grid that closes in on the minimum, and how often it closes in by a half.
_SIDE, _ROUNDS = 41, 44


def self_check(model: Model, phi_rad: Array, force_N: Array) -> float:
    """Greatest relative difference between forces and the support function's own minimum [1].

    Parameters
    ----------
    phi_rad, force_N : (M,)
        Headings and the paper's pull there, all wheels on rollers.
    """
    worst = 0.0
    for phi, force in zip(np.atleast_1d(phi_rad), np.atleast_1d(force_N), strict=True):
        at = np.array([phi])
        ray, bias = Pull().rays(model, at)[0], bias_wrench(model, at)[0]
        other = _least(wrench_set(model, phi_rad=float(phi)), ray, bias)
        worst = max(worst, abs(float(force) - other) / max(abs(other), 1e-300))
    return worst


def _least(wrenches: WrenchSet, ray: Array, bias: Array) -> float:
    # n = −d̂ + a t₁ + b t₂ in units in which a moment counts per length: convex in (a, b).
    scale = np.array([1.0, 1.0, length_scale(wrenches.maps.reshape(3, -1))])
    d = ray / scale
    unit = d / (d @ d)
    first = (
        np.cross(unit, [0.0, 0.0, 1.0])
        if abs(unit[2]) < 0.9 * np.linalg.norm(unit)
        else np.array([1.0, 0.0, 0.0])
    )
    first = first / np.linalg.norm(first)
    second = np.cross(d, first)
    second = second / np.linalg.norm(second)
    first = np.cross(second, d) / np.linalg.norm(d)
    centre, reach, best = np.zeros(2), 64.0, np.inf
    step = np.linspace(-1.0, 1.0, _SIDE)
    grid = np.stack(np.meshgrid(step, step), axis=-1).reshape(-1, 2)
    for _ in range(_ROUNDS):
        tried = centre + reach * grid
        n = (-unit + tried[:, :1] * first + tried[:, 1:] * second) / scale
        value = wrenches.support(n) + n @ bias
        at = int(np.argmin(value))
        centre, best = tried[at], min(best, float(value[at]))
        reach *= 0.5
    return best
