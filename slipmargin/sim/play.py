"""Play between a motor and its wheel: what the wheel does while the motor takes it up (compiled).

With the whole play 2 b the wheel's angle is the nearest to its last one within the motor's ± b (the play
operator; A. Visintin, Differential Models of Hysteresis, Springer 1994, section III.2):

    θ(t) = min(max(θ(t − 0), θ_m(t) − b), θ_m(t) + b)

So a wheel turns as its motor does, or stands: between two changes nothing but a number is subtracted.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from slipmargin.physics.compiled import fast, spliced
from slipmargin.physics.constants import SLOW_RAD_S
from slipmargin.sim import layout as at
from slipmargin.sim.stops import merged
from slipmargin.sim.wheels import moved_on, turn

_H, _W, _COUNT, _LAG, _PLAY = at.HEAD, at.WHEEL, at.COUNT, at.LAG, at.PLAY

#: A piece is looked at so many times for instants at which its motor turns back, or its speed does.
_LOOKS = 8
#: Halvings after which such an instant is known to the last digit.
_HALVINGS = 52


@spliced
def _changes_sign(c: Any, lag: float, low: float, high: float, rate: int) -> float:
    """When the speed (``rate`` 1) or the acceleration (2) changes its sign between two times into a piece."""
    before = turn(c, lag, low)[rate]
    for _ in range(_HALVINGS):
        mid = 0.5 * (low + high)
        if turn(c, lag, mid)[rate] * before > 0.0:
            low = mid
        else:
            high = mid
    return high


@spliced
def _reaches(c: Any, lag: float, low: float, high: float, angle: float, way: int) -> float:
    """When a motor that turns one way (1 or −1) reaches an angle."""
    for _ in range(_HALVINGS):
        mid = 0.5 * (low + high)
        if way * (turn(c, lag, mid)[0] - angle) < 0.0:
            low = mid
        else:
            high = mid
    return high


@fast
def _changes(P: Any, knots: Any, coef: Any) -> tuple[Any, Any]:
    """When each wheel begins to follow its motor or to stand, and where each wheel's rows (N + 1) begin.

    Rows: time [s], 1 or −1 where the wheel follows forwards or backwards, 0 where it stands, and then at
    which angle [rad].  A wheel whose motor turns at the start has taken its play up; one whose motor stands
    is in the middle.
    """
    n, k = int(P[_COUNT]), len(knots) - 1
    rows, found = np.empty((64, 3)), 0
    first = np.zeros(n + 1, dtype=np.int64)
    for i in range(n):
        lag, half = P[_H + i * _W + _LAG], 0.5 * P[_H + i * _W + _PLAY]
        angle, speed, _ = turn(coef[0, i], lag, 0.0)
        way = 0 if half > 0.0 and abs(speed) <= SLOW_RAD_S else (1 if speed >= 0.0 else -1)
        stands = angle - way * half
        first[i] = found
        for j in range(k):
            if found + 8 * _LOOKS + 1 > len(rows):
                more = np.empty((2 * len(rows), 3))
                more[:found] = rows[:found]
                rows = more
            if j == 0:
                rows[found, 0], rows[found, 1], rows[found, 2] = knots[0], way, stands
                found += 1
            if half == 0.0:
                break
            c, h = coef[j, i], knots[j + 1] - knots[j]
            bend = 0.0
            for look in range(2 * _LOOKS):
                low, end = h * (look // 2) / _LOOKS, h * (look // 2 + 1) / _LOOKS
                # A motor may turn back twice in one look: before and after its speed does.
                if look % 2 == 0:
                    bends = turn(c, lag, low)[2] * turn(c, lag, end)[2] < 0.0
                    bend = _changes_sign(c, lag, low, end, 2) if bends else end
                    end = bend
                elif bend == end:
                    continue
                else:
                    low = bend
                high, back = end, turn(c, lag, low)[1] * turn(c, lag, end)[1] < 0.0
                if back:
                    high = _changes_sign(c, lag, low, end, 1)
                for part in range(2 if back else 1):
                    if part == 1:
                        low, high = high, end
                    here, there = turn(c, lag, low)[0], turn(c, lag, high)[0]
                    if there == here:
                        continue
                    ahead = 1 if there > here else -1
                    if way == -ahead:
                        way = 0
                        rows[found, 0], rows[found, 1], rows[found, 2] = knots[j] + low, 0, stands
                        found += 1
                    if way == 0 and ahead * (there - stands) > half:
                        x = _reaches(c, lag, low, high, stands + ahead * half, ahead)
                        way = ahead
                        rows[found, 0], rows[found, 1], rows[found, 2] = knots[j] + x, way, stands
                        found += 1
                    if way == ahead:
                        stands = there - ahead * half
    first[n] = found
    return rows[:found], first


@fast
def taken_up(P: Any, knots: Any, coef: Any) -> tuple[Any, Any]:
    """Knots and pieces of the wheels for those of their motors: more of them, as each wheel's changes ask."""
    n = int(P[_COUNT])
    rows, first = _changes(P, knots, coef)
    times, piece, current = merged(knots, rows, first)
    out = np.zeros((len(times) - 1, n, 5))
    for m in range(len(times) - 1):
        j = piece[m]
        x = times[m] - knots[j]
        for i in range(n):
            row, p = rows[current[m, i]], out[m, i]
            way = row[1]
            if way == 0.0:
                p[0] = row[2]
                continue
            c, lag, half = coef[j, i], P[_H + i * _W + _LAG], 0.5 * P[_H + i * _W + _PLAY]
            moved_on(c, x, p)
            p[0] = turn(c, lag, x)[0] - way * half
            if c[4] != 0.0:
                p[4] = c[4] * np.exp(-x / lag)
    return times, out
