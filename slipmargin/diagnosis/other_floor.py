"""Runs of another floor: those that fit another friction than most runs do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import DataSet
from slipmargin.data.repair import Repair, in_runs
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.run_order import grip_times
from slipmargin.diagnosis.settings import SETTINGS

#: Frictions that are tried for each run, as factors of the stated one.
_FRICTIONS = np.geomspace(0.45, 1.8, 8)
#: … and around the other floor's.
_NEAREST = np.geomspace(0.985, 1.015, 7)


def one_floor(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Without the few runs that fit another friction than the others."""
    problem = problem_of(data_set)
    many = len(problem.trials)
    everyone = np.arange(many, dtype=np.int64)
    if many < 4 or np.sqrt(_cost(problem, (1.0,), everyone).max()) < SETTINGS.differs_chi:
        return data_set, ()
    costs = _cost(problem, tuple(_FRICTIONS), everyone)
    best = _two(costs)
    if best is None or best[2] > SETTINGS.two_floors_may_leave:
        return data_set, ()
    near = np.geomspace(0.91, 1.1, 7)
    finer = np.unique(np.concatenate([_FRICTIONS[best[0]] * near, _FRICTIONS[best[1]] * near]))
    costs = _cost(problem, tuple(finer), everyone)
    best = _two(costs)
    if best is None or best[2] > SETTINGS.two_floors_leave:
        return data_set, ()
    usual, other = float(finer[best[0]]), float(finer[best[1]])
    apart = costs[best[1]] * SETTINGS.floor_gains < costs[best[0]]
    factor = other / usual
    if not 0 < apart.sum() <= SETTINGS.other_floor_share * many or not (
        factor > SETTINGS.floors_differ or factor < 1.0 / SETTINGS.floors_differ
    ):
        return data_set, ()
    # A place on the floor, too, makes the few runs that cross it differ, but not from end to end; and a robot
    # of more inertia grips less in runs that turn.  Only what is as good then as the better half of the
    # others is another floor.
    others = np.sort(costs[best[0], ~apart])
    ordinary = max(1.0, float(np.median(others[: (len(others) + 1) // 2])))
    left = _cost(problem, tuple(other * _NEAREST), np.flatnonzero(apart)).mean(axis=1)
    if left.min() > SETTINGS.noise_chi**2 * ordinary:
        return data_set, ()
    factor = other * float(_NEAREST[np.argmin(left)]) / usual
    names = tuple(data_set.trials[i].name for i in np.flatnonzero(apart))
    kept = tuple(t for t, out in zip(data_set.trials, apart, strict=True) if not out)
    return replace(data_set, trials=kept), (
        Repair(
            kind="other_floor",
            runs=names,
            size=factor,
            unit="1",
            sentence=f"The wheels grip {factor:.2f} times as well {in_runs(names, many)} as in the "
            "others, as on another floor: these were left out. Diagnose them as a data set of their own.",
        ),
    )


def _cost(problem: Problem, frictions: tuple[float, ...], runs: Index) -> Array:
    """Mean squared residual (F, R) of each run, over the samples seen, with friction times each of these."""
    wheels = problem.nominal.count
    found = problem.residuals([(grip_times(f, wheels),) for f in frictions], [runs] * len(frictions))
    return np.array([np.sum(r**2, axis=1) / np.maximum(1, np.count_nonzero(r, axis=1)) for r in found])


def _two(costs: Array) -> tuple[int, int, float] | None:
    """The frictions of most runs and of the others, and what two leave of what one leaves."""
    one = float(costs.sum(axis=1).min())
    most = costs.shape[1] * (1.0 - SETTINGS.other_floor_share)
    best: tuple[int, int, float] | None = None
    for usual in range(len(costs)):
        for other in range(len(costs)):
            left = float(np.minimum(costs[usual], costs[other]).sum()) / one
            mine = np.count_nonzero(costs[usual] <= costs[other])
            if other != usual and mine >= most and (best is None or left < best[2]):
                best = usual, other, left
    return best
