"""Where rays of accelerations leave the rows of a state (compiled)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index
from slipmargin.physics.compiled import kernel

#: A slope below this share of the largest is none [1].
NO_SLOPE = 1e-12
#: Shares by which a row may be missed, and by which ends of rays count as one [1].
SAME = 1e-9
#: A robot that is farther from holding than this holds nothing to speak of [m/s² or rad/s²].
FARTHEST = 1e4


@kernel
def ray_ends(
    A: Array,
    b: Array,
    tips: NDArray[np.bool_],
    start: Array,
    direction: Array,
    least: Array,
    value: Array,
    best: Index,
) -> None:
    """Least and largest t (Q, M) with A (start + t direction) ≤ b, and the row that ends each ray.

    A (M, R, 3), b (M, R), tips (R,): rows of wheels that lift; start and direction (Q, M, 3).  Where no t is,
    ``least`` is infinite and ``value`` −∞, or negative where the rows against the direction say how far the
    robot is from holding.
    """
    count = b.shape[1]
    for q in range(len(start)):
        for m in range(len(b)):
            p, d = start[q, m], direction[q, m]
            steepest, scale = 0.0, 0.0
            for r in range(count):
                slope = A[m, r, 0] * d[0] + A[m, r, 1] * d[1] + A[m, r, 2] * d[2]
                steepest, scale = max(steepest, abs(slope)), max(scale, abs(b[m, r]))
            low, high, row = -math.inf, math.inf, 0
            lifts, wheel, never = math.inf, -1, False
            for r in range(count):
                slope = A[m, r, 0] * d[0] + A[m, r, 1] * d[1] + A[m, r, 2] * d[2]
                room = b[m, r] - (A[m, r, 0] * p[0] + A[m, r, 1] * p[1] + A[m, r, 2] * p[2])
                t = math.inf
                if slope > NO_SLOPE * steepest:
                    t = room / slope
                elif slope < -NO_SLOPE * steepest:
                    low = max(low, room / slope)
                elif room < -SAME * scale:
                    never = True
                if t < high:
                    high, row = t, r
                if tips[r] and (wheel < 0 or t < lifts):
                    lifts, wheel = t, r
            if wheel >= 0 and lifts <= high + SAME * abs(
                high
            ):  # where a wheel lifts its grip ends too: it tips
                row = wheel
            if never or low > high + SAME * abs(high):
                low, high = math.inf, (high if -FARTHEST < high <= 0.0 else -math.inf)
            least[q, m], value[q, m], best[q, m] = low, high, row
