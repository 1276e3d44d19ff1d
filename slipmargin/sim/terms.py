"""Compiled evaluation of bases over variables (readable twin: ``basis_values`` in model/terms.py)."""

from __future__ import annotations

import math
from typing import Any

from slipmargin.sim.compiled import fast

CONSTANT, POLYNOMIAL, FOURIER, HATS, DECAY, RECIPROCAL, WINDOW, ODD = range(8)


@fast
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
        return float(P[place] * (math.exp(-((abs(v) / a) ** b)) - 1.0))
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
