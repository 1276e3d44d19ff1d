"""Wheel motion known in time: pieces, and how a lagging drive follows them.

On a piece starting at t_k, with τ = t − t_k, a wheel turns as

    θ = c0 + c1 τ + c2 τ² + c3 τ³ + c4 T (1 − e^(−τ/T)),   ω = c1 + 2 c2 τ + 3 c3 τ² + c4 e^(−τ/T)

where T is the wheel's lag; the last term is the exact answer of a first-order drive.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.physics.compiled import fast, inner, spliced
from slipmargin.physics.variables import Variable
from slipmargin.sim import layout as at
from slipmargin.sim.varying import series

_H, _W, _TERM, _COUNT = at.HEAD, at.WHEEL, at.TERM, at.COUNT
_LAG, _GAIN, _TOP, _DELAY = at.LAG, at.GAIN, at.TOP_SPEED, at.DELAY
_DRIVEN, _BENT, _CMDS, _CMDS_AT = at.DRIVEN, at.BENT, at.COMMANDS, at.COMMANDS_AT
_TIME = int(Variable.TIME)


@spliced
def turn(c: Any, lag: float, x: float) -> tuple[float, float, float]:
    """(θ, ω, ω̇) of one wheel at time x into a piece with coefficients c (5)."""
    th = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    om = c[1] + x * (2.0 * c[2] + 3.0 * c[3] * x)
    al = 2.0 * c[2] + 6.0 * c[3] * x
    if c[4] != 0.0:
        e = math.exp(-x / lag)
        th += c[4] * lag * (1.0 - e)
        om += c[4] * e
        al -= c[4] * e / lag
    return th, om, al


@spliced
def moved_on(c: Any, x: float, p: Any) -> None:
    """Fill p with the cubic of coefficients c, counted from time x into its piece."""
    p[0] = c[0] + x * (c[1] + x * (c[2] + x * c[3]))
    p[1] = c[1] + x * (2.0 * c[2] + 3.0 * c[3] * x)
    p[2], p[3] = c[2] + 3.0 * c[3] * x, c[3]


@inner
def _command_factor(P: Any, i: int, t: float, speed: float) -> float:
    factor, q, n = 1.0, int(P[_CMDS_AT]), int(P[_COUNT])
    for _ in range(int(P[_CMDS])):
        count, place = int(P[q + 3]), q + _TERM + n
        v = 1.0 if P[q] == 0.0 else (t if P[q] == _TIME else abs(speed))
        sum_ = series(P, place, count, int(P[q + 1]), P[q + 4], P[q + 5], v)
        factor *= max(0.0, 1.0 + P[q + _TERM + i] * sum_)
        q = place + count
    return factor


@inner
def _reached(P: Any, i: int, t: float, speed: float) -> float:
    """Speed at which a wheel settles that is commanded one: modulations, gain and top speed in turn."""
    most = P[_H + i * _W + _TOP]
    settled = P[_H + i * _W + _GAIN] * _command_factor(P, i, t, speed) * speed
    return float(min(max(settled, -most), most))


@fast
def begun(P: Any, commanded: Any, t: float) -> Any:
    """(N,) speeds at which wheels turn that have followed a command (N,) long before time t [rad/s]."""
    out = np.empty(len(commanded))
    for i in range(len(commanded)):
        out[i] = _reached(P, i, t, commanded[i])
    return out


#: A piece of a modulated command is halved until it is this near to the line between its ends, in angle
#: [rad], or it is this short [s].
_NEAR_RAD, _SHORT_S = 1e-5, 2e-4
#: It is looked at inside so often at least, and once for each such change of the command [rad/s].
_LOOKS, _LOOK_RAD_S = 3, 0.1


@inner
def _asked(P: Any, i: int, t: float, c: Any, x: float) -> float:
    """What a wheel's command asks of it at time x into a piece that begins at t [rad/s]."""
    return float(_reached(P, i, t + x, turn(c, 0.0, x)[1]))


@inner
def _straight(P: Any, t: float, c: Any, low: float, high: float) -> bool:
    """Whether modulated commands of all wheels, coefficients c (N, 5), run straight between two times."""
    span = high - low
    for i in range(len(c)):
        if c[i, 2] == 0.0 and c[i, 3] == 0.0:
            continue
        first, last = _asked(P, i, t, c[i], low), _asked(P, i, t, c[i], high)
        change = span * (2.0 * c[i, 2] + 3.0 * c[i, 3] * (low + high))
        looks = max(_LOOKS, int(abs(change) / _LOOK_RAD_S))
        for k in range(looks):
            part = (k + 1.0) / (looks + 1.0)
            line = first + part * (last - first)
            if abs(_asked(P, i, t, c[i], low + part * span) - line) * span > _NEAR_RAD:
                return False
    return True


@fast
def in_straight_parts(P: Any, knots: Any, coef: Any) -> tuple[Any, Any]:
    """The same commanded pieces cut where what modulates them bends: each part is then nearly straight."""
    times, piece, kept = np.empty(2 * len(knots)), np.empty(2 * len(knots), dtype=np.int64), 0
    stack = np.empty(64)
    for j in range(len(knots) - 1):
        low, many, stack[0] = 0.0, 1, knots[j + 1] - knots[j]
        while many > 0:
            high = stack[many - 1]
            if high - low > _SHORT_S and many < len(stack) and not _straight(P, knots[j], coef[j], low, high):
                stack[many] = 0.5 * (low + high)
                many += 1
                continue
            if kept == len(times):
                times, piece = np.concatenate((times, times)), np.concatenate((piece, piece))
            times[kept], piece[kept] = knots[j] + low, j
            kept += 1
            low, many = high, many - 1
    out = np.zeros((kept, coef.shape[1], 5))
    for m in range(kept):
        j = piece[m]
        for i in range(coef.shape[1]):
            moved_on(coef[j, i], times[m] - knots[j], out[m, i])
    return np.append(times[:kept], knots[len(knots) - 1]), out


@fast
def follow(P: Any, knots: Any, coef: Any, start: Any) -> tuple[Any, Any]:
    """Pieces of the wheels' real motion for commanded ones: modulations, gain, top speed, delay, lag in turn.

    ``start`` (N,): wheel speed before the first command acts [rad/s] (:func:`begun`).  What bends a command
    is taken at both ends of a piece and linear between (:func:`in_straight_parts`).  Driven wheels are
    states, which lag by themselves: for them the pieces are what their loops are asked for.
    """
    n, k = int(P[_COUNT]), len(knots) - 1
    late = 1 if P[_DELAY] > 0.0 else 0
    t = np.empty(k + 1 + late)
    out = np.zeros((k + late, n, 5))
    t[0] = knots[0]
    for j in range(k + 1):
        t[j + late] = knots[j] + P[_DELAY]
    if late:  # the motion still ends where the commands do
        t[k + late] = max(knots[k], t[k])
        while late and t[k + late] <= t[k + late - 1]:
            t[k + late] = t[k + late - 1] + 1e-9
    for i in range(n):
        lag, gain = P[_H + i * _W + _LAG] if P[_DRIVEN] == 0.0 else 0.0, P[_H + i * _W + _GAIN]
        angle, speed = coef[0, i, 0], start[i]
        for j in range(k + late):
            h = t[j + 1] - t[j]
            if late and j == 0:
                a, b, c = start[i], 0.0, 0.0
            else:
                m = j - late
                a, b, c = coef[m, i, 1], 2.0 * coef[m, i, 2], 3.0 * coef[m, i, 3]
                if P[_BENT] > 0.0:
                    d = knots[m + 1] - knots[m]
                    held = b == 0.0 and c == 0.0
                    last = a + d * (b + d * c)
                    a = _reached(P, i, t[j], a)
                    if not held:
                        b, c = (_reached(P, i, t[j] + d, last) - a) / d, 0.0
                else:
                    a, b, c = gain * a, gain * b, gain * c
            e = 0.0
            if lag > 0.0:
                b, a = b - 2.0 * c * lag, a - (b - 2.0 * c * lag) * lag
                e = speed - a
            p = out[j, i]
            p[0], p[1], p[2], p[3], p[4] = angle, a, 0.5 * b, c / 3.0, e
            angle, speed, _ = turn(p, lag, h)
    return t, out
