"""Wheel motion known in time: pieces, how a lagging drive follows them, exact switching times.

On a piece starting at t_k, with τ = t − t_k, a wheel turns as

    θ = c0 + c1 τ + c2 τ² + c3 τ³ + c4 T (1 − e^(−τ/T)),   ω = c1 + 2 c2 τ + 3 c3 τ² + c4 e^(−τ/T)

where T is the wheel's lag; the last term is the exact answer of a first-order drive.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.physics.compiled import fast, inner
from slipmargin.physics.terms import HATS, WINDOW
from slipmargin.physics.variables import Variable
from slipmargin.sim import layout as at
from slipmargin.sim.body import series

_H, _W, _TERM, _COUNT = at.HEAD, at.WHEEL, at.TERM, at.COUNT
_LAG, _GAIN, _PITCH, _RIGID, _DELAY = at.LAG, at.GAIN, at.PITCH, at.RIGID_SHARE, at.DELAY
_DRIVEN, _CMDS, _CMDS_AT = at.DRIVEN, at.COMMANDS, at.COMMANDS_AT
_MODS, _MODS_AT, _FORCES, _FORCES_AT = at.MODULATIONS, at.MODULATIONS_AT, at.FORCES, at.FORCES_AT
_TIME = int(Variable.TIME)


@inner
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


@fast
def follow(P: Any, knots: Any, coef: Any, start: Any) -> tuple[Any, Any]:
    """Pieces of the wheels' real motion for commanded pieces: modulations, gain, delay, lag in turn.

    ``start`` (N,): wheel speed before the first command acts [rad/s].  Modulations of the command are
    taken at both ends of a piece and linear between.  Driven wheels are states, which lag by themselves:
    for them the pieces are what their loops are asked for.
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
                if P[_CMDS] > 0:
                    d = knots[m + 1] - knots[m]
                    held = b == 0.0 and c == 0.0
                    last = a + d * (b + d * c)
                    a = a * _command_factor(P, i, t[j], a)
                    if held:
                        b = 0.0
                    else:
                        last = last * _command_factor(P, i, t[j] + d, last)
                        b, c = (last - a) / d, 0.0
                a, b, c = gain * a, gain * b, gain * c
            e = 0.0
            if lag > 0.0:
                b, a = b - 2.0 * c * lag, a - (b - 2.0 * c * lag) * lag
                e = speed - a
            p = out[j, i]
            p[0], p[1], p[2], p[3], p[4] = angle, a, 0.5 * b, c / 3.0, e
            angle, speed, _ = turn(p, lag, h)
    return t, out


@inner
def _root(c: Any, lag: float, order: int, target: float, a: float, b: float) -> float:
    """Where θ (order 0), ω (1) or ω̇ (2) meets ``target`` between a and b; it is monotone there."""
    fa = turn(c, lag, a)[order] - target
    for _ in range(200):
        x = 0.5 * (a + b)
        v = turn(c, lag, x)
        f = v[order] - target
        if f == 0.0 or b - a <= 1e-15 * (1.0 + abs(b)):
            return x
        if (f > 0.0) == (fa > 0.0):
            a, fa = x, f
        else:
            b = x
        if order < 2:  # a Newton step where it stays inside
            d = v[order + 1]
            if d != 0.0:
                new = x - f / d
                if a < new < b:
                    g = turn(c, lag, new)[order] - target
                    if abs(new - x) <= 1e-14 * (1.0 + abs(x)) or g == 0.0:
                        return new
                    if (g > 0.0) == (fa > 0.0):
                        a, fa = new, g
                    else:
                        b = new
    return 0.5 * (a + b)


@inner
def _sort(x: Any, n: int) -> None:
    """The first n entries ascending, in place (Shell's gaps: short, and quick on nearly sorted times)."""
    gap = 1
    while gap < n // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, n):
            value, j = x[i], i
            while j >= gap and x[j - gap] > value:
                x[j] = x[j - gap]
                j -= gap
            x[j] = value
        gap //= 3


@inner
def turning_points(c: Any, lag: float, h: float, cuts: Any) -> int:
    """Times in (0, h) where the wheel reverses, ascending into ``cuts`` (8); how many.

    Between neighbouring zeros of a derivative a function is monotone: zeros of ω̇ split ω, and the
    one time at which ω̇ itself turns (it can where an exponential meets a parabola) splits ω̇.
    """
    m = 0
    if c[4] != 0.0 and c[3] != 0.0:
        ratio = -6.0 * c[3] * lag * lag / c[4]
        if ratio > 0.0 and 0.0 < -lag * math.log(ratio) < h:
            cuts[0] = -lag * math.log(ratio)
            m = 1
    for order in (2, 1):
        a, k = 0.0, m
        for j in range(m + 1):
            b = cuts[j] if j < m else h
            if turn(c, lag, a)[order] * turn(c, lag, b)[order] < 0.0:
                cuts[k] = _root(c, lag, order, 0.0, a, b)
                k += 1
            a = b
        if order == 1:  # only where ω itself is zero the wheel reverses, the other splits go
            for j in range(m, k):
                cuts[j - m] = cuts[j]
            m = k - m
        else:
            m = k
            _sort(cuts, m)
    return m


@inner
def _near(c: Any, lag: float, h: float, pitch: float, edge: float) -> bool:
    """False where the piece surely passes no edge: its control polygon stays between two."""
    p1 = c[0] + h * c[1] / 3.0
    p2 = p1 + h * (c[1] + h * c[2]) / 3.0
    p3 = c[0] + h * (c[1] + h * (c[2] + h * c[3]))
    low, high = min(min(c[0], p1), min(p2, p3)), max(max(c[0], p1), max(p2, p3))
    if c[4] != 0.0:
        tail = c[4] * lag * (1.0 - math.exp(-h / lag))
        low, high = low + min(tail, 0.0), high + max(tail, 0.0)
    return bool(math.ceil((low - edge) / pitch) <= math.floor((high - edge) / pitch))


@inner
def _crossings(
    c: Any, lag: float, h: float, t0: float, pitch: float, edge: float, cuts: Any, out: Any, count: int
) -> int:
    """Append the times at which θ passes an edge m·pitch + edge; ``out`` of length 0 only counts."""
    if not _near(c, lag, h, pitch, edge):
        return count
    m = turning_points(c, lag, h, cuts)
    a = 0.0
    for j in range(m + 1):
        b = cuts[j] if j < m else h
        fa, fb = turn(c, lag, a)[0], turn(c, lag, b)[0]
        first = math.ceil((min(fa, fb) - edge) / pitch)
        last = math.floor((max(fa, fb) - edge) / pitch)
        for k in range(first, last + 1):
            if len(out) > 0:
                out[count] = t0 + _root(c, lag, 0, k * pitch + edge, a, b)
            count += 1
        a = b
    return count


@inner
def _switches(P: Any, knots: Any, coef: Any, cuts: Any, out: Any, count: int) -> int:
    for i in range(int(P[_COUNT])):
        q = _H + i * _W
        pitch, lag = P[q + _PITCH], P[q + _LAG]
        switch = (1.0 - P[q + _RIGID]) * pitch
        if switch <= 0.0 or switch >= pitch or P[_DRIVEN] > 0.0:
            continue
        if P[q + at.ROLLER_W] == P[q + at.RIGID_W] and P[q + at.ROLLER_T] == P[q + at.RIGID_T]:
            continue
        for j in range(len(knots) - 1):
            h = knots[j + 1] - knots[j]
            count = _crossings(coef[j, i], lag, h, knots[j], pitch, 0.0, cuts, out, count)
            count = _crossings(coef[j, i], lag, h, knots[j], pitch, switch, cuts, out, count)
    return count


@inner
def _term_edges(P: Any, out: Any, count: int) -> int:
    for force in range(2):
        q = int(P[_FORCES_AT] if force else P[_MODS_AT])
        for _ in range(int(P[_FORCES] if force else P[_MODS])):
            basis, size = int(P[q + 1]), int(P[q + 3])
            if P[q] == _TIME and basis in (WINDOW, HATS):
                pieces = 1 if basis == WINDOW else max(size - 1, 1)
                for j in range(pieces + 1):
                    if len(out) > 0:
                        out[count] = P[q + 4] + (P[q + 5] - P[q + 4]) * j / pieces
                    count += 1
            q += at.FORCE + 3 * size if force else _TERM + int(P[_COUNT]) + size
    return count


@fast
def breakpoints(P: Any, knots: Any, coef: Any, push: Any) -> Any:
    """Every instant at which the right-hand side may jump or kink, ascending, from first to last knot.

    Rows (M, 2): the time and 1 where it is hard: a sector switch, a step of a wheel's speed, an edge of a
    force.  Knots at which wheel speeds are continuous are soft.
    """
    n = int(P[_COUNT])
    none, cuts = np.empty(0), np.empty(8)
    size = _term_edges(P, none, _switches(P, knots, coef, cuts, none, len(push)))
    others = np.empty(size)
    for k in range(len(push)):
        others[k] = push[k, 0]
    if size > 0:
        _term_edges(P, others, _switches(P, knots, coef, cuts, others, len(push)))
    _sort(others, size)
    out = np.empty((len(knots) + size, 2))
    m, j = 0, 0
    for k in range(len(knots)):
        while j < size and others[j] <= knots[k] - 1e-12:
            if m > 0 and others[j] - out[m - 1, 0] > 1e-12:
                out[m, 0], out[m, 1] = others[j], 1.0
                m += 1
            elif m > 0:
                out[m - 1, 1] = 1.0
            j += 1
        if m == 0 or knots[k] - out[m - 1, 0] > 1e-12:
            hard = k == 0
            for i in range(n):
                if 0 < k < len(knots) - 1:
                    h = knots[k] - knots[k - 1]
                    before = turn(coef[k - 1, i], P[_H + i * _W + _LAG], h)[1]
                    after = coef[k, i, 1] + coef[k, i, 4]
                    hard = hard or abs(after - before) > 1e-9 * (1.0 + abs(after))
            out[m, 0], out[m, 1] = knots[k], 1.0 if hard else 0.0
            m += 1
        if j < size and others[j] < knots[k] + 1e-12:
            out[m - 1, 1] = 1.0
    out[m - 1, 0] = knots[len(knots) - 1]
    return out[:m]
