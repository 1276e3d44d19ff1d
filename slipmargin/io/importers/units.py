"""Unit words of foreign logs, as factors to SI."""

from __future__ import annotations

import math

from slipmargin.errors import InputError

#: Quantity → word → factor to s, m, rad, rad/s, A.
UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9},
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0, "turn": 2.0 * math.pi},
    "speed": {"rad/s": 1.0, "deg/s": math.pi / 180.0, "turn/s": 2.0 * math.pi, "rpm": math.pi / 30.0},
    "current": {"A": 1.0, "mA": 1e-3},
}


def factor(place: str, quantity: str, word: str) -> float:
    """The factor of a unit word to SI.

    Raises
    ------
    InputError
        At ``place``, with the words that are known.
    """
    known = UNITS[quantity]
    if word not in known:
        raise InputError(place, f"has the unit {word!r}", f"give a {quantity} in one of: {', '.join(known)}")
    return known[word]
