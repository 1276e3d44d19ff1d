"""Forward search: fit every candidate, compare on trials it has not seen, add the best, repeat.

A candidate's score is the geometric mean of two sums of squares: each trial fitted with the others, and
predicted with parameters fitted to the others alone.  A named effect is preferred to a general form
that explains no more, and a simple one to a complicated one; if a general form fits
clearly better than the named effect, the named effect is not reported.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, Residuals, build, evaluate, fit
from slipmargin.diagnosis.left_out import cross_validate, each_by_its_own, leave_one_out
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.watch import Watch

#: So many starts of a candidate get a short fit.
_STARTS = 3
#: A candidate with more parameters than this whose short fit costs so many times the best one's gets
#: no full fit.
_CHEAP, _FAR_BEHIND = 4, 6.0
#: A fit that cannot come within this factor of the best one's cost is not finished.
_OUT_OF_REACH = 1.3


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """A set of effects, fitted; ``scores`` (R,) is each trial's sum of squares, as a search counts it.

    That is the geometric mean of two: fitted with the trial, and predicted without it.  The first
    flatters what has many parameters.  The second, with few trials, is harsh on what only one of
    them shows (Efron, JASA 78, 316, 1983).
    """

    fit: Fit
    scores: Array
    samples: float

    @property
    def chi(self) -> float:
        """Root mean square of residual over noise, as a search counts it."""
        return float(np.sqrt(self.scores.sum() / self.samples))

    @property
    def structure(self) -> tuple[Candidate, ...]:
        """The candidates in it."""
        return self.fit.structure

    @property
    def last(self) -> Candidate:
        """The candidate added last."""
        return self.fit.structure[-1]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Round:
    """One step of the search: where it started, what was tried (best first), what was taken, if any.

    ``gains`` are the gains that the candidates' tangents promise; where none of them could lower chi
    noticeably, nothing was fitted and ``best`` is None.
    """

    before: State
    candidates: tuple[Candidate, ...]
    gains: tuple[float, ...]
    tried: tuple[State, ...]
    best: State | None
    p_value: float
    taken: bool

    def rivals(self) -> list[State]:
        """States that these trials cannot distinguish from the best one."""
        best = self.best
        if best is None:
            return []
        return [s for s in self.tried if s is not best and indistinguishable(s, best)]


def by_chi(state: State) -> float:
    """Key that sorts states best first."""
    return state.chi


def state_of(problem: Residuals, found: Fit, samples: float) -> State:
    """A fit with its scores."""
    inside, outside = np.sum(found.residual**2, axis=1), cross_validate(problem, found)
    return State(fit=found, scores=_scores(inside, outside), samples=samples)


def judged_by(problem: Residuals, found: Fit, samples: float) -> State:
    """A fit to another view of the same trials, with its scores on this one."""
    inside = np.sum(problem.residuals([found.effects], [found.trials])[0] ** 2, axis=1)
    outside = each_by_its_own(problem, found, leave_one_out(found))
    return State(fit=found, scores=_scores(inside, outside), samples=samples)


def _scores(inside: Array, outside: Array) -> Array:
    """(R,) shares of the geometric mean of two sums of squares, fitted with each trial and without it."""
    mean = np.sqrt(inside.sum() * outside.sum())
    share = np.sqrt(inside * outside)
    return np.asarray(mean * share / max(share.sum(), 1e-300))


def base_state(problem: Residuals, trials: Index, samples: float) -> State:
    """The model as it stands, with no effect added."""
    return state_of(problem, evaluate(problem, (), np.zeros(0), trials), samples)


def extend(
    problem: Residuals,
    before: State,
    candidates: list[Candidate],
    progress: Watch,
    finalists: int = SETTINGS.finalists,
    enough: float = 0.0,
) -> list[State]:
    """Each candidate added to ``before``: a short fit from each start, a full one for the best.

    Parameters
    ----------
    problem : Residuals
        Gives residuals of effects.
    before : State
        What is known already.
    candidates : list of Candidate
        What to add, one at a time.
    progress : Watch
        Called after each fit; when it has expired, what was fitted so far is compared.
    finalists : int
        How many get the full fit.
    enough : float
        A chi at which no further candidate needs a full fit.

    Returns
    -------
    list of State
        Best first.
    """
    trials = before.fit.trials
    short = short_fits(problem, before, candidates, some_of(trials), progress)
    states: list[State] = []
    worth = [
        f
        for f in short[:finalists]
        if f.structure[-1].size <= _CHEAP or f.cost <= _FAR_BEHIND * short[0].cost
    ]
    for i, found in enumerate(worth):
        progress(f"fitting {found.structure[-1].label}", i / finalists)
        best = min((s.fit.cost for s in states), default=np.inf)
        full = fit(problem, found.structure, found.x, trials, give_up_above=_OUT_OF_REACH * best)
        states.append(state_of(problem, full, before.samples))
        if (states[-1].chi <= enough and i >= 2) or progress.expired:
            break
    return sorted(states, key=by_chi)


def some_of(trials: Index) -> Index:
    """Every other trial where there are many: enough to see who is promising."""
    return trials[::2] if len(trials) >= SETTINGS.many_runs else trials


def short_fits(
    problem: Residuals, before: State, candidates: list[Candidate], trials: Index, progress: Watch
) -> list[Fit]:
    """Two Gauss–Newton steps from each start of each candidate beside ``before``; lowest cost first."""
    short: list[Fit] = []
    for i, candidate in enumerate(candidates):
        progress(f"trying {candidate.label}", i / len(candidates))
        structure = (*before.structure, candidate)
        starts = [np.concatenate([before.fit.x, start]) for start in candidate.starts]
        if len(starts) > _STARTS:  # places and times: only the best of those spread over the runs are fitted
            found = problem.residuals([build(structure, x) for x in starts], [trials] * len(starts))
            order = np.argsort([float(np.sum(r**2)) for r in found], kind="stable")
            starts = [starts[k] for k in order[:_STARTS]]
        fits = [fit(problem, structure, start, trials, iterations=2) for start in starts]
        short.append(min(fits, key=lambda f: f.cost))
        if progress.expired:
            break
    return sorted(short, key=lambda f: f.cost)


def score_test_gain(residual: Array, slope: Array) -> float:
    """Decrease of the sum of squares that a linear step along ``slope`` (R, K, P) promises."""
    flat = slope.reshape(-1, slope.shape[-1])
    size = np.linalg.norm(flat, axis=0)
    flat = flat[:, size > 0.0] / size[size > 0.0]
    if not flat.shape[1]:
        return 0.0
    step = np.linalg.lstsq(flat, residual.ravel(), rcond=1e-8)[0]
    return float(np.sum((flat @ step) ** 2))


def choose(tried: list[State]) -> State:
    """The best candidate: of those as good as the best score allows, the one that is simple for its chi."""
    bar = SETTINGS.as_good_factor * tried[0].chi + SETTINGS.as_good_offset
    good = [s for s in tried if s.chi <= bar]
    return min(good, key=lambda s: s.chi * (1.0 + _price(s)))


def _price(state: State) -> float:
    """What a simpler explanation has less of."""
    unnamed = sum(not c.named for c in state.structure)
    return (
        SETTINGS.parameter_price * len(state.fit.x)
        + SETTINGS.stuck_price * len(state.fit.at_bound())
        + SETTINGS.effect_price * len(state.structure)
        + SETTINGS.unnamed_price * unnamed
    )


def indistinguishable(one: State, other: State) -> bool:
    """Whether trial by trial neither is significantly better than the other (and chi hardly differs)."""
    gap = one.scores - other.scores
    spread = float(np.std(gap, ddof=1)) * np.sqrt(len(gap)) if len(gap) > 1 else np.inf
    close = abs(one.chi - other.chi) <= 0.01 * other.chi + 0.005
    return close or (
        abs(float(gap.sum())) < 2.0 * spread
        and one.chi <= SETTINGS.as_good_factor * other.chi + SETTINGS.as_good_offset
    )
