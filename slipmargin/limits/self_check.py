"""The pull limits of a sweep computed a second time, from the support function alone.

By strong duality F_emax = min over n with −n·d = 1 of h(n) + n·w_b, where d is the wrench of a pull of one
newton, w_b the external wrench and h the support function of the friction wrenches, in closed form.
No facet and no cone program is involved, so an error there shows as a difference here.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bias import bias_wrench
from slipmargin.limits.pull import Pull
from slipmargin.limits.wrench_set import WrenchSet, wrench_set
from slipmargin.model import Model
from slipmargin.sets.facets import length_scale

#: Samples a line, and how often a line is refined: from ±REACH to ±REACH (2/(SAMPLES − 1))^ROUNDS = 2e-13.
_SAMPLES, _ROUNDS, _REACH = 17, 18, 4096.0
#: A pull below this share of the weight is none, and its relative difference says nothing [1].
_NOTHING = 1e-6


def self_check(model: Model, phi_rad: Array, force_N: Array) -> float:
    """Return the greatest relative difference between pull limits and the support function's minimum [1].

    Parameters
    ----------
    phi_rad, force_N : (M,)
        Headings [rad] and the pull limits there [N]: pull through the centre of mass, all wheels on rollers.
    """
    other = []
    for phi in np.atleast_1d(phi_rad):
        at = np.array([phi])
        ray, bias = Pull().rays(model, at)[0], bias_wrench(model, at)[0]
        other.append(least_support(wrench_set(model, phi_rad=float(phi)), ray, bias))
    return difference(model, np.atleast_1d(force_N), np.array(other))


def difference(model: Model, one_N: Array, other_N: Array) -> float:
    """Return the greatest relative difference [1] between pull limits (M,) [N] found in two ways."""
    least = _NOTHING * float(np.sum(model.loads.rest_N))
    size = np.maximum(np.maximum(np.abs(one_N), np.abs(other_N)), least)
    return float(np.max(np.abs(one_N - other_N) / size))


def least_support(wrenches: WrenchSet, ray: Array, bias: Array) -> float:
    """Return the minimum over n with −n·ray = 1 of h(n) + n·bias: the multiple of ``ray`` that holds."""
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
    step = np.linspace(-1.0, 1.0, _SAMPLES)
    closer = 2.0 / (_SAMPLES - 1)

    def least_on_lines(a: Array) -> Array:
        # The minimum over b for each a.  On a line a convex function has its minimum within one step of its
        # least sample, so refining there never loses it, however narrow the valley is.
        start = -unit + a[:, None] * first
        centre, reach, least = np.zeros(len(a)), _REACH, np.full(len(a), np.inf)
        for _ in range(_ROUNDS):
            b = centre[:, None] + reach * step
            n = (start[:, None] + b[..., None] * second) / scale
            value = wrenches.support(n) + n @ bias
            at = np.argmin(value, axis=1)
            rows = np.arange(len(a))
            centre, least = b[rows, at], np.minimum(least, value[rows, at])
            reach *= closer
        return least

    # The lines' minima are convex in a, so the same holds across the lines.
    middle, wide, best = 0.0, _REACH, np.inf
    for _ in range(_ROUNDS):
        a = middle + wide * step
        least = least_on_lines(a)
        middle, best = float(a[np.argmin(least)]), min(best, float(np.min(least)))
        wide *= closer
    return best
