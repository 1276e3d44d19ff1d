"""Order analysis: residuals that are periodic in a wheel's angle, a whole number of times a turn.

Many encoders begin at 0 in every run, so the angle at which a wheel stood is not known.  A residual that is
periodic in the wheel angle is found all the same: each trial is compared with cos nθ and sin nθ, with its
own phase.
The null distribution comes from the same trials at counts half-way between the whole numbers, where
nothing that is fixed to a wheel can repeat: without periodicity, a trial's power at a whole count has the
distribution of its power at the half counts near it.  Trials in which the wheel turns at one pace
share one draw, since what repeats in time appears at the same count in all of them; so at least three paces
are needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index
from slipmargin.data.odometry import wheel_angles
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS

_DRAWS = 999
_HALVES = 0.5 * np.arange(1, 2 * SETTINGS.most_orders + SETTINGS.near_orders)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Periodicity:
    """The residual repeats ``per_turn`` times a turn of ``wheels``; ``p_value`` by permutation."""

    per_turn: int
    wheels: tuple[str, ...]
    p_value: float

    @property
    def sentence(self) -> str:
        """One sentence."""
        often = "once" if self.per_turn == 1 else f"{self.per_turn} times"
        like = "a wheel out of round does" if self.per_turn == 1 else "rollers and the gaps between them do"
        plural = "s" if len(self.wheels) > 1 else ""
        return (
            f"The residual is periodic in the wheel angle: it repeats {often} a turn of wheel{plural} "
            f"{', '.join(self.wheels)} "
            f"(permutation p ≤ {self.p_value:.3f}), as {like}."
        )


def order_analysis(problem: Problem, rates: Sequence[Array], seed: int) -> tuple[Periodicity, ...]:
    """:func:`periodicities` of what is left of a problem's trials, ``rates`` as it gives them."""
    trials = problem.trials
    angles = [wheel_angles(t.t_s, t.record.theta, t.record.omega) for t in trials]
    return periodicities([t.t_s for t in trials], rates, angles, problem.nominal.geometry.names, seed)


def periodicities(
    clocks: Sequence[Array],
    rates: Sequence[Array],
    angles: Sequence[Array | None],
    wheels: tuple[str, ...],
    seed: int,
) -> tuple[Periodicity, ...]:
    """Counts a turn at which the residual rate repeats, most striking first.

    What one count explains is taken out before the next is looked for: wheels whose speeds have a
    fixed ratio would name one another's.

    Parameters
    ----------
    clocks : sequence of arrays (T,)
        Times of each trial [s].
    rates : sequence of arrays (T, 3)
        Residual rate of each trial, NaN where unknown.
    angles : sequence of arrays (T, N) or None
        Wheel angles [rad], from any zero.
    wheels : tuple of str
        Names of the N wheels.
    seed : int
        Seed of the draws of the null distribution.
    """
    random = np.random.default_rng(seed)
    runs = [_Run.of(*trial) for trial in zip(clocks, rates, angles, strict=True)]
    runs = [run for run in runs if len(run.left)]
    found: list[Periodicity] = []
    while runs and len(found) < SETTINGS.named_orders:
        p, surprise = _against_null(runs, random)
        index = int(np.argmax(surprise.max(axis=0)))
        sure = p[:, index] <= SETTINGS.order_level
        if not sure.any():
            break
        names = tuple(name for name, s in zip(wheels, sure, strict=True) if s)
        found.append(Periodicity(per_turn=index + 1, wheels=names, p_value=float(p[sure, index].max())))
        runs = [run.without(index + 1, np.flatnonzero(sure)) for run in runs]
    return tuple(found)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Run:
    """A trial's residual rate (T, C) less its trend, each channel of unit variance, and angles (T, N).

    ``pace`` (N,) is how far each wheel turns in a second, forwards or back [rad/s].
    """

    left: Array
    angle: Array
    pace: Array

    @staticmethod
    def of(clock: Array, rate: Array, angle: Array | None) -> _Run:
        rate = rate[:, np.isfinite(rate).any(axis=0)]
        seen = np.isfinite(rate).all(axis=1)
        if angle is None or not rate.shape[1] or seen.sum() < SETTINGS.order_samples:
            return _Run(left=np.zeros((0, 0)), angle=np.zeros((0, 0)), pace=np.zeros(0))
        t = clock[seen]
        trend = np.polynomial.chebyshev.chebvander(2.0 * (t - t[0]) / (t[-1] - t[0]) - 1.0, 3)
        pace = np.sum(np.abs(np.diff(angle, axis=0)), axis=0) / (clock[-1] - clock[0])
        return _Run(left=_without(rate[seen], trend), angle=angle[seen], pace=pace)

    def without(self, per_turn: int, wheels: Index) -> _Run:
        """The same less what repeats so often a turn of these wheels."""
        phase = per_turn * self.angle[:, wheels]
        waves = np.concatenate([np.cos(phase), np.sin(phase), np.ones((len(phase), 1))], axis=1)
        return replace(self, left=_without(self.left, waves))


def _without(values: Array, basis: Array) -> Array:
    left = values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]
    return np.asarray(left / np.maximum(left.std(axis=0), 1e-300))


def _against_null(runs: Sequence[_Run], random: np.random.Generator) -> tuple[Array, Array]:
    """p among all wheels and counts, and standard deviations above the null mean, both (N, M)."""
    observed, null = _pooled([_power(run) for run in runs], np.array([run.pace for run in runs]), random)
    mean, spread = null.mean(axis=0), null.std(axis=0)
    scale = np.where(spread > 0.0, spread, np.inf)
    surprise = (observed - mean) / scale
    largest = np.max((null - mean) / scale, axis=(1, 2))
    return (1 + np.sum(largest[:, None, None] >= surprise, axis=0)) / (1 + _DRAWS), surprise


def _power(run: _Run) -> tuple[Array, NDArray[np.bool_]]:
    """Power (N, F) of a run at whole and half counts, all channels; the whole counts (N, M) it resolves."""
    wheels = run.angle.shape[1]
    power, resolved = np.zeros((wheels, len(_HALVES))), np.zeros((wheels, SETTINGS.most_orders), dtype=bool)
    for wheel, angle in enumerate(run.angle.T):
        if np.ptp(angle) < 2.0 * np.pi * SETTINGS.least_turns:
            continue
        advance = float(np.quantile(np.abs(np.diff(angle)), 0.9)) / (2.0 * np.pi)
        resolved[wheel] = np.arange(1, SETTINGS.most_orders + 1) * advance <= SETTINGS.fastest_order
        wave = np.exp(-1j * angle[:, None] * _HALVES)
        power[wheel] = np.sum(np.abs(run.left.T @ wave) ** 2, axis=0) / len(angle)
    return power, resolved


def _pooled(
    waves: Sequence[tuple[Array, NDArray[np.bool_]]], pace: Array, random: np.random.Generator
) -> tuple[Array, Array]:
    """Power of all trials together at whole counts (N, M), and with trials' drawn from near it."""
    whole = 2 * np.arange(1, SETTINGS.most_orders + 1) - 1
    halves = np.arange(0, len(_HALVES), 2)
    nearest = np.argsort(np.abs(halves - whole[:, None]), axis=1, kind="stable")
    near = halves[nearest[:, : SETTINGS.near_orders]]
    places = np.column_stack([whole, near])  # (M, 1 + near)
    drawn = random.integers(places.shape[1], size=(_DRAWS, len(waves)))
    observed = np.sum([power[:, whole] * resolved for power, resolved in waves], axis=0)
    null = np.zeros((_DRAWS, *observed.shape))
    for wheel in range(len(observed)):
        for (power, resolved), group in zip(waves, _alike(pace[:, wheel]), strict=True):
            null[:, wheel] += power[wheel, places[:, drawn[:, group]]].T * resolved[wheel]
    return observed, null


def _alike(pace: Array) -> NDArray[np.int64]:
    """Number of the group (R,) to which each trial belongs, trials of one pace together."""
    group = np.zeros(len(pace), dtype=np.int64)
    first, number = -np.inf, -1
    for trial in np.argsort(pace, kind="stable"):
        if number < 0 or pace[trial] > SETTINGS.one_pace * first:
            first, number = pace[trial], number + 1
        group[trial] = number
    return group
