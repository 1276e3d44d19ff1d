"""States fitted again: with other effects, in another view, scored on the runs left out of each refit."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.evidence import intervals
from slipmargin.diagnosis.fit import Fit, spans
from slipmargin.diagnosis.left_out import folds, refitted_without
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good, worthwhile
from slipmargin.diagnosis.tolerance import fitted_finely
from slipmargin.diagnosis.verdict import sign_flip_p_value


def scored(view: Problem, found: Fit, samples: float, runs: Sequence[int]) -> State:
    """A fit with its score: refitted without each fold of the runs."""
    parts = tuple(folds(runs, SETTINGS.folds))
    xs, scores = refitted_without(view, found, parts)
    return State(fit=found, scores=scores, samples=samples, view=view, parts=parts, xs=xs)


def fitted(
    view: Problem,
    structure: tuple[Candidate, ...],
    x: Array,
    trials: Index,
    runs: Sequence[int],
    expired: Callable[[], bool] = lambda: False,
    give_up_above: float = np.inf,
) -> State:
    """A structure fitted to trials from ``x``, with its score; by one step where the time has ``expired``.

    It is not fitted to the end where its cost would stay above ``give_up_above``.
    """
    view, found = fitted_finely(view, structure, x, trials, expired, give_up_above)
    return scored(view, found, view.samples(trials), runs)


def refitted(
    state: State,
    structure: tuple[Candidate, ...],
    x: Array,
    runs: Sequence[int],
    give_up_above: float = np.inf,
) -> State:
    """Another structure in the view, and on the trials, of ``state``."""
    return fitted(state.view, structure, x, state.fit.trials, runs, give_up_above=give_up_above)


def evened(state: State, seen: Index, runs: Sequence[int]) -> State:
    """The state in the view in which none of the trials ``seen`` outweighs the others."""
    view = state.view.evened(state.fit.effects, seen)
    if np.array_equal(view.weights, state.view.weights):
        return state
    return fitted(view, state.structure, state.fit.x, state.fit.trials, runs)


def without(state: State, index: int, runs: Sequence[int]) -> State:
    """The state less one of its effects, the others fitted again."""
    known, asked = state.fewer, (index, tuple(runs))
    if asked not in known:
        kept = [i for i in range(len(state.structure)) if i != index]
        own = spans(state.structure)
        x = np.concatenate([np.zeros(0), *(state.fit.x[own[i]] for i in kept)])
        known[asked] = refitted(state, tuple(state.structure[i] for i in kept), x, runs)
    return known[asked]


def needed(state: State, runs: Sequence[int], *, fresh: Candidate | None = None) -> State:
    """Now that all are known: drop, least useful first, every effect that the others make superfluous, or
    whose parameters may all be null as far as these trials say.

    ``fresh``, a name that was worth adding on fewer trials, is superfluous on these only where the others are
    as good without it.
    """
    while len(state.structure) > 1:
        fewer = [without(state, index, runs) for index in range(len(state.structure))]
        idle = nothing_sure(state, runs)
        least = min(range(len(fewer)), key=lambda i: (not idle[i], fewer[i].chi))
        one, left = state.structure[least], fewer[least]
        superfluous = as_good(left, state) if one is fresh else not worthwhile(left, state.chi, one.named)
        if not idle[least] and not superfluous:
            break
        state = fewer[least]
    return state


def nothing_sure(state: State, runs: Sequence[int]) -> list[bool]:
    """For each effect, whether it is a named one and these trials leave it open that it does nothing.

    Far above the noise, where ``runs`` are compared in pieces, none is: there the runs disagree over whatever
    is still missing, which widens every interval, and the error of runs that are left out decides alone.  So
    it does where whole runs still leave much, if it is larger without the effect, beyond chance.
    """
    if state.view.piece is not None:
        return [False] * len(state.structure)
    spread = intervals(state.fit)
    own = zip(state.structure, spans(state.structure), strict=True)
    left_open = [c.named and c.nested and spread.may_do_nothing(c, state.fit.x, span) for c, span in own]
    return [idle and not _missed(state, index, runs) for index, idle in enumerate(left_open)]


def _missed(state: State, index: int, runs: Sequence[int]) -> bool:
    """Whether much is left, and runs left out are predicted worse without an effect than chance allows."""
    if state.chi <= SETTINGS.noise_chi:
        return False
    grows = np.bincount(runs, weights=without(state, index, runs).scores - state.scores)
    return sign_flip_p_value(np.asarray(grows, dtype=float)) <= SETTINGS.significance


def whole(
    problem: Problem, state: State, runs: Sequence[int], expired: Callable[[], bool] = lambda: False
) -> State:
    """A state found in pieces, fitted to whole runs where these come near the noise."""
    if state.view.piece is None:
        return state
    trials = state.fit.trials
    off = float(np.sum(problem.residuals([state.fit.effects], [trials])[0] ** 2))
    if np.sqrt(off / state.samples) > SETTINGS.within_reach * SETTINGS.far_chi:
        return state
    full = fitted(problem, state.structure, state.fit.x, trials, runs, expired)
    return full if full.chi <= SETTINGS.far_chi else state


def longer(problem: Problem, state: State, runs: Sequence[int], least_s: float = 0.0) -> State:
    """A state found in pieces, fitted to whole runs, or to the shortest pieces in which the rest stands out.

    What a model still lacks adds up along a run: pieces in which the rest is near the noise hide it.  They
    are at least ``least_s`` long, as far as a run has two of them.
    """
    state = whole(problem, state, runs)
    trials, x = state.fit.trials, state.fit.x
    most_s = longest_piece_s(problem, trials)
    while state.view.piece is not None and 2.0 * state.view.piece_s <= most_s:
        if state.chi >= SETTINGS.far_chi and state.view.piece_s >= least_s:
            break
        state = fitted(problem.in_pieces(2.0 * state.view.piece_s), state.structure, x, trials, runs)
    return state


def longest_piece_s(problem: Problem, trials: Index) -> float:
    """The longest pieces [s]: half a run, that there are two of them."""
    return 0.5 * float(np.median([np.ptp(problem.trials[i].t_s) for i in trials]))
