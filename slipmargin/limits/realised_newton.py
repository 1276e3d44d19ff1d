"""Newton's method for where a realised share is reached (:mod:`~slipmargin.limits.realised_limit`)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.creep import (
    EXACT,
    FOUND,
    GRIP,
    NEED,
    SCALE,
    SLIP,
    STEEP,
    balance,
    continued,
    slip,
    solve3,
)
from slipmargin.physics.compiled import inner, kernel

#: Points of the search over t where no neighbour's solution helps.
SCAN = 33
#: Wheels within this of the limiting slip limit as well [1].
TIED = 1e-6
#: Size of the residual at which a limit is found [1].
CLOSE = 1e-10
#: Columns of a wheel on a ray: slope k, grip c₀ + t c₁ and its least.
SLOPE, GRIP_0, GRIP_1, LEAST, RAY = range(5)
#: Law, knee σ⁻¹(0.98), and the largest k u of a wheel within the share.
Rule = tuple[int, float, float]
#: Wrenches of unit forces (6, N), wheels (N, WHEEL) and what they are asked for (ASKED), which has the wrench
#: to compare with and else zeros, and tables (TABLES): what is worked on.
Work = tuple[Array, Array, Array, Array]


@inner
def _copy(source: Array, target: Array) -> None:
    for r in range(3):
        target[r] = source[r]


@inner
def _worst(wheels: Array) -> int:
    """The wheel that slips fastest."""
    worst = 0
    for i in range(1, len(wheels)):
        if abs(wheels[i, SLIP]) > abs(wheels[worst, SLIP]):
            worst = i
    return worst


@inner
def _fastest(rule: Rule, work: Work, ray: Array, wrench: Array, x: Array, t: float) -> float:
    """The fastest slip at t, with its creep in ``x``, where Newton's method begins; infinite if not found."""
    law, knee, _ = rule
    A, wheels, ask, tables = work
    for i in range(len(ray)):
        wheels[i, STEEP] = ray[i, SLOPE]
        wheels[i, GRIP] = max(ray[i, GRIP_0] + t * ray[i, GRIP_1], ray[i, LEAST])
    for r in range(3):
        ask[NEED + r] = wrench[r] + t * wrench[3 + r]
    if not balance(law, knee, A, wheels, ask, x, EXACT, tables) <= FOUND:
        for r in range(3):
            x[r] = 0.0
        return math.inf
    for i in range(len(wheels)):
        wheels[i, SLIP] = slip(A, wheels[i, STEEP], x, i)
    return float(abs(wheels[_worst(wheels), SLIP]))


@inner
def _look(rule: Rule, work: Work, ray: Array, wrench: Array, x: Array, t: float) -> float:
    """Residual, its derivatives by ε and by t (in the tables) and the slips; returns the residual's size."""
    law, knee, _ = rule
    A, wheels, ask, tables = work
    H, out, by_t = tables[0], tables[2, 0], tables[2, 1]
    r0, r1, r2 = wrench[0] + t * wrench[3], wrench[1] + t * wrench[4], wrench[2] + t * wrench[5]
    d0, d1, d2 = wrench[3], wrench[4], wrench[5]
    h00, h01, h02 = 0.0, 0.0, 0.0
    h11, h12, h22 = 0.0, 0.0, 0.0
    for i in range(len(ray)):
        k, grip, more = ray[i, SLOPE], ray[i, GRIP_0] + t * ray[i, GRIP_1], ray[i, GRIP_1]
        if not grip > ray[i, LEAST]:
            grip, more = ray[i, LEAST], 0.0
        a, b, c = A[0, i], A[1, i], A[2, i]
        z = k * (a * x[0] + b * x[1] + c * x[2])
        wheels[i, SLIP] = z
        share, slope = continued(law, knee, z)
        f, g, h = grip * share, more * share, grip * k * slope
        r0, r1, r2 = r0 + a * f, r1 + b * f, r2 + c * f
        d0, d1, d2 = d0 + a * g, d1 + b * g, d2 + c * g
        ha, hb = h * a, h * b
        h00, h01, h02 = h00 + ha * a, h01 + ha * b, h02 + ha * c
        h11, h12, h22 = h11 + hb * b, h12 + hb * c, h22 + h * c * c
    out[0], out[1], out[2] = r0, r1, r2
    by_t[0], by_t[1], by_t[2] = d0, d1, d2
    H[0, 0], H[0, 1], H[0, 2] = h00, h01, h02
    H[1, 0], H[1, 1], H[1, 2] = h01, h11, h12
    H[2, 0], H[2, 1], H[2, 2] = h02, h12, h22
    r0, r1, r2 = r0 / ask[SCALE], r1 / ask[SCALE + 1], r2 / ask[SCALE + 2]
    return math.sqrt(r0 * r0 + r1 * r1 + r2 * r2)


@inner
def _leave(rule: Rule, work: Work, ray: Array, wrench: Array, x: Array, t: float) -> float:
    """t at which the share is left, by Newton from (x, t); NaN where it does not get there."""
    most = rule[2]
    A, wheels, _, tables = work
    H, rows, more = tables[0], tables[2], tables[3]
    one, two = more[0], more[1]
    j, sign = -1, 1.0
    for _ in range(26):
        miss = _look(rule, work, ray, wrench, x, t)
        worst = _worst(wheels)
        top = wheels[worst, SLIP]
        if j >= 0 and miss <= CLOSE and abs(top) <= most * (1.0 + 1e-9):
            return t
        if j < 0 or miss <= CLOSE:
            j, sign = worst, math.copysign(1.0, top)
        solve3(H, rows[0], one)
        solve3(H, rows[1], two)
        k = ray[j, SLOPE]
        slope = sign * slip(A, k, two, j)
        if not slope < 0.0:  # more acceleration must mean more slip here
            return math.nan
        dt = (sign * (wheels[j, SLIP] - slip(A, k, one, j)) - most) / slope
        for r in range(3):
            x[r] -= one[r] + dt * two[r]
        t += dt
    return math.nan


@inner
def _searched(rule: Rule, work: Work, ray: Array, wrench: Array, low: float, high: float) -> float:
    """The first t within the share from the top: in steps, by halves, then by Newton's method.

    ``high`` where that is within the share, −∞ where nothing is.
    """
    most, tables = rule[2], work[3]
    x, near = tables[4, 0], tables[4, 1]
    for r in range(3):
        x[r] = 0.0
    above, below, step = high, -math.inf, (high - low) / (SCAN - 1)
    for s in range(SCAN):
        here = high - s * step
        if _fastest(rule, work, ray, wrench, x, here) <= most:
            below = here
            break
        above = here
    if below == high or below == -math.inf:
        return below
    for s in range(60):
        _copy(x, near)
        if s > 3:
            found = _leave(rule, work, ray, wrench, x, below)
            if below <= found <= above:
                return found
            _copy(near, x)
        here = 0.5 * (below + above)
        if _fastest(rule, work, ray, wrench, x, here) <= most:
            below = here
        else:
            above = here
            _copy(near, x)
    _fastest(rule, work, ray, wrench, x, below)
    return below


@kernel
def leave_share(
    rule: Rule,
    work: Work,
    rays: Array,
    wrench: Array,
    low: Array,
    high: Array,
    t: Array,
    code: NDArray[np.int64],
) -> None:
    """For every ray the largest t in [low, high] within the share; −∞ where none is found.

    ``rays`` (M, N, RAY), ``wrench`` (M, 6): w₀ and w₁.  ``code`` gets a bit for every limiting wheel, 0 where
    ``high`` is within the share.  Newton's method starts where the line through the last two rays' solutions
    leads, which saves a step of four.
    """
    wheels, tables = work[1], work[3]
    n, x, last, step = rays.shape[1], tables[4, 0], tables[5, 0], tables[5, 1]
    known, t0, dt = 0, 0.0, 0.0  # how many rays before this one were found, the last t and its change
    for m in range(len(low)):
        code[m] = 0
        if not (math.isfinite(low[m]) and math.isfinite(high[m])):
            t[m], known = high[m], 0
            continue
        found, ray, w = math.nan, rays[m], wrench[m]
        if known > 1:
            for r in range(3):
                x[r] = last[r] + step[r]
            found = _leave(rule, work, ray, w, x, t0 + dt)
        if known > 0 and not low[m] <= found:
            _copy(last, x)
            found = _leave(rule, work, ray, w, x, t0)
        if not low[m] <= found:
            found = _searched(rule, work, ray, w, low[m], high[m])
            if found == high[m] or found == -math.inf:
                t[m], known = found, 0
                continue
        for r in range(3):
            step[r] = x[r] - last[r]
        _copy(x, last)
        dt, t0, known = found - t0, found, known + 1
        t[m] = min(found, high[m])
        if found < high[m]:
            top = abs(wheels[_worst(wheels), SLIP])
            for i in range(min(n, 62)):
                if abs(wheels[i, SLIP]) >= top * (1.0 - TIED):
                    code[m] |= 1 << i
