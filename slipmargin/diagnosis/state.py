"""Effects fitted to trials, and which of several is to be preferred."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit
from slipmargin.diagnosis.held_out import errors_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.verdict import beyond_noise, explained_share
from slipmargin.effects.catalogue import CATALOGUE


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """Effects fitted to trials; ``scores`` (R,) are their sums of squares, each left out of a refit.

    ``view`` is how runs are compared, whole or in pieces; ``samples`` are the measured values compared;
    ``xs`` (F, P) are the parameters without each of the folds ``parts``; ``fewer`` keeps what
    :func:`~slipmargin.diagnosis.refits.without` found for it, by effect and runs: it is asked several times.
    """

    fit: Fit
    scores: Array
    samples: float
    view: Problem
    parts: tuple[Index, ...]
    xs: Array
    fewer: dict[tuple[int, tuple[int, ...]], State] = field(default_factory=dict, init=False, repr=False)

    def moved(self, problem: Problem, runs: tuple[int, ...]) -> State:
        """The same of a problem in which other trials are cut: ``runs`` says which each of its trials was."""
        trials = np.array([runs.index(i) for i in self.fit.trials], dtype=np.int64)
        view = problem.as_seen_in(self.view, runs)
        return replace(self, view=view, fit=replace(self.fit, trials=trials))

    @property
    def chi(self) -> float:
        """Root mean square of left-out residual over noise."""
        return float(np.sqrt(self.scores.sum() / self.samples))

    @property
    def structure(self) -> tuple[Candidate, ...]:
        """The candidates in it."""
        return self.fit.structure

    @property
    def things(self) -> set[str]:
        """What they are, in whichever form."""
        return {c.thing for c in self.structure}

    @property
    def last(self) -> Candidate:
        """The candidate added last."""
        return self.fit.structure[-1]

    @property
    def named(self) -> bool:
        """Whether every effect in it has a name."""
        return all(c.named for c in self.structure)


def explained(before: State, after: State) -> float:
    """Share of the left-out sum of squares that falls away."""
    return float(1.0 - after.scores.sum() / before.scores.sum())


def choose(tried: Sequence[State], before: State | None = None) -> State:
    """Of those as good as the best: with names not stuck at a bound, fewest effects, then the least error.

    What leaves nothing but noise in the runs it was fitted to comes before what leaves more there: where one
    run alone shows a place, nothing predicts that run from the others.  With no more parameters it is as good
    as a best one that leaves more, if it is worth adding to what was known ``before``.

    Of two forms of the same effects that are as good as each other, and of two names whose errors do not
    differ beyond the spread of the runs or the worth of their parameters, the one with fewer parameters is
    meant; of two that differ by no more than a log's reconstruction does, and not in most runs the same way,
    the more usual one.
    """
    good = [
        s
        for s in tried
        if as_good(s, tried[0])
        or (
            before is not None
            and _leaves_noise_alone(s, tried[0])
            and worthwhile(before, s.chi, s.last.named)
        )
    ]
    chosen = min(good, key=lambda s: (*_kind(s), s.chi))
    while len((simpler := _simpler(chosen, good)).fit.x) < len(chosen.fit.x):
        chosen = simpler
    return simpler


def _kind(state: State) -> tuple[bool, bool, int, bool]:
    """What counts before the error: names that stand, no parameter at a bound, few effects, noise alone left.

    A name with a parameter at a bound stands for something else, and is not reported as that name.
    """
    stuck = state.fit.stuck
    return stuck or not state.named, stuck, len(state.structure), _left(state) > SETTINGS.noise_chi


def _left(state: State) -> float:
    """Root mean square over noise of what it leaves in the runs that it was fitted to."""
    return float(np.sqrt(state.fit.cost / max(1.0, state.samples)))


def _leaves_noise_alone(one: State, best: State) -> bool:
    """Whether no more parameters leave nothing but noise in the runs fitted, where the best leaves more."""
    return len(one.fit.x) <= len(best.fit.x) and _left(one) <= SETTINGS.noise_chi < _left(best)


def _simpler(chosen: State, good: Sequence[State]) -> State:
    """The simplest that means the same as the chosen one, or is as good: fewest parameters, then usual."""
    names = [c.name for c in chosen.structure]
    simple = [
        s
        for s in good
        if not s.fit.stuck
        and (
            (as_good(s, chosen) and [c.name for c in s.structure] == names)
            or (_kind(s) == _kind(chosen) and (_fits_as_well(s, chosen) or _means_the_same(s, chosen)))
        )
    ]
    if not simple:
        return chosen
    least = min(simple, key=lambda s: (len(s.fit.x), s.chi))
    same = [
        s
        for s in simple
        if len(s.fit.x) == len(least.fit.x)
        and s.chi <= least.chi + SETTINGS.least_chi
        and (len(s.scores) < 2 or _level(s, least, SETTINGS.noise_deviations))
    ]
    return min(same, key=lambda s: (_unusual(s), s.chi))


def _means_the_same(one: State, chosen: State) -> bool:
    """Whether a left-out error is larger by no more than what a log leaves open, and by chance or freedom."""
    near = one.chi <= chosen.chi + SETTINGS.least_chi
    return near and (_level(one, chosen) or _by_number(one, chosen))


def _unusual(state: State) -> int:
    """How far down the catalogue, which begins with what is most often wrong, its last effect stands."""
    names = [effect.name for effect in CATALOGUE]
    return names.index(state.last.name) if state.last.name in names else len(names)


def as_good(one: State, best: State) -> bool:
    """Whether a left-out error is no larger than the best one's but for the spread from run to run.

    Nor is it where the runs themselves are fitted as well by no more parameters.
    """
    if one.chi <= best.chi + SETTINGS.least_chi or _fits_as_well(one, best):
        return True
    return _level(one, best) and one.chi <= SETTINGS.as_good_factor * best.chi


def _fits_as_well(one: State, best: State) -> bool:
    """Whether no more parameters leave, with their worth, no more in the runs to which both were fitted.

    It is asked where nothing but noise is left.  What such a fit gets wrong in a run left out is then what
    the others do not say about its parameters, and says nothing against what they stand for.  So fewer
    parameters are as good, too, that leave as little as noise and get most of the runs left out no less
    right: in a sum, the one run that nothing predicts from the others would decide alone.
    """
    more = len(best.fit.x) - len(one.fit.x)
    if more < 0 or _left(best) > SETTINGS.noise_chi or len(one.fit.trials) != len(best.fit.trials):
        return False
    if best.chi <= SETTINGS.noise_chi and one.fit.cost <= best.fit.cost + more * np.log(best.samples):
        return True
    mostly = np.count_nonzero(one.scores <= best.scores) > len(best.scores) / 2
    return bool(more > 0 and mostly and _left(one) <= SETTINGS.noise_chi)


def _level(one: State, best: State, errors: float = SETTINGS.as_good_errors) -> bool:
    """Whether a sum of squares is larger by no more than so many standard errors of the runs' differences."""
    gap = one.scores - best.scores
    spread = float(np.std(gap, ddof=1)) * np.sqrt(len(gap)) if len(gap) > 1 else 0.0
    return float(gap.sum()) <= errors * spread


def _by_number(one: State, best: State) -> bool:
    """Whether the best owes its smaller error to further parameters: ln(samples) of noise for each.

    (The Bayesian information criterion: G. Schwarz, The Annals of Statistics 6(2), 1978.)
    """
    more = len(best.fit.x) - len(one.fit.x)
    gap = float(one.scores.sum() - best.scores.sum())
    return more > 0 and gap <= more * np.log(best.samples) * max(1.0, best.chi**2)


def later_share(trials: int) -> float:
    """Share of chi that a further effect must take off where so many trials are compared."""
    return SETTINGS.later_effect * min(1.0, float(np.sqrt(SETTINGS.most_searched / trials)))


def worthwhile(before: State, chi: float, named: bool = True) -> bool:
    """Whether chi falls by more than what the log's reconstruction, or an unnamed form, may leave."""
    if chi >= before.chi:
        return False
    if before.structure and not (named and before.named):  # chi below 1 is noise that a form took up
        clear = before.chi > SETTINGS.noise_chi
        return clear and explained_share(before.chi, max(1.0, chi)) >= SETTINGS.with_unnamed
    share = later_share(len(before.scores)) if before.structure else SETTINGS.first_effect
    floor = SETTINGS.floor_chi if before.chi >= 1.0 else 0.0  # below 1 the noise was read too large
    return before.chi - max(chi, floor) >= max(SETTINGS.least_chi, share * before.chi)


def quiet(state: State) -> bool:
    """Whether a state leaves nothing but noise in the runs that are searched, in all and in each of them.

    Noise that lasts can take up much of what is missing: then the errors themselves are larger than noise.
    """
    counts = np.maximum(1.0, np.count_nonzero(state.fit.residual, axis=1))
    of_runs = np.sqrt(np.sum(state.fit.residual**2, axis=1) / counts)
    if state.chi > SETTINGS.quiet_chi or np.any(beyond_noise(of_runs, counts)):
        return False
    view, trials = state.view, state.fit.trials
    if view.lasting is None:
        return True
    errors = errors_of(view, trials, *view.compare([state.fit.effects], [trials])[0])
    return errors.size(view.sigma) <= SETTINGS.noise_size
