"""Forward selection: one named effect, one general form, two named effects, then one more at a time.

The order is that of parsimony.  Each stage ends the search if it brings the residual down to the
noise; a later stage must do clearly better than an earlier one.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Index
from slipmargin.diagnose.candidate import Candidate
from slipmargin.diagnose.evidence import luck
from slipmargin.diagnose.fit import evaluate, fit, tangents
from slipmargin.diagnose.problem import Problem
from slipmargin.diagnose.search import (
    AT_NOISE,
    Progress,
    Round,
    State,
    base_state,
    choose,
    extend,
    promise,
    short_fits,
    some_of,
    state_of,
)
from slipmargin.errors import InputError

#: An effect is taken only if it is beyond luck at this level …
SIGNIFICANCE = 0.01
#: … and the cross-validated chi falls by at least this share and this much: less than that is within
#: what the reconstruction of the wheels' motion from the log leaves behind.
LEAST_SHARE, LEAST_CHI = 0.02, 0.02
#: On top of an effect without a name chi must fall to this share: its form is only approximate, and
#: what it leaves must not be given names.
ON_TOP_OF_UNNAMED = 0.7
#: A general form that leaves less than this is good enough not to look for pairs of names.
NEAR_NOISE = 1.3
#: No model predicts better than this.
_FLOOR = 0.97
#: At most so many effects.
MOST_EFFECTS = 4
#: How many named effects and general forms are fitted, by the gain their tangent promises.
_NAMED, _GENERAL = 14, 10
#: How many single effects are tried as the first of two, and how many pairs get a full fit.
_FIRSTS, _SECONDS, _PAIRS = 6, 4, 4


def search(
    problem: Problem, trials: Index, suspects: list[Candidate], seed: int, progress: Progress
) -> tuple[State, list[Round]]:
    """What the model lacks, judged on ``trials``, and the rounds in which it was found."""
    state = base_state(problem, trials, problem.samples(trials))
    rounds: list[Round] = []
    for number in range(MOST_EFFECTS):
        stage = _staged(progress, f"round {number + 1}")
        step = take_step(problem, state, suspects, seed, stage, pairs=number == 0)
        rounds.append(step)
        if not step.taken or step.best is None:
            break
        state = step.best
        if len(state.structure) >= MOST_EFFECTS:
            break
    return _needed(problem, state), rounds


def take_step(
    problem: Problem, before: State, suspects: list[Candidate], seed: int, progress: Progress, pairs: bool
) -> Round:
    """The best addition to ``before``, and whether it is beyond luck and worth its parameters."""
    inside = {c.label for c in before.structure}
    fresh = [s for s in suspects if s.label not in inside and _possible(problem, before, s)]
    progress("comparing with every suspect", 0.0)
    slopes = tangents(problem, before.fit, fresh)
    hopes = [promise(before.fit.residual, slope) for slope in slopes]
    step_s = float(np.median(np.concatenate([np.diff(t.t_s) for t in problem.trials])))
    reachable = float(np.sqrt(max(0.0, before.chi**2 - max(hopes) / before.samples)))
    hopeless = before.chi < AT_NOISE and not worthwhile(before, reachable)
    if hopeless or not worthwhile(before, _FLOOR):
        p_value = luck(max(hopes), slopes, before.fit.residual, step_s, seed)
        return Round(
            before=before,
            suspects=tuple(fresh),
            hopes=tuple(hopes),
            tried=(),
            best=None,
            p_value=p_value,
            taken=False,
        )
    order = np.argsort(hopes)[::-1]
    named = [fresh[i] for i in order if fresh[i].named][:_NAMED]
    general = [fresh[i] for i in order if not fresh[i].named][:_GENERAL]
    tried = extend(problem, before, named, progress, enough=AT_NOISE)
    if not tried or tried[0].chi > AT_NOISE:
        singles = list(tried)
        tried = sorted([*tried, *extend(problem, before, general, progress, enough=AT_NOISE)], key=_total)
        if tried[0].chi > NEAR_NOISE and pairs:
            plain = [s for s in fresh if s.named and " " not in s.label]
            tried = sorted([*tried, *_pairs(problem, singles, plain, progress)], key=_total)
    best = choose(tried)
    p_value = luck(before.fit.cost - best.fit.cost, slopes, best.fit.residual, step_s, seed)
    return Round(
        before=before,
        suspects=tuple(fresh),
        hopes=tuple(hopes),
        tried=tuple(tried),
        best=best,
        p_value=p_value,
        taken=p_value <= SIGNIFICANCE and worthwhile(before, best.chi),
    )


def _possible(problem: Problem, before: State, suspect: Candidate) -> bool:
    """Whether the suspect can stand beside what is known: two laws for one thing refuse each other."""
    try:
        problem.model((*before.fit.effects, suspect.build(suspect.starts[0])))
    except InputError:
        return False
    return True


def _pairs(problem: Problem, singles: list[State], plain: list[Candidate], progress: Progress) -> list[State]:
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
        stage = _staged(progress, f"{first.last.label} and")
        alone = evaluate(problem, first.structure, first.fit.x, some)
        others = [c for c in plain if c.name != first.last.name and _possible(problem, first, c)]
        slopes = tangents(problem, alone, others)
        order = np.argsort([promise(alone.residual, slope) for slope in slopes])[::-1]
        short += short_fits(problem, first, [others[i] for i in order[:_SECONDS]], some, stage)
    short.sort(key=lambda f: f.cost)
    states = []
    for found in short[:_PAIRS]:
        progress("fitting " + " and ".join(c.label for c in found.structure), 0.9)
        states.append(state_of(problem, fit(problem, found.structure, found.x, trials), singles[0].samples))
        if states[-1].chi <= AT_NOISE:
            break
    return states


def _total(state: State) -> float:
    return float(state.scores.sum())


def worthwhile(before: State, chi: float) -> bool:
    """Whether chi falls by more than what the log's reconstruction, or an unnamed form, may leave."""
    if any(not c.named for c in before.structure):
        return chi <= ON_TOP_OF_UNNAMED * before.chi
    return before.chi - chi >= max(LEAST_CHI, LEAST_SHARE * before.chi)


def without(problem: Problem, state: State, index: int) -> State:
    """The state less one of its effects, the others fitted again."""
    kept = [i for i in range(len(state.structure)) if i != index]
    at = np.cumsum([0, *(c.size for c in state.structure)])
    x = np.concatenate([np.zeros(0), *(state.fit.x[at[i] : at[i + 1]] for i in kept)])
    structure = tuple(state.structure[i] for i in kept)
    return state_of(problem, fit(problem, structure, x, state.fit.trials), state.samples)


def _needed(problem: Problem, state: State) -> State:
    """Now that all are known: drop every effect that the others make superfluous."""
    index = 0
    while index < len(state.structure) and len(state.structure) > 1:
        less = without(problem, state, index)
        if worthwhile(less, state.chi):
            index += 1
        else:
            state, index = less, 0
    return state


def _staged(progress: Progress, stage: str) -> Progress:
    return lambda text, share: progress(f"{stage}: {text}", share)
