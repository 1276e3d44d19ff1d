"""One objective of many machines: what optimum, robustness and sensitivity all ask."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.study.columns import slow_columns, static_columns
from slipmargin.study.machine import Machine
from slipmargin.study.objectives import Kind, Objective


def judge(machines: Sequence[Machine | None], goal: Objective) -> Array:
    """(D,) values of an objective; NaN for a design that is impossible (or None)."""
    if goal.kind is Kind.STATIC:
        return static_columns(machines)[0][goal.name]
    return np.array([math.nan if m is None else slow_columns(m, (goal.kind,))[goal.name] for m in machines])
