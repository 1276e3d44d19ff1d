"""Forward selection: one named effect, one general form, two named effects, then one more at a time.

The order is that of parsimony.  Each stage ends the search if it brings the residual down to the
noise; a later stage must do clearly better than an earlier one.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.evidence import intervals, permutation_p_value
from slipmargin.diagnosis.fit import evaluate, fit, tangents
from slipmargin.diagnosis.left_out import leave_one_out
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.search import (
    AT_NOISE,
    FAR,
    Progress,
    Round,
    State,
    base_state,
    by_chi,
    choose,
    judged_by,
    score_test_gain,
    some_of,
    staged,
    state_of,
)
from slipmargin.diagnosis.shortlist import contenders, possible, try_all

#: An effect is taken only if it is significant at this level …
SIGNIFICANCE = 0.01
#: … and chi falls by at least this share and this much: less than that is within
#: what the reconstruction of the wheels' motion from the log leaves behind.
LEAST_SHARE, LEAST_CHI = 0.02, 0.02
#: A further effect must take off more: what the first ones leave is also the fault of their form.
LATER_SHARE = 0.1
#: Where one of two effects has no name, the second must bring chi to this share: a general form is only
#: approximate, so what it leaves must not be given names, nor does it name what a near miss leaves.
WITH_UNNAMED = 0.5
#: No model predicts better than this.
_FLOOR = 0.97
#: At most so many effects.
MOST_EFFECTS = 4
#: Length of a piece while searching [s], and of one in the last fits of what stays far above the noise:
#: long enough that the camera's noise is small beside what a model lacks.
PIECE_S, LONG_PIECE_S = 0.5, 2.0
#: A fit to whole runs seldom takes more than this factor off the chi at which the pieces put them.
_WITHIN_REACH = 3.0


def search(
    problem: Problem, trials: Index, seen: Index, candidates: list[Candidate], seed: int, progress: Progress
) -> tuple[Problem, State, list[Round]]:
    """What the model lacks, judged on ``trials``, and the rounds in which it was found.

    The problem comes back as well: wheel phases that were not logged are estimated on the way, for the
    trials ``seen`` (which contain ``trials``) and for no other.
    """
    unknown = wheel_phase.is_unknown(problem)
    if unknown:
        progress("estimating wheel phases", 0.0)
        problem = wheel_phase.guessed(problem, seen, candidates)
    state = base_state(problem, trials, problem.samples(trials))
    rounds: list[Round] = []
    for number in range(MOST_EFFECTS):
        if number and not worthwhile(state, _FLOOR):
            break
        stage = staged(progress, f"round {number + 1}")
        step = take_step(problem, state, candidates, seed, stage, pairs=number == 0)
        rounds.append(step)
        if not step.taken or step.best is None:
            break
        state = step.best
        if unknown and any(c.wheel_phase for c in state.structure):
            problem, better = wheel_phase.refined(
                problem, evaluate(problem, state.structure, state.fit.x, seen)
            )
            state = state_of(problem, fit(problem, state.structure, better.x, trials), state.samples)
        if len(state.structure) >= MOST_EFFECTS:
            break
    return problem, state, rounds


def take_step(
    problem: Problem, before: State, candidates: list[Candidate], seed: int, progress: Progress, pairs: bool
) -> Round:
    """The best addition to ``before``, and whether it is significant and worth its parameters."""
    inside = {c.label for c in before.structure}
    fresh = [s for s in candidates if s.label not in inside and possible(problem, before, s)]
    fresh.sort(key=lambda s: not s.named)
    progress("comparing with every candidate", 0.0)
    far = before.chi > FAR
    view, start = problem, before
    if far:
        view = problem.in_pieces(PIECE_S)
        pieces = evaluate(view, before.structure, before.fit.x, before.fit.trials)
        start = state_of(view, pieces, before.samples)
    step_s = float(np.median(np.concatenate([np.diff(t.t_s) for t in problem.trials])))
    slopes: list[Array] = []
    if not far:
        look = start
        if before.structure:  # a further effect is looked for on some of the trials first
            some = some_of(before.fit.trials)
            fitted = evaluate(view, before.structure, before.fit.x, some)
            look = state_of(view, fitted, problem.samples(some))
        slopes = tangents(view, look.fit, fresh)
        gains = [score_test_gain(look.fit.residual, slope) for slope in slopes]
        reachable = float(np.sqrt(max(0.0, look.chi**2 - max(gains) / look.samples)))
        no_gain = (look.chi < AT_NOISE or bool(before.structure)) and not worthwhile(look, reachable)
        if no_gain or not worthwhile(before, _FLOOR):
            return Round(
                before=look,
                candidates=tuple(fresh),
                gains=tuple(gains),
                tried=(),
                best=None,
                p_value=permutation_p_value(max(gains), slopes, look.fit.residual, step_s, seed),
                taken=False,
            )
        if look is not start:
            slopes = []
    tried, slopes = try_all(view, start, fresh, slopes, progress, pairs)
    first = choose(tried)
    p_value = permutation_p_value(start.fit.cost - first.fit.cost, slopes, first.fit.residual, step_s, seed)
    if far:
        progress("fitting whole runs", 0.95)
        whole = [(s, _whole(problem, s)) for s in contenders(tried)]
        tried = sorted((w for _, w in whole), key=by_chi)
    best = choose(tried)
    if far and best.chi > FAR:  # whole runs are too bent to choose by: the pieces do
        best = next(w for s, w in whole if s is first)
    return Round(
        before=before,
        candidates=tuple(fresh[: len(slopes)]),
        gains=tuple(score_test_gain(start.fit.residual, slope) for slope in slopes),
        tried=tuple(tried),
        best=best,
        p_value=p_value,
        taken=p_value <= SIGNIFICANCE and worthwhile(before, best.chi, best.last.named),
    )


def _whole(problem: Problem, found: State) -> State:
    """A state found piece by piece, fitted to whole runs if these come near the noise; judged by them."""
    judged = judged_by(problem, found.fit, found.samples)
    if judged.chi > _WITHIN_REACH * FAR:
        return judged
    whole = state_of(problem, fit(problem, found.structure, found.fit.x, found.fit.trials), found.samples)
    return judged if whole.chi > FAR else whole


def last_view(problem: Problem, found: State) -> Problem:
    """How to compare in the last fits: in pieces where what is left is still far above the noise.

    What a model lacks adds up along a run, so that a run that went astray early outweighs the others.
    """
    return problem.in_pieces(LONG_PIECE_S) if found.chi > FAR else problem


def refitted(
    problem: Problem, before: State, structure: tuple[Candidate, ...], x: Array, trials: Index
) -> State:
    """Another structure, or other trials, fitted in the view ``before`` asks for, judged by whole runs."""
    view, samples = last_view(problem, before), problem.samples(trials)
    found = fit(view, structure, x, trials)
    return state_of(problem, found, samples) if view is problem else judged_by(problem, found, samples)


def worthwhile(before: State, chi: float, named: bool = True) -> bool:
    """Whether chi falls by more than what the log's reconstruction, or an unnamed form, may leave."""
    if before.chi <= chi:
        return False
    if before.structure and not (named and all(c.named for c in before.structure)):
        return chi <= WITH_UNNAMED * before.chi
    share = LATER_SHARE if before.structure else LEAST_SHARE
    return before.chi - chi >= max(LEAST_CHI, share * before.chi)


def without(problem: Problem, state: State, index: int) -> State:
    """The state less one of its effects, the others fitted again."""
    kept = [i for i in range(len(state.structure)) if i != index]
    at = np.cumsum([0, *(c.size for c in state.structure)])
    x = np.concatenate([np.zeros(0), *(state.fit.x[at[i] : at[i + 1]] for i in kept)])
    structure = tuple(state.structure[i] for i in kept)
    return refitted(problem, state, structure, x, state.fit.trials)


def needed(problem: Problem, state: State) -> State:
    """Now that all are known: drop, least useful first, every effect that the others make superfluous.

    So is a named effect whose parameters may all be null as far as these trials say.
    """
    while len(state.structure) > 1:
        fewer = [without(problem, state, index) for index in range(len(state.structure))]
        idle = nothing_sure(state)
        least = min(range(len(fewer)), key=lambda i: (not idle[i], fewer[i].chi))
        if not idle[least] and worthwhile(fewer[least], state.chi, state.structure[least].named):
            break
        state = fewer[least]
    return state


def nothing_sure(state: State) -> list[bool]:
    """For each effect, whether it is a named one and every interval of its parameters holds the null."""
    sizes = [c.size for c in state.structure]
    scale = np.concatenate([c.scale for c in state.structure])
    null = np.concatenate([c.null for c in state.structure])
    spread = intervals(state.fit, leave_one_out(state.fit), scale, np.zeros(len(null)), together=False)
    holds = (spread.low <= null) & (null <= spread.high)
    parts = np.split(holds, np.cumsum(sizes)[:-1])
    return [c.named and c.nested and bool(part.all()) for c, part in zip(state.structure, parts, strict=True)]
