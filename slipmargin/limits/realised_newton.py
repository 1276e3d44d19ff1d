"""Newton's method for where a realised share is reached (:mod:`~slipmargin.limits.realised_limit`)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.creep import (
    FOUND,
    GRIP,
    NEED,
    SLIP,
    STEEP,
    balance,
    continued,
    residual,
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


@inner
def _copy(source: Array, target: Array) -> None:
    for r in range(3):
        target[r] = source[r]


@inner
def _put(rays: Array, wrench: Array, t: float, wheels: Array, ask: Array) -> None:
    """What the wheels have and are asked for at t."""
    for i in range(len(rays)):
        ray = rays[i]
        wheels[i, STEEP], wheels[i, GRIP] = ray[SLOPE], max(ray[GRIP_0] + t * ray[GRIP_1], ray[LEAST])
    for r in range(3):
        ask[NEED + r] = wrench[r] + t * wrench[3 + r]


@inner
def _worst(wheels: Array) -> int:
    """The wheel that slips fastest."""
    worst = 0
    for i in range(1, len(wheels)):
        if abs(wheels[i, SLIP]) > abs(wheels[worst, SLIP]):
            worst = i
    return worst


@inner
def _fastest(
    law: int,
    knee: float,
    A: Array,
    rays: Array,
    wrench: Array,
    wheels: Array,
    ask: Array,
    x: Array,
    t: float,
    tables: Array,
) -> float:
    """The fastest slip at t, with its creep in ``x``, where Newton's method begins; infinite if not found."""
    _put(rays, wrench, t, wheels, ask)
    if not balance(law, knee, A, wheels, ask, x, tables) <= FOUND:
        for r in range(3):
            x[r] = 0.0
        return math.inf
    for i in range(len(wheels)):
        wheels[i, SLIP] = slip(A, wheels[i, STEEP], x, i)
    return float(abs(wheels[_worst(wheels), SLIP]))


@inner
def _leave(
    law: int,
    knee: float,
    most: float,
    A: Array,
    rays: Array,
    wrench: Array,
    wheels: Array,
    ask: Array,
    x: Array,
    t: float,
    tables: Array,
) -> float:
    """t at which the share is left, by Newton from (x, t); NaN where it does not get there."""
    H, rows, more = tables[0], tables[1], tables[2]
    out, by_t, one, two = rows[0], rows[1], more[0], more[1]
    j, sign = -1, 1.0
    for _ in range(26):
        _put(rays, wrench, t, wheels, ask)
        miss = residual(law, knee, A, wheels, ask, x, out, H)
        worst = _worst(wheels)
        top = wheels[worst, SLIP]
        if j >= 0 and miss <= CLOSE and abs(top) <= most * (1.0 + 1e-9):
            return t
        if j < 0 or miss <= CLOSE:
            j, sign = worst, math.copysign(1.0, top)
        for r in range(3):
            by_t[r] = wrench[3 + r]
        for i in range(len(rays)):
            if wheels[i, GRIP] > rays[i, LEAST]:
                share = rays[i, GRIP_1] * continued(law, knee, wheels[i, SLIP])[0]
                for r in range(3):
                    by_t[r] += share * A[r, i]
        solve3(H, out, one)
        solve3(H, by_t, two)
        k = wheels[j, STEEP]
        slope = sign * slip(A, k, two, j)
        if not slope < 0.0:  # more acceleration must mean more slip here
            return math.nan
        dt = (sign * (wheels[j, SLIP] - slip(A, k, one, j)) - most) / slope
        for r in range(3):
            x[r] -= one[r] + dt * two[r]
        t += dt
    return math.nan


@kernel
def leave_share(
    law: int,
    knee: float,
    most: float,
    A: Array,
    rays: Array,
    wrench: Array,
    wheels: Array,
    ask: Array,
    tables: Array,
    low: Array,
    high: Array,
    t: Array,
    code: NDArray[np.int64],
) -> None:
    """For every ray the largest t in [low, high] within the share; −∞ where none is found.

    ``rays`` (M, N, RAY), ``wrench`` (M, 6): w₀ and w₁; wheels (N, WHEEL), ask (ASKED) with the wrench to
    compare with, and tables, else all zero, to work on.  ``code`` gets a bit for every limiting wheel, 0
    where ``high`` is within the share.
    """
    n, x, near = rays.shape[1], tables[3, 0], tables[3, 1]
    nothing = tables[3, 2]
    warm, last = False, 0.0
    for m in range(len(low)):
        code[m] = 0
        if not (math.isfinite(low[m]) and math.isfinite(high[m])):
            t[m], warm = high[m], False
            continue
        found, ray, w = math.nan, rays[m], wrench[m]
        if warm:
            found = _leave(law, knee, most, A, ray, w, wheels, ask, x, last, tables)
        if not low[m] <= found:  # search from the top for the first t within the share, then bisect
            _copy(nothing, x)
            above, below, step = high[m], -math.inf, (high[m] - low[m]) / (SCAN - 1)
            for s in range(SCAN):
                here = high[m] - s * step
                if _fastest(law, knee, A, ray, w, wheels, ask, x, here, tables) <= most:
                    below = here
                    break
                above = here
            if below == high[m] or below == -math.inf:
                t[m], warm = below, False
                continue
            for s in range(60):
                _copy(x, near)
                if s > 3:
                    found = _leave(law, knee, most, A, ray, w, wheels, ask, x, below, tables)
                    if below <= found <= above:
                        break
                    _copy(near, x)
                found = below
                here = 0.5 * (below + above)
                if _fastest(law, knee, A, ray, w, wheels, ask, x, here, tables) <= most:
                    below = here
                else:
                    above = here
                    _copy(near, x)
            _fastest(law, knee, A, ray, w, wheels, ask, x, found, tables)
        warm, last = True, found
        t[m] = min(found, high[m])
        if found < high[m]:
            top = abs(wheels[_worst(wheels), SLIP])
            for i in range(min(n, 62)):
                if abs(wheels[i, SLIP]) >= top * (1.0 - TIED):
                    code[m] |= 1 << i
