"""What changes from run to run: a battery that empties, dust that gathers, wheels that warm.

The grip and, where commands alone are known, the speed that a command makes are fitted to each run by
itself, as factors of what the model has.  Whether a factor grows or falls in the order of the runs is told
by its rank correlation with that order; the null distribution comes from permuting whole runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect, GeneralEffect, Part, Trace
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Variable

#: Steps of the fit to one run, and the difference of factors that tells its slope [1].
_STEPS, _APART = 4, 0.01
_PERMUTATIONS = 999


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drift:
    """A factor that grows or falls from run to run.

    ``ends`` (2,) are those of the first and the last run, on the line through all; ``share`` of the squared
    residual of the runs is taken off by lines through the others, and ``p_value`` is that of the order, by
    permutation of whole runs, for all that was looked at.
    """

    what: str
    cause: str
    ends: Array
    share: float
    p_value: float

    @property
    def sentence(self) -> str:
        """One sentence."""
        first, last = self.ends
        way = "falls" if last < first else "grows"
        return (
            f"{self.what} {way} from run to run, from {first:.3g} to {last:.3g} times what the model has "
            f"(permutation p = {self.p_value:.2g}), as with {self.cause}, or because the runs stand in an "
            "order of their own, the slow ones first; a line through the other runs takes "
            f"{100.0 * self.share:.2g} % off the squared residual of each"
        )


def grip_times(factor: float, wheels: int) -> GeneralEffect:
    """Friction of all wheels times a factor."""
    return _scaled(factor, wheels, Trace.COEFFICIENT, Part.GRIP)


def _speed_times(factor: float, wheels: int) -> GeneralEffect:
    """The speeds that commands make times a factor."""
    return _scaled(factor, wheels, Trace.ACTUATION, Part.TRANSIENTS)


def _scaled(factor: float, wheels: int, trace: Trace, part: Part) -> GeneralEffect:
    term = Multiplier(
        variable=Variable.UNITY,
        basis=Basis.CONSTANT,
        coefficients=np.array([factor - 1.0]),
        shape=np.zeros(2),
        wheels=np.ones(wheels),
    )
    return GeneralEffect(traced_to=trace, part=part, terms=(term,))


def drift_in(
    problem: Problem, effects: tuple[AnyEffect, ...], runs: Sequence[int], seed: int
) -> Drift | None:
    """What grows or falls from run to run beside some effects: what takes most off, None where nothing does.

    Parameters
    ----------
    problem : Problem
        With whole runs, or parts of them.
    effects : tuple of effects
        What was found.
    runs : sequence of int
        The number of the run that each trial is, or is cut from.
    seed : int
        Of the permutations.
    """
    places, own = np.unique(runs, return_inverse=True)
    if len(places) < SETTINGS.drift_runs:
        return None
    looked: list[tuple[str, str, Callable[[float, int], GeneralEffect]]] = [
        ("The grip", "dust that gathers or wheels that warm", grip_times)
    ]
    if problem.commanded:
        looked.append(("The speed that a command makes", "a battery that empties", _speed_times))
    found = []
    for what, cause, made in looked:
        factors, weights, least, before = _by_run(problem, effects, made, own)
        p = min(1.0, len(looked) * _in_order(factors[_told(weights)], seed))
        line, level = (_left(factors, weights, least, degree) for degree in (1, 0))
        share = 1.0 - line / before
        kept = 1.0 - SETTINGS.least_lead_of_squares
        if p <= SETTINGS.significance and line <= kept * min(before, level):
            ends = np.asarray(np.polyval(_line(factors, weights, 1), np.array([0.0, len(factors) - 1.0])))
            found.append(Drift(what=what, cause=cause, ends=ends, share=share, p_value=p))
    return max(found, key=lambda d: d.share, default=None)


def _by_run(
    problem: Problem,
    effects: tuple[AnyEffect, ...],
    made: Callable[[float, int], GeneralEffect],
    own: Index,
) -> tuple[Array, Array, Array, float]:
    """The factor of each run (R,), how steeply the squared residual rises about it, what it leaves of each.

    The last is the squared residual of all without any factor.
    """
    count, wheels = len(problem.trials), problem.nominal.count
    each = [np.array([k]) for k in range(count)]
    many = int(own.max()) + 1
    factors: Array = np.ones(many)
    weights: Array = np.zeros(many)
    left: Array = np.zeros(many)
    before = 0.0
    for number in range(_STEPS):
        sets = [(*effects, made(float(f), wheels)) for f in np.concatenate([factors, factors + _APART])]
        rows = np.concatenate(problem.residuals([sets[k] for k in (*own, *(own + many))], [*each, *each]))
        at, slope = rows[:count], (rows[count:] - rows[:count]) / _APART
        before = float(np.sum(at**2)) if not number else before  # all factors are 1 at first
        weights = np.asarray(np.bincount(own, np.sum(slope**2, axis=1)), dtype=float)
        step = -np.bincount(own, np.sum(slope * at, axis=1)) / np.maximum(weights, 1e-300)
        moved = np.clip(factors + step, *SETTINGS.drift_factors)
        left = np.bincount(own, np.sum(at**2, axis=1)) - weights * (moved - factors) ** 2
        factors = moved
    return factors, weights, np.maximum(left, 0.0), before


def _in_order(factors: Array, seed: int) -> float:
    """How often chance orders the factors of runs as well, either way."""
    random = np.random.default_rng(seed)
    place = np.arange(len(factors)) - 0.5 * (len(factors) - 1)
    rank = rankdata(factors)
    seen = abs(place @ rank)
    null = [abs(place @ random.permutation(rank)) for _ in range(_PERMUTATIONS)]
    return float((1 + np.sum(np.array(null) >= seen)) / (1 + _PERMUTATIONS))


def _told(weights: Array) -> NDArray[np.bool_]:
    """Which runs tell their factor: in the others hardly anything depends on it."""
    return np.asarray(weights > SETTINGS.drift_tells * np.median(weights))


def _line(factors: Array, weights: Array, degree: int) -> Array:
    """A line (or a level) through the factors that are told; no run counts for more than the median one."""
    least = np.where(_told(weights), np.sqrt(np.minimum(weights, np.median(weights))), 0.0)
    return np.asarray(np.polyfit(np.arange(len(factors), dtype=float), factors, degree, w=least))


def _left(factors: Array, weights: Array, least: Array, degree: int) -> float:
    """Squared residual of all runs, each with the factor on the line (or level) of the others."""
    total = 0.0
    for k in range(len(factors)):
        others = np.where(np.arange(len(factors)) == k, 0.0, weights)
        line = _line(factors, others, degree)
        total += float(least[k] + weights[k] * (np.polyval(line, k) - factors[k]) ** 2)
    return total
