"""Starts at lines and places of the floor that the residual points to: the best as simulated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import misfit_of
from slipmargin.diagnosis.screen import Screened
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.tangents import simulated


@final
@dataclass(frozen=True, slots=True, eq=False)
class Spot:
    """A line or place: parameters (Q, P) of a candidate there, and those beside some (P,), by a share of how
    far spots lie apart.
    """

    rows: Array
    beside: Callable[[Array, float], Array]


def best_spots(
    before: State, entry: Screened, spots: Sequence[Spot], overdue: Callable[[], bool] = lambda: False
) -> list[Screened]:
    """An entry that starts at these spots, with what the best of them takes off; none where there are none.

    Each start is the best of its spot, as simulated; the best spots, and the first, are moved to better ones
    beside them.
    """
    base, problem, candidate = before.fit, before.view.rough(), entry.structure[0]

    def best_of(rows: Array) -> list[tuple[float, Array]]:
        """The best of some parameters (Q, P), as simulated; nothing once it is overdue."""
        points = [(*base.effects, candidate.build(x)) for x in rows]
        squares = [float(np.sum(r**2)) for r in simulated(problem, points, base.trials, overdue)]
        return [(min(squares), rows[int(np.argmin(squares))])] if squares else []

    found = [(left, x, spot) for spot in spots for left, x in best_of(spot.rows)]
    order = sorted(range(len(found)), key=lambda k: found[k][0])
    for k in dict.fromkeys([*order[: SETTINGS.starts], *range(len(found))[:1]]):
        for share in (1.0, 0.5):
            left, x, spot = found[k]
            for now, other in best_of(spot.beside(x, share)):
                found[k] = min((left, x, spot), (now, other, spot), key=lambda row: row[0])
    if not found:
        return []
    known = problem.residuals([base.effects], [base.trials])[0]
    found.sort(key=lambda row: row[0])
    promise = float(np.sum(known**2)) - found[0][0] - 2.0 * misfit_of(known) * candidate.size
    return [replace(entry, starts=tuple(x for _, x, _ in found), promise=promise)]
