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
_FINALISTS = 10

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
    """One step of the search: where it started, what was tried (best first), what was taken, if any."""

    before: State
    tried: tuple[State, ...]
    best: State
    p_value: float
    taken: bool

    def rivals(self) -> list[State]:
        """States that these trials cannot tell from the best one."""
        return [s for s in self.tried if s is not self.best and indistinguishable(s, self.best)]


def state_of(problem: Residuals, found: Fit, samples: float) -> State:
    """A fit with its cross-validated scores."""
    return State(fit=found, scores=cross_validate(problem, found), samples=samples)


def base_state(problem: Residuals, trials: Array, samples: float) -> State:
    """The model as it stands, with no effect added."""
    return state_of(problem, evaluate(problem, (), np.zeros(0), trials), samples)


def explore(problem: Residuals, before: State, suspects: list[Candidate], progress: Progress) -> list[State]:
    """Every suspect added to ``before`` and fitted; best cross-validated first.

    All get a short fit from each start; the most promising then a full one.
    """
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
    kept = short[:_FINALISTS]
    kept += [f for f in short[_FINALISTS:] if f.structure[-1].named and f.cost < 0.9 * before.fit.cost][:6]
    states = []
    for i, found in enumerate(kept):
        progress(f"fitting {found.structure[-1].label}", i / len(kept))
        states.append(state_of(problem, fit(problem, found.structure, found.x, trials), before.samples))
    return sorted(states, key=lambda s: float(s.scores.sum()))


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
