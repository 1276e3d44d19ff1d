"""Forward selection: add the best suspect, round by round, then look at each a second time."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnose.candidate import Candidate
from slipmargin.diagnose.evidence import luck
from slipmargin.diagnose.fit import fit, tangents
from slipmargin.diagnose.problem import Problem
from slipmargin.diagnose.search import (
    AT_NOISE,
    Progress,
    Round,
    State,
    base_state,
    choose,
    explore,
    promise,
    state_of,
)

#: An effect is taken only if it is beyond luck at this level …
SIGNIFICANCE = 0.01
#: … and the cross-validated chi falls by at least this share and this much: less than that is within
#: what the reconstruction of the wheels' motion from the log leaves behind.
LEAST_SHARE, LEAST_CHI = 0.02, 0.02
#: At most so many effects.
MOST_EFFECTS = 4


def search(
    problem: Problem, trials: Array, suspects: list[Candidate], seed: int, progress: Progress
) -> tuple[State, list[Round]]:
    """Forward selection on ``trials``, then a second look at every effect but the last.

    Returns
    -------
    State, list of Round
        What the model lacks, and how it was found.
    """
    state = base_state(problem, trials, problem.samples(trials))
    rounds: list[Round] = []
    for number in range(MOST_EFFECTS):
        step = take_step(problem, state, suspects, seed, _staged(progress, f"round {number + 1}"))
        rounds.append(step)
        if not step.taken or step.best is None:
            break
        state = step.best
    return _second_look(problem, state, suspects, progress), rounds


def take_step(
    problem: Problem, before: State, suspects: list[Candidate], seed: int, progress: Progress
) -> Round:
    """Try every suspect that is not yet in ``before`` and judge the best one."""
    inside = {c.label for c in before.structure}
    fresh = [s for s in suspects if s.label not in inside]
    progress("comparing with every suspect", 0.0)
    slopes = tangents(problem, before.fit, fresh)
    hopes = [promise(before.fit.residual, slope) for slope in slopes]
    step_s = float(np.median(np.concatenate([np.diff(t.t_s) for t in problem.trials])))
    reachable = np.sqrt(max(0.0, before.chi**2 - max(hopes) / before.samples))
    if before.chi < AT_NOISE and not worthwhile(before.chi, reachable):
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
    tried = explore(problem, before, fresh, slopes, progress)
    best = choose(tried)
    gain = before.fit.cost - best.fit.cost
    p_value = luck(gain, slopes, best.fit.residual, step_s, seed)
    return Round(
        before=before,
        suspects=tuple(fresh),
        hopes=tuple(hopes),
        tried=tuple(tried),
        best=best,
        p_value=p_value,
        taken=p_value <= SIGNIFICANCE and worthwhile(before.chi, best.chi),
    )


def worthwhile(before: float, after: float) -> bool:
    """Whether chi falls by more than what the log's reconstruction may leave behind."""
    return before - after >= max(LEAST_CHI, LEAST_SHARE * before)


def without(problem: Problem, state: State, index: int) -> State:
    """The state less one of its effects, the others fitted again."""
    kept = [c for i, c in enumerate(state.structure) if i != index]
    at = np.cumsum([0, *(c.size for c in state.structure)])
    x = np.concatenate(
        [state.fit.x[at[i] : at[i + 1]] for i in range(len(state.structure)) if i != index] or [np.zeros(0)]
    )
    return state_of(problem, fit(problem, tuple(kept), x, state.fit.trials), state.samples)


def _second_look(problem: Problem, state: State, suspects: list[Candidate], progress: Progress) -> State:
    """Now that the others are known: is each effect still needed, and still the best of its kind?

    The first effects were chosen while the later ones were still in the residual.
    """
    index = 0
    while index < len(state.structure) and len(state.structure) > 1:
        less = without(problem, state, index)
        if not worthwhile(less.chi, state.chi):
            state, index = less, 0
            continue
        if index < len(state.structure) - 1:
            inside = {c.label for i, c in enumerate(state.structure) if i != index}
            fresh = [s for s in suspects if s.label not in inside]
            slopes = tangents(problem, less.fit, fresh)
            tried = explore(problem, less, fresh, slopes, _staged(progress, "second look"))
            best = choose(tried)
            if best.last.label != state.structure[index].label and (
                best.chi < state.chi or (best.last.named and not state.structure[index].named)
            ):
                state = best
                index = 0 if len(state.structure) < 3 else index + 1
                continue
        index += 1
    return state


def _staged(progress: Progress, stage: str) -> Progress:
    return lambda text, share: progress(f"{stage}: {text}", share)
