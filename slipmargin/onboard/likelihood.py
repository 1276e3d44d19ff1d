"""The decision of a slip monitor: a likelihood ratio between "every wheel grips" and "a wheel slips".

The numbers of :mod:`~slipmargin.onboard.signals` are taken as normal under either hypothesis, with means and
covariances from runs in which it is known which holds: runs of the robot's own model, or logs with a pose.

The threshold keeps a false-alarm rate α by conformal risk control (A. Angelopoulos and others, Conformal Risk
Control, ICLR 2024).  The samples of a run hang together, so the run is what counts: a_r(τ) of the g_r
samples that grip in run r exceed τ, judged by a ratio that has not seen the run.  The least τ with

    Σ_r (a_r(τ) − α g_r) + (1 − α) max g ≤ 0

gives E[a] ≤ α E[g] for a further run like these: the second term is the worst that one more run can add.
With runs of equal length that takes at least 1/α − 1 runs; with fewer no threshold is known to keep the rate
and there is no alarm at all.  One long recording may be cut into blocks (:meth:`LabelledRun.blocks`) that
take the runs' place, if they are longer than its samples hang together: then E is over further stretches of
that recording, its floor and its battery, no more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.onboard.signals import Channels, Signals
from slipmargin.onboard.table import LimitTable

#: Samples that count in a run for as many independent ones, at least, of each kind.
LEAST = 30
#: Weight of a spherical covariance in the estimate, so that few samples make no thin directions [1].
SHRINK = 0.02
#: Part of each covariance that both hypotheses share: few runs know their tails badly [1].
POOLED = 0.3
#: Folds of the runs for the threshold.
FOLDS = 5


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LabelledRun:
    """T samples of known truth: numbers (T, F), whether a wheel slips (T,), twists (T, 3)."""

    numbers: Array
    slips: NDArray[np.bool_]
    wheels: Array
    truth: Array

    def blocks(self, samples: int) -> list[LabelledRun]:
        """Blocks of so many samples in their order; a rest of less than half of one is left out.

        Parameters
        ----------
        samples : int
            Length of a block: several times as long as the samples hang together.
        """
        starts = range(0, len(self.slips) - samples // 2 + 1, samples)
        return [
            LabelledRun(
                numbers=self.numbers[a : a + samples],
                slips=self.slips[a : a + samples],
                wheels=self.wheels[a : a + samples],
                truth=self.truth[a : a + samples],
            )
            for a in starts
        ]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hypothesis:
    """Normal distribution of the numbers; the body does ``gain`` · v_wheels ± ``covariance``."""

    mean: Array
    precision: Array
    log_det: float
    gain: Array
    covariance: Array

    def log_likelihood(self, numbers: Array) -> Array:
        """Up to a constant that hypotheses share, (...,) for numbers (..., F)."""
        off = numbers - self.mean
        return np.asarray(-0.5 * (np.sum((off @ self.precision) * off, axis=-1) + self.log_det))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ratio:
    """log p(numbers | slips) − log p(numbers | grips), with its values over samples that grip.

    ``unseen`` (K,), descending, are the values at samples that grip, each of a ratio that has not seen
    its run; ``gripping`` (R,) is how many of them each run has.
    """

    grips: Hypothesis
    slips: Hypothesis
    unseen: Array
    gripping: Array

    def value(self, numbers: Array) -> Array:
        """The logarithm of the ratio."""
        return np.asarray(self.slips.log_likelihood(numbers) - self.grips.log_likelihood(numbers))

    def polynomial(self) -> tuple[Array, Array, float]:
        """S (F, F), l (F,) and c: the logarithm of the ratio is x·(S x + l) + c."""
        one, two = self.grips, self.slips
        by_one, by_two = one.precision @ one.mean, two.precision @ two.mean
        constant = 0.5 * (one.mean @ by_one - two.mean @ by_two + one.log_det - two.log_det)
        return 0.5 * (one.precision - two.precision), by_two - by_one, float(constant)

    def threshold(self, false_alarm_rate: float) -> float:
        """What the ratio exceeds in at most this share of the samples that grip; infinite with few runs."""
        allowed = false_alarm_rate * self.gripping.sum() - (1.0 - false_alarm_rate) * self._longest
        if not len(self.unseen) or allowed < 0.0:
            return math.inf
        return float(self.unseen[min(int(allowed), len(self.unseen) - 1)])

    def runs_needed(self, false_alarm_rate: float) -> int:
        """How many runs like these a threshold takes."""
        mean = float(self.gripping.mean()) if len(self.gripping) else 1.0
        longest = max(self._longest, 1.0)
        return math.ceil((1.0 - false_alarm_rate) / false_alarm_rate * longest / max(mean, 1e-9) - 1e-9)

    @property
    def _longest(self) -> float:
        return float(np.max(self.gripping, initial=0.0))


def labelled(
    table: LimitTable,
    channels: Channels,
    t_s: Array,
    omega: Array,
    twist: Array,
    slips: Array,
    *,
    commanded: Array | None = None,
    gyro_rad_s: Array | None = None,
    current_A: Array | None = None,
) -> LabelledRun:
    """A run of T samples with its truth: what the body did (T, 3), and whether a wheel slips (T,).

    A sample with NaN in its twist is left out.
    """
    signals = Signals(table, channels)
    rows = []
    for k in range(len(t_s)):
        rows.append(
            signals.update(
                float(t_s[k]),
                omega[k],
                None if commanded is None else commanded[k],
                None if gyro_rad_s is None else float(gyro_rad_s[k]),
                None if current_A is None else current_A[k],
            )
        )
    on = np.all(np.isfinite(twist), axis=1)
    wheels = np.linalg.lstsq(table.rolling, omega.T, rcond=None)[0].T
    if channels.gyro and gyro_rad_s is not None:
        wheels[:, 2] = gyro_rad_s
    return LabelledRun(
        numbers=np.array(rows)[on],
        slips=np.asarray(slips, dtype=bool)[on],
        wheels=np.asarray(wheels[on], dtype=np.float64),
        truth=twist[on],
    )


def learn(runs: Sequence[LabelledRun]) -> Ratio:
    """The ratio from labelled runs.

    Raises
    ------
    InputError
        Where there are too few samples that grip or that slip.
    """
    grips, slips = _both(runs)
    folds = max(2, min(FOLDS, len(runs)))
    unseen: list[Array] = []
    for fold in range(folds if len(runs) > 1 else 0):
        rest = [run for k, run in enumerate(runs) if k % folds != fold]
        if not _enough(rest):
            continue
        one, two = _both(rest)
        for run in runs[fold::folds]:
            numbers = run.numbers[~run.slips]
            unseen.append(two.log_likelihood(numbers) - one.log_likelihood(numbers))
    values = np.sort(np.concatenate(unseen))[::-1] if unseen else np.zeros(0)
    return Ratio(
        grips=grips,
        slips=slips,
        unseen=np.asarray(values, dtype=np.float64),
        gripping=np.array([len(values) for values in unseen if len(values)], dtype=np.float64),
    )


def _enough(runs: Sequence[LabelledRun]) -> bool:
    slipping = sum(int(run.slips.sum()) for run in runs)
    return slipping >= LEAST and sum(len(run.slips) for run in runs) - slipping >= LEAST


def _both(runs: Sequence[LabelledRun]) -> tuple[Hypothesis, Hypothesis]:
    if not runs or not _enough(runs):
        slipping = sum(int(run.slips.sum()) for run in runs)
        gripping = sum(len(run.slips) for run in runs) - slipping
        raise InputError(
            "training runs",
            f"hold {gripping} samples that grip and {slipping} that slip",
            f"give runs with at least {LEAST} of each",
        )
    numbers = np.concatenate([run.numbers for run in runs])
    slips = np.concatenate([run.slips for run in runs])
    wheels = np.concatenate([run.wheels for run in runs])
    truth = np.concatenate([run.truth for run in runs])
    pooled = 0.5 * (np.cov(numbers[~slips].T) + np.cov(numbers[slips].T))
    common = POOLED * pooled + SHRINK * np.diag(np.var(numbers, axis=0) + 1e-9)
    return (
        _hypothesis(numbers[~slips], wheels[~slips], truth[~slips], common),
        _hypothesis(numbers[slips], wheels[slips], truth[slips], common),
    )


def _hypothesis(numbers: Array, wheels: Array, truth: Array, common: Array) -> Hypothesis:
    covariance = (1.0 - POOLED) * np.cov(numbers.T) + common
    size = np.sum(wheels**2, axis=0)
    gain = np.where(size > 0.0, np.sum(wheels * truth, axis=0) / np.maximum(size, 1e-12), 1.0)
    off = truth - gain * wheels
    return Hypothesis(
        mean=numbers.mean(axis=0),
        precision=np.asarray(np.linalg.inv(covariance), dtype=np.float64),
        log_det=float(np.linalg.slogdet(covariance)[1]),
        gain=gain,
        covariance=off.T @ off / len(off) + 1e-9 * np.eye(3),
    )
