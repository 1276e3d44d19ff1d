"""Find what is missing: try every suspect, let trials it has not seen decide, add the best, repeat.

A suspect's score is its cross-validated sum of squares: each trial predicted with parameters fitted
to the others.  A named effect is preferred to a general form that explains no more, and a simple one
to a complicated one; a general form that explains clearly more denies the name.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnose.candidate import Candidate
from slipmargin.diagnose.fit import Fit, Residuals, cross_validate, evaluate, fit
from slipmargin.effects import Trace

#: A suspect is as good as the best one if its cross-validated chi is within this factor and offset.
AS_GOOD_FACTOR, AS_GOOD_OFFSET = 1.06, 0.02
#: How many suspects go from the first, short fit to the full one.
_FINALISTS = 6
#: A cross-validated chi this close to 1 leaves nothing for another form to explain.
AT_NOISE = 1.06
#: How many named effects and general forms get the short one, by the gain their tangent promises.
_NAMED, _GENERAL = 16, 10

Progress = Callable[[str, float], None]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """A set of effects, fitted; ``scores`` (R,) is each trial's cross-validated sum of squares."""

    fit: Fit
    scores: Array
    samples: float

    @property
    def chi(self) -> float:
        """Cross-validated chi: root mean square of residual over noise."""
        return float(np.sqrt(self.scores.sum() / self.samples))

    @property
    def structure(self) -> tuple[Candidate, ...]:
        """The suspects in it."""
        return self.fit.structure

    @property
    def last(self) -> Candidate:
        """The suspect added last."""
        return self.fit.structure[-1]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Round:
    """One step of the search: where it started, what was tried (best first), what was taken, if any.

    ``hopes`` are the gains that the suspects' tangents promise; where none of them could lower chi
    noticeably, nothing was fitted and ``best`` is None.
    """

    before: State
    suspects: tuple[Candidate, ...]
    hopes: tuple[float, ...]
    tried: tuple[State, ...]
    best: State | None
    p_value: float
    taken: bool

    def rivals(self) -> list[State]:
        """States that these trials cannot tell from the best one."""
        best = self.best
        if best is None:
            return []
        return [s for s in self.tried if s is not best and indistinguishable(s, best)]


def state_of(problem: Residuals, found: Fit, samples: float) -> State:
    """A fit with its cross-validated scores."""
    return State(fit=found, scores=cross_validate(problem, found), samples=samples)


def base_state(problem: Residuals, trials: Array, samples: float) -> State:
    """The model as it stands, with no effect added."""
    return state_of(problem, evaluate(problem, (), np.zeros(0), trials), samples)


def explore(
    problem: Residuals, before: State, suspects: list[Candidate], slopes: list[Array], progress: Progress
) -> list[State]:
    """The promising suspects added to ``before`` and fitted; best cross-validated first.

    ``slopes`` are the suspects' tangents at null: the gain they promise decides who gets a short fit
    from each start, and the best of those get a full one.  General forms have their turn where no
    named effect brings the residual down to the noise.
    """
    order = np.argsort([promise(before.fit.residual, slope) for slope in slopes])[::-1]
    named = [suspects[i] for i in order if suspects[i].named][:_NAMED]
    general = [suspects[i] for i in order if not suspects[i].named][:_GENERAL]
    states = _fit_best(problem, before, named, progress)
    if not states or states[0].chi > AT_NOISE:
        states += _fit_best(problem, before, general, progress)
    return sorted(states, key=lambda s: float(s.scores.sum()))


def _fit_best(
    problem: Residuals, before: State, suspects: list[Candidate], progress: Progress
) -> list[State]:
    trials = before.fit.trials
    short: list[Fit] = []
    for i, suspect in enumerate(suspects):
        progress(f"trying {suspect.label}", i / len(suspects))
        structure = (*before.structure, suspect)
        fits = [
            fit(problem, structure, np.concatenate([before.fit.x, start]), trials, iterations=2)
            for start in suspect.starts
        ]
        short.append(min(fits, key=lambda f: f.cost))
    short.sort(key=lambda f: f.cost)
    states: list[State] = []
    for i, found in enumerate(short[:_FINALISTS]):
        progress(f"fitting {found.structure[-1].label}", i / _FINALISTS)
        best = min((s.fit.cost for s in states), default=np.inf)
        full = fit(problem, found.structure, found.x, trials, give_up_above=4.0 * best)
        states.append(state_of(problem, full, before.samples))
    return sorted(states, key=lambda s: float(s.scores.sum()))


def promise(residual: Array, slope: Array) -> float:
    """Decrease of the sum of squares that a linear step along ``slope`` (R, K, P) promises."""
    flat = slope.reshape(-1, slope.shape[-1])
    size = np.linalg.norm(flat, axis=0)
    flat = flat[:, size > 0.0] / size[size > 0.0]
    if not flat.shape[1]:
        return 0.0
    step = np.linalg.lstsq(flat, residual.ravel(), rcond=1e-8)[0]
    return float(np.sum((flat @ step) ** 2))


def choose(tried: list[State]) -> State:
    """The best suspect: as good as the best score allows, named before general, simple before rich."""
    bar = AS_GOOD_FACTOR * tried[0].chi + AS_GOOD_OFFSET
    good = [s for s in tried if s.chi <= bar]
    return min(good, key=lambda s: (not s.last.named, s.chi + 0.004 * s.last.size))


def indistinguishable(one: State, other: State) -> bool:
    """Whether trial by trial neither is better than the other beyond chance (and chi hardly differs)."""
    gap = one.scores - other.scores
    spread = float(np.std(gap, ddof=1)) * np.sqrt(len(gap)) if len(gap) > 1 else np.inf
    close = abs(one.chi - other.chi) <= 0.01 * other.chi + 0.005
    return close or (
        abs(float(gap.sum())) < 2.0 * spread and one.chi <= AS_GOOD_FACTOR * other.chi + AS_GOOD_OFFSET
    )


def by_trace(tried: list[State]) -> dict[Trace, State]:
    """The best state for each variable."""
    best: dict[Trace, State] = {}
    for state in tried:
        best.setdefault(state.last.trace, state)
    return best
