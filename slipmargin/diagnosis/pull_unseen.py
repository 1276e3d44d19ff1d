"""Pulls predicted by what was found without their setting, and the verdict that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.pull_search import PullState, beside
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.settings import PULLS

_FLIPS = 4999


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class PullScore:
    """How well pulls are predicted: rms and mean of measured minus expected [N], and chi [1].

    ``chi`` is the root mean square of residual over noise: 1 is pure noise.  Where wheels may stand on a
    roller or on rigid material the residual is that beside the states which the pull makes probable.
    """

    rms_N: float
    mean_N: float
    chi: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Unseen:
    """Predictions of pulls by what was found without their setting."""

    before_N: Array
    after_N: Array
    before: PullScore
    after: PullScore
    p_value: float
    worst: float  #: root of what the worst setting's sum of squares grows by [σ]
    misfit_before: bool  #: whether the residual is more than noise
    misfit_after: bool

    @staticmethod
    def of(
        problem: PullProblem, split: list[Index], without: list[PullState], freedom: float, seed: int
    ) -> Unseen:
        """Scores of the model as believed and of what was found without each part of the settings.

        Parameters
        ----------
        split, without
            The parts, and the state that a search found without each.
        freedom
            Degrees of freedom of the noise σ.
        """
        everyone, measured = problem.everyone, problem.pulls.force_N
        before_N = problem.expected(()).mean_N
        after_N = np.empty(len(measured))
        old = problem.residuals([()], [everyone])[0]
        new = np.empty_like(old)
        for part, state in zip(split, without, strict=True):
            rows = problem.rows[part]
            own = rows[rows >= 0]
            after_N[own] = problem.expected(state.fit.effects).mean_N[own]
            new[part] = problem.residuals([state.fit.effects], [part])[0]
        gain = old**2 - new**2
        # Pulls of one setting share what the model lacks there, but not what their wheels stood on.
        states = bool(np.any(old[:, 1::2]) or np.any(new[:, 1::2]))
        units = gain.reshape(-1, 2).sum(axis=1) if states else gain.sum(axis=1)
        return Unseen(
            before_N=before_N,
            after_N=after_N,
            before=_score(measured - before_N, beside(old)),
            after=_score(measured - after_N, beside(new)),
            p_value=_by_signs(units, seed),
            worst=math.sqrt(max(0.0, -float(gain.sum(axis=1).min()))),
            misfit_before=_misfit(beside(old), len(measured), freedom),
            misfit_after=_misfit(beside(new), len(measured), freedom),
        )

    def verdict(self, any_found: bool) -> Verdict:
        """What the held-out predictions allow to say."""
        better = self.after.chi <= (1.0 - PULLS.least_share) * self.before.chi
        better = better and self.after.rms_N < self.before.rms_N
        if any_found and better and self.p_value <= PULLS.by_luck and self.worst <= PULLS.worse:
            return Verdict.EFFECT_FOUND
        return Verdict.UNEXPLAINED if self.misfit_before else Verdict.NO_MISSING_EFFECT


def _score(off_N: Array, squares: Array) -> PullScore:
    return PullScore(
        rms_N=float(np.sqrt(np.mean(off_N**2))),
        mean_N=float(np.mean(off_N)),
        chi=float(np.sqrt(squares.sum() / len(off_N))),
    )


def _by_signs(gain: Array, seed: int) -> float:
    """Probability that settings whose gains have random signs add up to as much."""
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], size=(_FLIPS, len(gain)))
    return float(1 + np.count_nonzero(signs @ gain >= gain.sum())) / (1 + _FLIPS)


def _misfit(squares: Array, pulls: int, freedom: float) -> bool:
    """Whether squared residuals over noise are more than noise of so many degrees of freedom explains."""
    from scipy.special import chdtrc, fdtrc

    total = float(squares.sum())
    p = chdtrc(pulls, total) if np.isinf(freedom) else fdtrc(pulls, max(freedom, 1.0), total / pulls)
    return bool(p <= PULLS.no_noise)
