"""Newton's method for where a realised share is reached (:mod:`~slipmargin.limits.realised_limit`)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.creep import BEYOND, FAITHFUL
from slipmargin.physics.compiled import fast, inner, twin
from slipmargin.physics.friction_laws import law_share, law_slope

#: Points of the search over t where no neighbour's solution helps.
SCAN = 33
#: Wheels within this of the limiting slip limit as well [1].
TIED = 1e-6
_law_share, _law_slope = twin(law_share), twin(law_slope)


@inner
def _look(
    law: int,
    knee: float,
    B: Array,
    k: Array,
    c0: Array,
    c1: Array,
    light: Array,
    w0: Array,
    w1: Array,
    x: Array,
    t: float,
    out: Array,
    H: Array,
    by_t: Array,
    z: Array,
) -> None:
    """Residual, its Jacobian by ε and by t, and the slips k_i b_i·ε."""
    r0, r1, r2 = w0[0] + t * w1[0], w0[1] + t * w1[1], w0[2] + t * w1[2]
    f0, f1, f2 = w1[0], w1[1], w1[2]
    h00, h01, h02, h11, h12, h22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(B.shape[1]):
        a, b, m = B[0, i], B[1, i], B[2, i]
        s = k[i] * (a * x[0] + b * x[1] + m * x[2])
        z[i] = s
        if abs(s) <= knee:
            share, slope = _law_share(law, s), _law_slope(law, s)
        else:
            share, slope = math.copysign(FAITHFUL + BEYOND * (abs(s) - knee), s), BEYOND
        c, more = c0[i] + t * c1[i], c1[i]
        if c < light[i]:
            c, more = light[i], 0.0
        f = c * share
        r0, r1, r2 = r0 + a * f, r1 + b * f, r2 + m * f
        f = more * share
        f0, f1, f2 = f0 + a * f, f1 + b * f, f2 + m * f
        h = c * k[i] * slope
        h00, h01, h02 = h00 + h * a * a, h01 + h * a * b, h02 + h * a * m
        h11, h12, h22 = h11 + h * b * b, h12 + h * b * m, h22 + h * m * m
    out[0], out[1], out[2] = r0, r1, r2
    by_t[0], by_t[1], by_t[2] = f0, f1, f2
    H[0], H[1], H[2], H[3], H[4], H[5] = h00, h01, h02, h11, h12, h22


@inner
def _solve(H: Array, b: Array, x: Array) -> None:
    """x = H⁻¹ b, H symmetric and positive definite."""
    p, q = H[1] / H[0], H[2] / H[0]
    h11, h12, b1 = H[3] - p * H[1], H[4] - p * H[2], b[1] - p * b[0]
    h22, b2 = H[5] - q * H[2], b[2] - q * b[0]
    r = h12 / h11
    x[2] = (b2 - r * b1) / (h22 - r * h12)
    x[1] = (b1 - h12 * x[2]) / h11
    x[0] = (b[0] - H[1] * x[1] - H[2] * x[2]) / H[0]


@inner
def _miss(out: Array, scale: Array) -> float:
    return float(abs(out[0]) / scale[0] + abs(out[1]) / scale[1] + abs(out[2]) / scale[2])


@inner
def _worst(z: Array) -> int:
    worst = 0
    for i in range(1, len(z)):
        if abs(z[i]) > abs(z[worst]):
            worst = i
    return worst


@inner
def _at(
    law: int,
    knee: float,
    B: Array,
    k: Array,
    c0: Array,
    c1: Array,
    light: Array,
    w0: Array,
    w1: Array,
    scale: Array,
    x: Array,
    t: float,
    out: Array,
    H: Array,
    by_t: Array,
    z: Array,
    one: Array,
    trial: Array,
) -> float:
    """Creep at a given t by damped Newton, in place; returns the fastest slip, infinite if not found."""
    _look(law, knee, B, k, c0, c1, light, w0, w1, x, t, out, H, by_t, z)
    miss = _miss(out, scale)
    for _ in range(100):
        if miss <= 1e-11:
            break
        _solve(H, out, one)
        size = 1.0
        while size > 1e-9:
            for r in range(3):
                trial[r] = x[r] - size * one[r]
            _look(law, knee, B, k, c0, c1, light, w0, w1, trial, t, out, H, by_t, z)
            less = _miss(out, scale)
            if less < (1.0 - 1e-4 * size) * miss:
                break
            size *= 0.5
        if size <= 1e-9:
            break
        for r in range(3):
            x[r] = trial[r]
        miss = less
    if not miss <= 1e-8:
        for r in range(3):
            x[r] = 0.0
        return math.inf
    return float(abs(z[_worst(z)]))


@inner
def _leave(
    law: int,
    knee: float,
    most: float,
    B: Array,
    k: Array,
    c0: Array,
    c1: Array,
    light: Array,
    w0: Array,
    w1: Array,
    scale: Array,
    x: Array,
    t: float,
    out: Array,
    H: Array,
    by_t: Array,
    z: Array,
    one: Array,
    two: Array,
) -> float:
    """t at which the share is left, by Newton from (x, t); NaN where it does not get there."""
    _look(law, knee, B, k, c0, c1, light, w0, w1, x, t, out, H, by_t, z)
    j = _worst(z)
    sign = math.copysign(1.0, z[j])
    for _ in range(25):
        _solve(H, out, one)
        _solve(H, by_t, two)
        here = (
            sign * k[j] * (B[0, j] * (x[0] - one[0]) + B[1, j] * (x[1] - one[1]) + B[2, j] * (x[2] - one[2]))
        )
        slope = sign * k[j] * (B[0, j] * two[0] + B[1, j] * two[1] + B[2, j] * two[2])
        if not slope < 0.0:  # more acceleration must mean more slip here
            return math.nan
        dt = (here - most) / slope
        for r in range(3):
            x[r] -= one[r] + dt * two[r]
        t += dt
        _look(law, knee, B, k, c0, c1, light, w0, w1, x, t, out, H, by_t, z)
        if _miss(out, scale) <= 1e-10:
            worst = _worst(z)
            if abs(z[worst]) <= most * (1.0 + 1e-9):
                return t
            j, sign = worst, math.copysign(1.0, z[worst])
    return math.nan


@fast
def leave_share(
    law: int,
    knee: float,
    most: float,
    B: Array,
    k: Array,
    c0: Array,
    c1: Array,
    light: Array,
    w0: Array,
    w1: Array,
    scale: Array,
    low: Array,
    high: Array,
    t: Array,
    code: NDArray[np.int64],
) -> None:
    """For every ray the largest t in [low, high] within the share; −∞ where none is found.

    ``code`` gets a bit for every limiting wheel, 0 where ``high`` is within the share.
    """
    out, H, by_t, z = np.zeros(3), np.zeros(6), np.zeros(3), np.zeros(B.shape[1])
    one, two, x, near = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    warm, last = False, 0.0
    for m in range(len(low)):
        code[m] = 0
        if not (math.isfinite(low[m]) and math.isfinite(high[m])):
            t[m], warm = high[m], False
            continue
        found = math.nan
        if warm:
            near[:] = x
            found = _leave(
                law,
                knee,
                most,
                B,
                k[m],
                c0[m],
                c1[m],
                light[m],
                w0[m],
                w1[m],
                scale,
                x,
                last,
                out,
                H,
                by_t,
                z,
                one,
                two,
            )
            if not low[m] <= found:
                found = math.nan
        if math.isnan(found):  # search from the top for the first t within the share, then bisect
            x[:] = 0.0
            above, below, step = high[m], -math.inf, (high[m] - low[m]) / (SCAN - 1)
            for s in range(SCAN):
                here = high[m] - s * step
                if (
                    _at(
                        law,
                        knee,
                        B,
                        k[m],
                        c0[m],
                        c1[m],
                        light[m],
                        w0[m],
                        w1[m],
                        scale,
                        x,
                        here,
                        out,
                        H,
                        by_t,
                        z,
                        one,
                        two,
                    )
                    <= most
                ):
                    below = here
                    break
                above = here
            if below == high[m] or below == -math.inf:
                t[m], warm = below, False
                continue
            for s in range(60):
                near[:] = x
                if s > 3:
                    found = _leave(
                        law,
                        knee,
                        most,
                        B,
                        k[m],
                        c0[m],
                        c1[m],
                        light[m],
                        w0[m],
                        w1[m],
                        scale,
                        x,
                        below,
                        out,
                        H,
                        by_t,
                        z,
                        one,
                        two,
                    )
                    if below <= found <= above:
                        break
                    x[:] = near
                found = below
                here = 0.5 * (below + above)
                if (
                    _at(
                        law,
                        knee,
                        B,
                        k[m],
                        c0[m],
                        c1[m],
                        light[m],
                        w0[m],
                        w1[m],
                        scale,
                        x,
                        here,
                        out,
                        H,
                        by_t,
                        z,
                        one,
                        two,
                    )
                    <= most
                ):
                    below = here
                else:
                    above = here
                    x[:] = near
            _at(
                law,
                knee,
                B,
                k[m],
                c0[m],
                c1[m],
                light[m],
                w0[m],
                w1[m],
                scale,
                x,
                found,
                out,
                H,
                by_t,
                z,
                one,
                two,
            )
        warm, last = True, found
        t[m] = min(found, high[m])
        if found < high[m]:
            top = abs(z[_worst(z)])
            for i in range(min(len(z), 62)):
                if abs(z[i]) >= top * (1.0 - TIED):
                    code[m] |= 1 << i
