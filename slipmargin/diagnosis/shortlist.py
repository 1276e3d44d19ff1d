"""The shortlist: the few states out of all candidates that are fitted to the end and compared.

Named effects come first; if they leave a residual, general forms; if these do too, pairs of named effects.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import evaluate, fit, tangents
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.search import (
    State,
    by_chi,
    choose,
    extend,
    score_test_gain,
    short_fits,
    some_of,
    state_of,
)
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import Trace
from slipmargin.errors import InputError

#: How many of what was found piece by piece are fitted to whole runs, and how far behind the best one.
_CONTENDERS, _BEHIND = 3, 3.0
#: How many named effects and general forms are fitted, by the gain their tangent promises.
_NAMED, _GENERAL = 40, 10
#: How many single effects are tried as the first of two, and how many pairs get a full fit.
_FIRSTS, _SECONDS, _PAIRS = 6, 4, 4


def try_all(
    view: Problem,
    before: State,
    fresh: list[Candidate],
    slopes: list[Array],
    progress: Watch,
    pairs: bool,
) -> tuple[list[State], list[Array]]:
    """Named effects; where they leave something, general forms; where these do, pairs of names.

    ``slopes`` are the tangents known of ``fresh``, which has the names first; those that were needed
    come back.
    """
    names = [s for s in fresh if s.named]
    slopes = slopes or tangents(view, before.fit, names)
    later = bool(before.structure)
    named = _promising(before, names, slopes)[: _NAMED // 2 if later else _NAMED]
    tried = extend(view, before, named, progress, enough=SETTINGS.at_noise_chi)
    if tried and (tried[0].chi <= SETTINGS.at_noise_chi or progress.expired):
        return tried, slopes
    singles, forms = list(tried), fresh[len(names) :]
    if len(slopes) == len(names):
        slopes = [*slopes, *tangents(view, before.fit, forms)]
    general = _promising(before, forms, slopes[len(names) :])
    general = general[: _GENERAL // 2] if later else _of_every_variable(general)
    tried = sorted(
        [*tried, *extend(view, before, general, progress, enough=SETTINGS.at_noise_chi)], key=by_chi
    )
    if (
        pairs
        and not progress.expired
        and (tried[0].chi > SETTINGS.noise_chi or before.chi > SETTINGS.far_chi)
    ):
        tried = sorted([*tried, *_pairs(view, singles, names, progress)], key=by_chi)
    return tried, slopes


def _promising(before: State, candidates: list[Candidate], slopes: list[Array]) -> list[Candidate]:
    """Those whose tangents promise most first."""
    gains = [score_test_gain(before.fit.residual, slope) for slope in slopes[: len(candidates)]]
    return [candidates[i] for i in np.argsort(gains, kind="stable")[::-1]]


def _of_every_variable(promising_first: list[Candidate]) -> list[Candidate]:
    """The most promising forms, and the best one of every variable even where it promises little."""
    seen: set[Trace] = set()
    kept = []
    for place, form in enumerate(promising_first):
        if place < _GENERAL or form.trace not in seen:
            kept.append(form)
        seen.add(form.trace)
    return kept


def contenders(tried: list[State]) -> list[State]:
    """The best few, and the best of each kind: one name, one general form, two names."""
    near = [s for s in tried if s.chi <= _BEHIND * tried[0].chi]
    kinds = {(len(s.structure), s.last.named): s for s in reversed(near)}
    return [s for i, s in enumerate(near) if i < _CONTENDERS or s in kinds.values() or s is choose(tried)]


def possible(problem: Problem, before: State, candidate: Candidate) -> bool:
    """Whether the candidate can stand beside what is known: two laws for one thing refuse each other."""
    try:
        problem.model((*before.fit.effects, candidate.build(candidate.starts[0])))
    except InputError:
        return False
    return True


def _pairs(problem: Problem, singles: list[State], plain: list[Candidate], progress: Watch) -> list[State]:
    """Two named effects at once: where two are missing, neither alone need look good.

    Each of the best singles is joined, on some of the trials, by the named effects whose tangents
    promise most beside it; the best pairs are then fitted on all trials.
    """
    if not singles:
        return []
    trials = singles[0].fit.trials
    some = some_of(trials)
    short = []
    for first in singles[:_FIRSTS]:
        stage = progress.staged(f"{first.last.label} and")
        alone = evaluate(problem, first.structure, first.fit.x, some)
        others = [c for c in plain if c.name != first.last.name and possible(problem, first, c)]
        slopes = tangents(problem, alone, others)
        order = np.argsort([score_test_gain(alone.residual, slope) for slope in slopes])[::-1]
        short += short_fits(problem, first, [others[i] for i in order[:_SECONDS]], some, stage)
    short.sort(key=lambda f: f.cost)
    states = []
    for found in short[:_PAIRS]:
        progress("fitting " + " and ".join(c.label for c in found.structure), 0.9)
        states.append(state_of(problem, fit(problem, found.structure, found.x, trials), singles[0].samples))
        if states[-1].chi <= SETTINGS.at_noise_chi or progress.expired:
            break
    return states
