"""One objective of many designs, for the optimum, the robust design and the sensitivities."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.study.columns import columns_of, static_columns
from slipmargin.study.objectives import Kind, Objective
from slipmargin.study.robot_on_surface import RobotOnSurface


def evaluate(designs: Sequence[RobotOnSurface | None], goal: Objective) -> Array:
    """(D,) values of an objective; NaN for a design that is impossible (or None)."""
    if goal.kind is Kind.STATIC:
        return static_columns(designs, names=[goal.name])[0][goal.name]
    return np.array([math.nan if m is None else columns_of(m, (goal.kind,))[goal.name] for m in designs])
