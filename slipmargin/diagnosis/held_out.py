"""Errors of runs predicted with parameters that were fitted to other runs.

A run that was held out of the search is predicted with what was fitted to the searched ones.  The
searched runs are left out in turn, a fold at a time, and the parameters fitted again to the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.record import Record
from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import build
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Score
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.verdict import RunErrors
from slipmargin.effects import AnyEffect

Effects = tuple[AnyEffect, ...]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """Errors of some trials, a row each, and whether wheel phases came from their first parts.

    ``problem`` has these phases.
    """

    errors: RunErrors
    problem: Problem
    phased: bool


def held_out_runs(misses: Array, seed: int) -> Index:
    """Numbers of whole runs that nothing but the final comparison may see.

    Runs that the model as it is misses by much are as rare among them as among all: sorted by ``misses``
    (R,), the root mean squares in units of the noise of what the model as it is misses them by, one of each
    of equally large parts is drawn.  The run that is farthest off stays with the search; the first one drawn
    is about as far off as the next.
    """
    count = len(misses)
    if count < SETTINGS.enough_to_hold_out:
        return np.zeros(0, dtype=np.int64)
    order = np.argsort(-np.asarray(misses), kind="stable")
    first, *others = np.array_split(order, max(2, round(SETTINGS.held_out_share * count)))
    beyond = np.maximum(misses[first[1:]] - 1.0, 0.0)  # what the noise does not explain
    far = first[1:][beyond >= 0.5 * beyond[0]]
    random = np.random.default_rng(seed)
    return np.sort([random.choice(part) for part in (far, *others)]).astype(np.int64)


def searched_runs(count: int, held: Index) -> Index:
    """Numbers of the other runs."""
    return np.setdiff1d(np.arange(count), held).astype(np.int64)


def predicted(
    problem: Problem, trials: Index, records: Sequence[Record], effects: Sequence[Effects], phased: bool
) -> Prediction:
    """Errors of ``trials``, each predicted with its own set of effects.

    Where wheel phases are unknown and matter (``phased``), they are estimated from the first part of each
    run, and only the rest of it is scored.
    """
    view, scored = problem, problem
    if phased:
        view, ends = wheel_phase.from_first_parts(problem, trials, records, effects)
        scored = view.seen_after(ends)
    if all(e is effects[0] for e in effects):
        found = scored.compare([effects[0]], [trials])
    else:
        found = scored.compare(effects, [trials[i : i + 1] for i in range(len(trials))])
    pose, gap = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return Prediction(errors=errors_of(scored, trials, pose, gap), problem=view, phased=phased)


def sets_of_effects(structure: tuple[Candidate, ...], xs: Array) -> list[Effects]:
    """The effects at each row of parameters."""
    return [build(structure, x) for x in xs]


def phases_matter(problem: Problem, effects: Effects) -> bool:
    """Whether wheel phases are unknown and the model, before or after, depends on them."""
    return wheel_phase.is_unknown(problem) and any(
        wheel_phase.matters_to(problem.model(e)) for e in ((), effects)
    )


def by_run(errors: RunErrors, runs: Sequence[int]) -> RunErrors:
    """Errors of trials added up for each run that they are cut from, in the order of the runs."""
    different, row = np.unique(runs, return_inverse=True)
    assert errors.raw is not None
    squares, counts, raw = (np.zeros((len(different), 3)) for _ in range(3))
    np.add.at(squares, row, errors.squares)
    np.add.at(counts, row, errors.counts)
    np.add.at(raw, row, errors.raw)
    return RunErrors(squares=squares, counts=counts, raw=raw)


def score(errors: RunErrors, runs: Index) -> Score:
    """Root mean square errors and chi of some runs."""
    some = errors.of(runs)
    assert some.raw is not None
    x, y, turn = some.raw.sum(axis=0) / np.maximum(1.0, some.counts.sum(axis=0))
    return Score(
        rmse_position_m=float(np.sqrt(x + y)),
        rmse_heading_rad=float(np.sqrt(turn)),
        chi=errors.chi(runs),
    )


def errors_of(problem: Problem, trials: Index, pose: Array, gap: Array) -> RunErrors:
    """Sums over the samples of each trial; ``gap`` (R, T, 3) is whitened."""
    seen = problem.seen[trials]
    most = SETTINGS.wild * problem.sigma
    off = np.where(seen, problem.measured[trials] - pose, 0.0)
    off = np.clip(np.where(np.isfinite(off), off, most), -most, most)
    gap = np.where(seen, gap, 0.0)
    return RunErrors(
        squares=np.sum(gap**2, axis=1),
        counts=seen.sum(axis=1).astype(float),
        raw=np.sum(off**2, axis=1),
    )
