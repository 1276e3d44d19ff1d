"""Prediction errors on trials with parameters fitted to other trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.record import Record
from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.fit import build
from slipmargin.diagnosis.left_out import leave_one_out
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Score
from slipmargin.diagnosis.search import State
from slipmargin.effects import AnyEffect


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scores:
    """Scores without and with the effects found.

    ``phased`` says whether wheel phases were estimated from the first part of each scored trial, in which
    case the scores are those of the rest.  ``problem`` has these phases where trials were held out.
    """

    before: Score
    after: Score
    problem: Problem
    phased: bool


def scores(
    problem: Problem, state: State, judged: Index, runs: Sequence[Record], cross_validated: bool
) -> Scores:
    """Scores of the trials ``judged``.

    Parameters
    ----------
    problem : Problem
        All trials.
    state : State
        The effects found, fitted to the trials that were searched.
    judged : array (K,) of int
        Trials that were held out; all trials where ``cross_validated``.
    runs : sequence of K Record
        The run that each of them is, or is cut from.
    cross_validated : bool
        Whether each trial is predicted with parameters fitted to the others, because none was held out.
    """
    none: list[tuple[AnyEffect, ...]] = [()] * len(judged)
    with_effects = [state.fit.effects] * len(judged)
    if cross_validated and len(state.fit.x):
        with_effects = [build(state.structure, x) for x in leave_one_out(state.fit)]
    phased = wheel_phase.is_unknown(problem) and any(
        wheel_phase.matters_to(problem.model(effects)) for effects in ((), state.fit.effects)
    )
    if not phased:
        before = _score(problem, judged, none)
        after = _score(problem, judged, with_effects) if len(state.fit.x) else before
        return Scores(before=before, after=after, problem=problem, phased=False)
    found, view = [], problem
    for effects in (none, with_effects):
        view, ends = wheel_phase.from_first_parts(problem, judged, runs, effects)
        found.append(_score(view.seen_after(ends), judged, effects))
    return Scores(before=found[0], after=found[1], problem=problem if cross_validated else view, phased=True)


def _score(problem: Problem, judged: Index, effects: Sequence[tuple[AnyEffect, ...]]) -> Score:
    if all(e is effects[0] for e in effects):
        pose = problem.predict([effects[0]], [judged])[0]
    else:
        pose = np.concatenate(problem.predict(effects, [judged[i : i + 1] for i in range(len(judged))]))
    return _compared(problem, judged, pose)


def _compared(problem: Problem, judged: Index, pose: Array) -> Score:
    seen = problem.seen[judged]
    gap = np.where(seen, problem.measured[judged] - pose, 0.0)
    both = seen[..., 0] & seen[..., 1]
    return Score(
        rmse_position_m=float(np.sqrt(np.sum(gap[..., :2] ** 2) / max(1, both.sum()))),
        rmse_heading_rad=float(np.sqrt(np.sum(gap[..., 2] ** 2) / max(1, seen[..., 2].sum()))),
        chi=float(np.sqrt(np.sum((gap / problem.sigma) ** 2) / max(1, seen.sum()))),
    )
