"""The design with the best worst case over intervals of unknown numbers and over roller/rigid states.

Static limits and accelerations are the least of rows that are linear in the coefficients, so they are
concave in them: over a box of coefficients (the same for all wheels) the worst is at a corner, and trying
the corners is exact.  For other quantities the corners are tried and nothing more is claimed.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.study.evaluate import evaluate
from slipmargin.study.objectives import BY_NAME, Objective
from slipmargin.study.quantities import Quantity
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.vary import applied, quantity_of

#: The objective that takes the worst contact state, where there is one.
UNKNOWN = {
    "f_worst": "f_low_worst",
    "start_worst_m_s2": "start_unknown_m_s2",
    "slip_share": "slip_share_unknown",
}
#: Quantities over whose box the corners are exact.
EXACT = frozenset({"mu_drive", "mu_transverse"})
#: The limits for which they are: the least of rows linear in the coefficients, or the worst of such.
EXACT_LIMITS = frozenset(
    {"f_worst", "f_low_worst", "start_worst_m_s2", "start_unknown_m_s2", "brake_worst_m_s2"}
)
_FORM = "write KEY=LOW:HIGH"


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Interval:
    """A quantity that is only known to lie between ``low`` and ``high``."""

    quantity: Quantity
    low: float
    high: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robust:
    """``value`` (D,) of ``goal`` at each design's worst corner, the best row, and its worst corner."""

    goal: Objective
    value: Array
    best: int
    corner: tuple[tuple[str, float], ...]
    exact: bool


def parse_interval(text: str) -> Interval:
    """``KEY=LOW:HIGH``.

    Raises
    ------
    InputError
        For an unknown key, a choice instead of a number, or ends that are no interval.
    """
    key, _, right = (part.strip() for part in text.partition("="))
    ends = right.split(":")
    quantity = quantity_of(key) if key and right else None
    if quantity is None or len(ends) != 2:
        raise InputError(repr(text), "is no interval", _FORM)
    if quantity.words or quantity.whole:
        raise InputError(key, "is a choice or a count", "give an interval of a number")
    try:
        low, high = (float(end) for end in ends)
    except ValueError:
        raise InputError(key, f"is {right!r}", _FORM) from None
    if not (math.isfinite(low) and math.isfinite(high) and low <= high):
        raise InputError(key, f"is {right!r}, no interval", "give finite numbers, the lower first")
    return Interval(quantity=quantity, low=low, high=high)


def robust(
    designs: Sequence[RobotOnSurface | None], goal: Objective, intervals: Sequence[Interval]
) -> Robust:
    """The design whose worst case is best.

    Parameters
    ----------
    goal : Objective
        Replaced by the one that takes the worst roller/rigid state, where there is one (:data:`UNKNOWN`).

    Raises
    ------
    InputError
        If an interval is given twice or no design is possible at every corner.
    """
    keys = [i.quantity.key for i in intervals]
    twice = next((key for k, key in enumerate(keys) if key in keys[:k]), None)
    if twice is not None:
        raise InputError(twice, "is given twice", "give one interval for each quantity")
    goal = BY_NAME[UNKNOWN.get(goal.name, goal.name)]
    corners = list(itertools.product(*({i.low, i.high} for i in intervals)))
    everyone = [_moved(m, intervals, corner) for corner in corners for m in designs]
    score = goal.sign * evaluate(everyone, goal).reshape(len(corners), len(designs))
    worst = np.min(score, axis=0)  # NaN where a corner is impossible
    if np.all(np.isnan(worst)):
        raise InputError(
            "uncertain", "leaves no design that is possible at every corner", "give narrower intervals"
        )
    best = int(np.nanargmax(worst))
    corner = corners[int(np.argmin(score[:, best]))]
    exact = set(keys) <= EXACT and goal.name in EXACT_LIMITS
    return Robust(
        goal=goal,
        value=goal.sign * worst,
        best=best,
        exact=exact,
        corner=tuple(zip(keys, corner, strict=True)),
    )


def _moved(
    design: RobotOnSurface | None, intervals: Sequence[Interval], corner: Sequence[float]
) -> RobotOnSurface | None:
    if design is None:
        return None
    try:
        return applied(design, [i.quantity for i in intervals], corner)
    except InputError:
        return None
