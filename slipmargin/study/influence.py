"""Sensitivities: the change of an objective by each number of the robot file."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

from slipmargin.errors import InputError
from slipmargin.study.evaluate import evaluate
from slipmargin.study.objectives import Objective
from slipmargin.study.quantities import QUANTITIES, Quantity, own_value
from slipmargin.study.robot_on_surface import RobotOnSurface

#: Step of a central difference: share of the value, and what to use where the value is zero, by unit.
STEP = 0.01
AT_ZERO = {"m": 1e-3, "deg": 0.1, "1": 1e-3}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Influence:
    """One quantity's influence at a design.

    ``below``, ``here`` and ``above`` are the objective at value − step, value and value + step (NaN where
    that design is impossible).
    """

    key: str
    unit: str
    value: float
    step: float
    below: float
    here: float
    above: float

    @property
    def slope(self) -> float:
        """Central difference [objective's unit / unit]; one-sided where one side is impossible."""
        if math.isnan(self.below) or math.isnan(self.above):
            side = self.above - self.here if math.isnan(self.below) else self.here - self.below
            return side / self.step
        return (self.above - self.below) / (2.0 * self.step)

    @property
    def peak(self) -> bool:
        """Whether the design lies on a ridge or in a valley: both sides change the same way."""
        return (self.below - self.here) * (self.above - self.here) > 0.0

    @property
    def swing(self) -> float:
        """The larger change, relative to the objective, of one step up or down [1]."""
        size = max((abs(v - self.here) for v in (self.below, self.above) if not math.isnan(v)), default=0.0)
        return size / abs(self.here) if self.here else math.inf if size else 0.0


def influences(design: RobotOnSurface, goal: Objective) -> tuple[Influence, ...]:
    """Return the influence of each number that has any, the strongest first; a step is 1 % of the value."""
    rows: list[tuple[Quantity, float, float]] = []
    for quantity in QUANTITIES:
        value = None if quantity.words or quantity.whole else own_value(quantity, design)
        if isinstance(value, float | int):
            step = STEP * abs(value) if value else AT_ZERO.get(quantity.unit, 1e-3)
            rows.append((quantity, float(value), step))
    tried: list[RobotOnSurface | None] = [design]
    for quantity, value, step in rows:
        tried += [_moved(design, quantity, value + side * step) for side in (-1.0, 1.0)]
    found = evaluate(tried, goal)
    out = [
        Influence(
            key=q.key,
            unit=q.unit,
            value=v,
            step=s,
            below=float(found[2 * i + 1]),
            here=float(found[0]),
            above=float(found[2 * i + 2]),
        )
        for i, (q, v, s) in enumerate(rows)
    ]
    return tuple(sorted((i for i in out if i.swing > 1e-9), key=lambda i: -i.swing))


def _moved(design: RobotOnSurface, quantity: Quantity, value: float) -> RobotOnSurface | None:
    try:
        return quantity.put(design, value)
    except InputError:
        return None
