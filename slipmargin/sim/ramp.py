"""A drive that ramps its command: no wheel's asked speed changes faster than a limit (compiled).

    |ω̇_i| ≤ r,  and ω_i = ω_cmd,i wherever that is possible

A wheel follows its command, or chases it at the rate ± r until it has caught it.  A commanded speed is a
parabola on each piece, so both kinds of change are roots.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.physics.compiled import fast, spliced
from slipmargin.sim import layout as at
from slipmargin.sim.stops import SAME_S, merged
from slipmargin.sim.wheels import moved_on

_COUNT, _RAMP = at.COUNT, at.RAMP

#: A difference of speeds or rates that is rounding, as a share of them [1].
_ROUNDING = 1e-12


@spliced
def _first_root(c: float, b: float, a: float, least: float) -> float:
    """The first time above ``least`` at which a + b x + c x² is zero; infinite without one."""
    roots = (math.inf, math.inf)
    if c == 0.0:
        if b != 0.0:
            roots = (-a / b, math.inf)
    else:
        inside = b * b - 4.0 * c * a
        if inside >= 0.0:
            q = -0.5 * (b + math.copysign(math.sqrt(inside), b))
            roots = (q / c, a / q if q != 0.0 else math.inf)
    found = math.inf
    for root in roots:
        if least < root < found:
            found = root
    return found


@fast
def _changes(P: Any, knots: Any, coef: Any, start: Any) -> tuple[Any, Any]:
    """When each wheel begins to chase or to follow, and where each wheel's rows (N + 1) begin.

    Rows: time [s]; 1 or −1 where the wheel chases up or down, 0 where it follows; its speed then [rad/s].
    """
    n, k, rate = int(P[_COUNT]), len(knots) - 1, 1.0 / P[_RAMP]
    rows, found = np.empty((64, 3)), 0
    first = np.zeros(n + 1, dtype=np.int64)
    for i in range(n):
        first[i] = found
        speed = start[i]
        for j in range(k):
            a, b, c = coef[j, i, 1], 2.0 * coef[j, i, 2], 3.0 * coef[j, i, 3]
            x, h = 0.0, knots[j + 1] - knots[j]
            while x < h:  # a parabola is left at most once each way, and caught as often
                asked, rising = a + x * (b + x * c), b + 2.0 * c * x
                gap = asked - speed
                way = 0.0 if abs(gap) <= _ROUNDING * (1.0 + abs(asked)) else math.copysign(1.0, gap)
                steeper = abs(rising) >= rate * (1.0 - _ROUNDING) and rising * c > 0.0
                if way == 0.0 and (steeper or abs(rising) > rate):
                    way = math.copysign(1.0, rising)
                least = x + SAME_S
                if way == 0.0:
                    until = math.inf if c == 0.0 else (math.copysign(rate, c) - b) / (2.0 * c)
                    until = until if until > least else math.inf
                    speed = asked
                else:
                    until = _first_root(c, b - way * rate, a - speed + way * rate * x, least)
                if found == len(rows):
                    more = np.empty((2 * found, 3))
                    more[:found] = rows
                    rows = more
                rows[found, 0], rows[found, 1], rows[found, 2] = knots[j] + x, way, speed
                found += 1
                end = min(until, h)
                if way == 0.0 or until <= h:
                    speed = a + end * (b + end * c)
                else:
                    speed += way * rate * (end - x)
                x = end
    first[n] = found
    return rows[:found], first


@fast
def ramped(P: Any, knots: Any, coef: Any, start: Any) -> tuple[Any, Any]:
    """Knots and pieces of what the drives ask of the wheels, for commanded ones.

    ``start`` (N,): wheel speed before the first command acts [rad/s].
    """
    n, rate = int(P[_COUNT]), 1.0 / P[_RAMP]
    rows, first = _changes(P, knots, coef, start)
    times, piece, current = merged(knots, rows, first)
    out = np.zeros((len(times) - 1, n, 5))
    angle = coef[0, :, 0].copy()
    for m in range(len(times) - 1):
        j, h = piece[m], times[m + 1] - times[m]
        for i in range(n):
            row, p = rows[current[m, i]], out[m, i]
            way = row[1]
            if way == 0.0:
                moved_on(coef[j, i], times[m] - knots[j], p)
            else:
                p[1], p[2] = row[2] + way * rate * (times[m] - row[0]), 0.5 * way * rate
            p[0] = angle[i]
            angle[i] += h * (p[1] + h * (p[2] + h * p[3]))
    return times, out
