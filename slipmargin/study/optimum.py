"""The best design between the grid's points; it is never worse than the best point of the grid.

The objectives are minima of smooth pieces, so gradients jump at kinks and are not used.  From
each of the grid's best local maxima the search continues inside the neighbouring cells: by golden section and
parabolas in one variable (Brent), by the Nelder–Mead simplex in more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.limits.motion import needed_share
from slipmargin.limits.motion_state import Motion
from slipmargin.limits.self_check import self_check
from slipmargin.study.columns import STEP_DEG
from slipmargin.study.evaluate import evaluate
from slipmargin.study.objectives import Kind, Objective
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.study import Study
from slipmargin.study.vary import applied

#: Local maxima of the grid from which the search starts, and evaluations of each search by kind.
STARTS = {Kind.STATIC: 5, Kind.MOTION: 3, Kind.LAPS: 1}
EFFORT = {Kind.STATIC: 200, Kind.MOTION: 80, Kind.LAPS: 30}
#: An improvement below this share is rounding [1].
NOISE = 1e-12


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Optimum:
    """The best design found between and on the grid's points.

    ``values`` of the varied quantities; ``value`` of the objective there, ``grid_value`` at the grid's
    best row; ``gain`` ≥ 0 the improvement in the sense of the objective; ``check`` relative
    difference of ``value`` to an independent computation (NaN where there is none); ``evaluations``.
    """

    goal: Objective
    values: tuple[Any, ...]
    design: RobotOnSurface
    value: float
    grid_value: float
    check: float
    evaluations: int

    @property
    def gain(self) -> float:
        """How much better than every point of the grid, ≥ 0."""
        return self.goal.sign * (self.value - self.grid_value)


def optimum(study: Study, goal: Objective | None = None) -> Optimum:
    """Search on from the grid's best points in every quantity that is a number.

    Raises
    ------
    InputError
        If no varied quantity is a number that may vary continuously, or no design is possible.
    """
    goal = goal or study.problem.objective
    free = [k for k, grid in enumerate(study.problem.grids) if grid.numeric and len(grid.values) > 1]
    if not free:
        raise InputError("optimum", "has nothing to vary continuously", "vary a number over a range")
    row = study.best(goal.name)
    best, at, spent = goal.sign * float(study.columns[goal.name][row]), study.values[row], 0
    for start in _starts(study, goal, free):
        search = _Search(study, goal, start, free)
        values, score = search.run()
        spent += search.count
        if score > best + NOISE * abs(best):
            best, at = score, values
    design = applied(study.problem.base, [g.quantity for g in study.problem.grids], at)
    return Optimum(
        goal=goal,
        values=tuple(at),
        design=design,
        value=goal.sign * best,
        grid_value=float(study.columns[goal.name][row]),
        evaluations=spent,
        check=checked_again(design, goal, goal.sign * best),
    )


def _starts(study: Study, goal: Objective, free: Sequence[int]) -> list[int]:
    """Rows that no neighbour along a free axis beats, the best first."""
    score = np.nan_to_num(goal.sign * study.shaped(goal.name), nan=-np.inf)
    top = np.isfinite(score)
    for axis in free:
        padded = np.pad(
            score, [(1, 1) if k == axis else (0, 0) for k in range(score.ndim)], constant_values=-np.inf
        )
        count = score.shape[axis]
        top &= score >= np.take(padded, range(count), axis=axis)
        top &= score >= np.take(padded, range(2, count + 2), axis=axis)
    rows = np.flatnonzero(top.ravel())
    order = rows[np.argsort(-score.ravel()[rows], kind="stable")]
    return [int(r) for r in order[: STARTS[goal.kind]]]


class _Search:
    """One local search, with the count of its evaluations."""

    def __init__(self, study: Study, goal: Objective, row: int, free: Sequence[int]) -> None:
        self.study, self.goal, self.free, self.count = study, goal, list(free), 0
        self.start = list(study.values[row])
        self.bounds = [_cell(study.problem.grids[k].values, study.values[row][k]) for k in free]

    def score(self, x: Array) -> float:
        """Minus the objective in its sense, large where the design is impossible."""
        self.count += 1
        try:
            quantities = [g.quantity for g in self.study.problem.grids]
            design = applied(self.study.problem.base, quantities, self.at(x))
        except InputError:
            return 1e300
        value = float(evaluate([design], self.goal)[0])
        return 1e300 if math.isnan(value) else -self.goal.sign * value

    def at(self, x: Array) -> tuple[Any, ...]:
        """All values with the free ones at ``x``."""
        values = list(self.start)
        for k, v in zip(self.free, x, strict=True):
            values[k] = float(v)
        return tuple(values)

    def run(self) -> tuple[tuple[Any, ...], float]:
        """The best values and the objective there, in its sense."""
        from scipy.optimize import minimize, minimize_scalar

        effort = EFFORT[self.goal.kind]
        if len(self.free) == 1:
            low, high = self.bounds[0]
            found = minimize_scalar(
                lambda v: self.score(np.array([v])),
                bounds=(low, high),
                method="bounded",
                options={"xatol": 1e-7 * (high - low), "maxiter": effort},
            )
            x = np.array([found.x])
        else:
            first = np.array([float(self.start[k]) for k in self.free])
            span = np.array(
                [
                    [
                        high - first[i] if high - first[i] >= first[i] - low else low - first[i]
                        for i, (low, high) in enumerate(self.bounds)
                    ]
                ]
            )
            simplex = np.vstack([first, first + 0.5 * np.diag(span[0])])
            found = minimize(
                self.score,
                first,
                method="Nelder-Mead",
                bounds=self.bounds,
                options={
                    "maxfev": effort * len(self.free),
                    "xatol": 1e-7,
                    "fatol": 1e-12,
                    "initial_simplex": simplex,
                },
            )
            x = found.x
        return self.at(x), -float(found.fun)


def _cell(values: Sequence[Any], at: Any) -> tuple[float, float]:
    ordered = sorted(float(v) for v in values)
    k = ordered.index(float(at))
    return ordered[max(k - 1, 0)], ordered[min(k + 1, len(ordered) - 1)]


def checked_again(design: RobotOnSurface, goal: Objective, value: float) -> float:
    """Return the relative difference of an objective to an independent computation [1]; NaN if there is none.

    The least pull is compared with the support function's minimum at the worst heading.  For the least
    acceleration the grip utilisation that it needs must be exactly 1.
    """
    from slipmargin.limits.bounds import directions, headings
    from slipmargin.study.columns import WORST_AT, static_columns

    if not value > 0.0:
        return math.nan  # it slips there: nothing is held that a second method could find
    model = design.build()
    if goal.name == "f_worst":
        phi = static_columns([design], names=[WORST_AT])[0][WORST_AT]
        return self_check(model, phi, np.array([value * model.inertia.weight_N]))
    if goal.name == "start_worst_m_s2":
        way = headings(STEP_DEG)
        at = int(np.argmin(directions(model, way).starting_m_s2))
        ahead = np.round(np.array([[math.cos(way[at]), math.sin(way[at]), 0.0]]), 15)
        motion = replace(Motion.full_drag(ahead), acceleration=value * ahead)
        return abs(float(needed_share(model, motion)[0]) - 1.0)
    return math.nan
