"""Compiled evaluation of bases over variables (readable twin: ``basis_values`` in model/terms.py)."""

from __future__ import annotations

import math
from typing import Any

from slipmargin.sim.compiled import inner

CONSTANT, POLYNOMIAL, FOURIER, HATS, DECAY, RECIPROCAL, WINDOW, ODD = range(8)


@inner
def series(P: Any, place: int, count: int, basis: int, a: float, b: float, v: float) -> float:
    """Σ_j c_j φ_j(v) with the coefficients standing at ``P[place:]``."""
    if basis == CONSTANT:
        return float(P[place])
    if basis == POLYNOMIAL:
        x, power, total = v / a, 1.0, 0.0
        for j in range(count):
            power *= x
            total += P[place + j] * power
        return total
    if basis == FOURIER:
        total = 0.0
        for j in range(count):
            phase = 2.0 * math.pi * (j // 2 + 1) * v / a
            total += P[place + j] * (math.sin(phase) if j % 2 else math.cos(phase))
        return total
    if basis == HATS:
        knot = (min(max(v, a), b) - a) / (b - a) * (count - 1)
        low = min(int(knot), count - 2) if count > 1 else 0
        if count == 1:
            return float(P[place])
        part = knot - low
        return float(P[place + low] * (1.0 - part) + P[place + low + 1] * part)
    if basis == DECAY:
        x = abs(v) / a
        return float(P[place] * (math.exp(-(x * x if b == 2.0 else x**b)) - 1.0))
    if basis == RECIPROCAL:
        return float(P[place] * (a / (v + b) - 1.0))
    if basis == WINDOW:
        return float(P[place]) if a <= v < b else 0.0
    total = P[place] * 2.0 / math.pi * math.atan(v / a)
    power = v
    for j in range(1, count):
        total += P[place + j] * power
        power *= abs(v)
    return float(total)


@inner
def series_slope(P: Any, place: int, count: int, basis: int, a: float, b: float, v: float) -> float:
    """d/dv of :func:`series` for v ≥ 0 (where a function kinks: its slope to the right)."""
    if basis == POLYNOMIAL:
        x, power, total = v / a, 1.0 / a, 0.0
        for j in range(count):
            total += P[place + j] * (j + 1) * power
            power *= x
        return total
    if basis == FOURIER:
        total = 0.0
        for j in range(count):
            rate = 2.0 * math.pi * (j // 2 + 1) / a
            total += P[place + j] * rate * (math.cos(rate * v) if j % 2 else -math.sin(rate * v))
        return total
    if basis == HATS:
        if count == 1 or v < a or v >= b:
            return 0.0
        low = min(int((v - a) / (b - a) * (count - 1)), count - 2)
        return float((P[place + low + 1] - P[place + low]) * (count - 1) / (b - a))
    if basis == DECAY:
        x = v / a
        if x == 0.0:
            return 0.0 if b > 1.0 else (-P[place] / a if b == 1.0 else 0.0)
        power = x**b
        return float(-P[place] * math.exp(-power) * b * power / v)
    if basis == RECIPROCAL:
        return float(-P[place] * a / ((v + b) * (v + b)))
    if basis == ODD:
        total = P[place] * 2.0 / math.pi * a / (a * a + v * v)
        power = 1.0
        for j in range(1, count):
            total += P[place + j] * j * power
            power *= v
        return float(total)
    return 0.0
