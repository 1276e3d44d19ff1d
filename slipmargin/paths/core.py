"""The fastest profile under linear rows: one backward and one forward pass (compiled).

With u = s̈ constant in interval j, x = ṡ² runs linearly from x_j to x_j + 2 Δ_j u.  Rows hold at both
ends of every interval (the *interpolation* scheme):

    at its start   a0 u + b0 x_j ≤ c0
    at its end     a1 u + b1 (x_j + 2 Δ u) ≤ c1

Backward: K_j = [lowest, highest] x_j from which the rest of the path can be driven, a linear program in
the two variables (u, x).  Forward: the largest u that stays inside K.
Source: H. Pham and Q.-C. Pham, "A new approach to time-optimal path parameterization based on
reachability analysis", IEEE T-RO 34(3), 2018 (controllable sets); the program is solved here by
Newton's method on the concave, piecewise linear width of the interval of u.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from slipmargin.checks import Array

OK, STUCK, START, END, REST = 0, 1, 2, 3, 4
#: Rows with |a| below this share of the interval's largest do not depend on u [1].
FLAT = 1e-12
#: A bound on ṡ² where nothing else bounds it [m²/s²].
FASTEST = 1e8


@njit(cache=True)
def _width(A: Array, B: Array, C: Array, count: int, x: float) -> tuple[float, float, int, int]:
    """Lowest and highest u at x, and the rows that say so (−1: none)."""
    low, high, at_low, at_high = -math.inf, math.inf, -1, -1
    for r in range(count):
        a = A[r]
        if a > 0.0:
            u = (C[r] - B[r] * x) / a
            if u < high:
                high, at_high = u, r
        elif a < 0.0:
            u = (C[r] - B[r] * x) / a
            if u > low:
                low, at_low = u, r
    return low, high, at_low, at_high


@njit(cache=True)
def _extreme(
    A: Array, B: Array, C: Array, count: int, low_x: float, high_x: float, upward: bool
) -> tuple[float, int, int]:
    """Largest (or smallest) x in [low_x, high_x] with an admissible u; NaN and the rows in conflict."""
    x = high_x if upward else low_x
    for _ in range(100):
        low, high, i, k = _width(A, B, C, count, x)
        if high - low >= -1e-13 * (1.0 + abs(high) + abs(low)):
            return x, i, k
        slope = -B[k] / A[k] + B[i] / A[i]  # d(high − low)/dx
        if slope == 0.0 or (upward and slope > 0.0) or (not upward and slope < 0.0):
            return math.nan, i, k
        new = (C[k] / A[k] - C[i] / A[i]) / (B[k] / A[k] - B[i] / A[i])  # where both rows meet
        if new < low_x - 1e-12 * (1.0 + abs(low_x)) or new > high_x + 1e-12 * (1.0 + abs(high_x)):
            return math.nan, i, k
        if abs(new - x) <= 1e-16 * abs(x):
            return new, i, k
        x = new
    return x, i, k


@njit(cache=True)
def _kept(A: Array, B: Array, step: float, row: int) -> float:
    """How much of a larger x at the start is left at the end where a row gives the largest u [1]."""
    return float(1.0 - 2.0 * step * B[row] / A[row])


@njit(cache=True)
def _fastest_after(A: Array, B: Array, C: Array, count: int, step: float, bottom: float, top: float) -> float:
    """The largest x in [bottom, top] that loses nothing at the interval's end.

    The largest x at the end, x + 2 Δ u, is a concave function of x at the start.  Where it falls before
    ``top``, a faster start is only paid for by a slower end: rows over one interval are steeper there than
    the motion they stand for.
    """
    _, high, _, row = _width(A, B, C, count, top)
    if high == math.inf or _kept(A, B, step, row) >= 0.0:
        return top
    left, right = bottom, top
    for _ in range(100):
        _, _, _, i = _width(A, B, C, count, left)
        fall, rise = _kept(A, B, step, row), _kept(A, B, step, i)
        if rise < -FLAT:  # it falls from there on
            return left
        # where both lines x + 2 Δ (c − b x)/a meet
        new = float(2.0 * step * (C[i] / A[i] - C[row] / A[row]) / (fall - rise))
        if not left < new < right:
            return min(max(new, left), right)
        _, _, _, k = _width(A, B, C, count, new)
        if k in (i, row):
            return new
        if _kept(A, B, step, k) < 0.0:
            right, row = new, k
        else:
            left = new
    return left


@njit(cache=True)
def _gather(
    A0: Array,
    B0: Array,
    C0: Array,
    A1: Array,
    B1: Array,
    C1: Array,
    step: float,
    A: Array,
    B: Array,
    C: Array,
    name: NDArray[np.int64],
) -> tuple[int, float, float]:
    """Rows of one interval in (u, x); rows without u become bounds on x, returned."""
    least, most, count = 0.0, math.inf, 0
    top = 0.0
    rows = A0.shape[0]
    for r in range(rows):
        top = max(top, abs(A0[r]))
    for end in range(2):
        for r in range(rows):
            if end == 0:
                a, b, c = A0[r], B0[r], C0[r]
            else:
                a, b, c = A1[r] + 2.0 * step * B1[r], B1[r], C1[r]
            if c == math.inf:
                continue
            if abs(a) > FLAT * top:
                A[count], B[count], C[count], name[count] = a, b, c, end * rows + r
                count += 1
            elif b > 0.0:
                most = min(most, c / b)
            elif b < 0.0:
                least = max(least, c / b)
            elif c < 0.0:
                most = -1.0
    return count, least, most


@njit(cache=True)
def profile(
    step: Array,
    A0: Array,
    B0: Array,
    C0: Array,
    A1: Array,
    B1: Array,
    C1: Array,
    cap: Array,
    x_start: float,
    x_end: float,
    x: Array,
    u: Array,
    highest: Array,
) -> tuple[int, int, int, int]:
    """The fastest profile.

    Parameters
    ----------
    step : (n,)
        Δ_j [m].
    A0, B0, C0, A1, B1, C1 : (n, R)
        Rows at the start and the end of each interval; a row with C = ∞ is left out.
    cap : (n + 1,)
        Bounds on x = ṡ² at the grid points.
    x_start, x_end : float
        ṡ² at both ends.
    x, u, highest : outputs (n + 1,), (n,), (n + 1,)
        Profile, accelerations and highest controllable x.

    Returns
    -------
    status, interval, row, row
        ``OK``, or ``STUCK`` with the interval that has no admissible motion and two rows in conflict
        (2R, 2R + 1: the next interval's bounds), ``START`` or ``END`` where that speed is too high, or
        ``REST`` where the start speed is too low to go on.
    """
    n, rows = A0.shape
    A, B, C = np.empty(2 * rows + 2), np.empty(2 * rows + 2), np.empty(2 * rows + 2)
    name = np.empty(2 * rows + 2, dtype=np.int64)
    lowest = np.zeros(n + 1)
    highest[n] = lowest[n] = x_end
    if x_end > cap[n] * (1.0 + 1e-12):
        return END, n, -1, -1
    for j in range(n - 1, -1, -1):
        count, least, most = _gather(A0[j], B0[j], C0[j], A1[j], B1[j], C1[j], step[j], A, B, C, name)
        count = _reach(A, B, C, name, count, rows, step[j], lowest[j + 1], highest[j + 1])
        most = min(most, cap[j], FASTEST)
        if most < least:
            return STUCK, j, -1, -1
        top, i, k = _extreme(A, B, C, count, least, most, True)
        if not top >= least:
            return STUCK, j, _named(name, i), _named(name, k)
        bottom, i, k = _extreme(A, B, C, count, least, top, False)
        lowest[j] = bottom if bottom <= top else top
        highest[j] = _fastest_after(A, B, C, count, step[j], lowest[j], top)
    if x_start > highest[0] * (1.0 + 1e-12) + 1e-15:
        return START, 0, -1, -1
    if x_start < lowest[0] - 1e-12:
        return REST, 0, -1, -1
    x[0] = min(max(x_start, lowest[0]), highest[0])
    for j in range(n):
        count, least, most = _gather(A0[j], B0[j], C0[j], A1[j], B1[j], C1[j], step[j], A, B, C, name)
        count = _reach(A, B, C, name, count, rows, step[j], lowest[j + 1], highest[j + 1])
        low, high, _, _ = _width(A, B, C, count, x[j])
        best = high if high >= low else 0.5 * (low + high)
        new = min(max(x[j] + 2.0 * step[j] * best, lowest[j + 1]), highest[j + 1])
        u[j] = (new - x[j]) / (2.0 * step[j])
        x[j + 1] = max(new, 0.0)
    return OK, 0, -1, -1


@njit(cache=True)
def _reach(
    A: Array,
    B: Array,
    C: Array,
    name: NDArray[np.int64],
    count: int,
    rows: int,
    step: float,
    low: float,
    high: float,
) -> int:
    """Adds the rows low ≤ x + 2 Δ u ≤ high of the next interval."""
    A[count], B[count], C[count], name[count] = 2.0 * step, 1.0, high, 2 * rows
    A[count + 1], B[count + 1], C[count + 1], name[count + 1] = -2.0 * step, -1.0, -low, 2 * rows + 1
    return count + 2


@njit(cache=True)
def _named(name: NDArray[np.int64], row: int) -> int:
    return int(name[row]) if row >= 0 else -1
