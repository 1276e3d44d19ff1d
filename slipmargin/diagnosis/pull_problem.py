"""Pulls compared with what a model predicts: residuals that the fit of candidates can use, no simulation.

A wheel stands on a roller or on rigid material, so a pull of one setting meets one of several contact
states s, each with its limit F_s and its probability w_s: near 0 or 1 where wheel angles were measured, the
share of rigid material where they were not.  With noise σ minus twice the log likelihood of a pull F is, up
to a constant, −2 log Σ_s w_s exp(−(F − F_s)² / 2σ²) = a² + b².  The residual is (a, b): a is F minus the mean
of F_s over the states that F makes probable, in σ; b is what is left of the sum, and zero with one state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.near import Way
from slipmargin.diagnosis.settings import PULLS
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.recipe import with_effects
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.pull_settings import setting_limits
from slipmargin.model import Model, nominal_model
from slipmargin.physics.sectors import pitch


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Expectation:
    """What a model expects of pulls: forces (S, P) of contact states, their probabilities (P, S)."""

    force_N: Array
    share: Array

    @property
    def mean_N(self) -> Array:
        """(P,) expected force [N], known before the pull."""
        return np.asarray(np.sum(self.share * self.force_N.T, axis=1))


def expectation(model: Model, settings: Array, which: Index, theta_rad: Array | None) -> Expectation:
    """Limits of every contact state that a model thinks possible in each pull.

    Parameters
    ----------
    settings : (G, 5), which : (P,)
        What was pulled how (:meth:`~slipmargin.data.pulls.Pulls.settings`).
    theta_rad : (P, N) or None
        Wheel angles, where known.

    Raises
    ------
    NoSolution
        Where the model cannot stand: a wheel lifts without any pull.
    """
    rigid = _rigid(model, theta_rad, len(which))
    states = np.array(_states(rigid), dtype=bool)
    share = np.prod(np.where(states, rigid[:, None, :], 1.0 - rigid[:, None, :]), axis=2)
    kept = np.flatnonzero(share.max(axis=0) > PULLS.rare)
    forces = np.stack([setting_limits(model, settings, state)[which] for state in states[kept]])
    return Expectation(force_N=forces, share=share[:, kept] / share[:, kept].sum(axis=1, keepdims=True))


def _states(rigid: Array) -> list[tuple[bool, ...]]:
    """Contact states of wheels that may stand on rigid material in some pull; True: on rigid material."""
    may = rigid.max(axis=0) > 0.0
    must = rigid.min(axis=0) >= 1.0
    return list(
        product(
            *[
                (True,) if sure else (False, True) if can else (False,)
                for can, sure in zip(may, must, strict=True)
            ]
        )
    )


def _rigid(model: Model, theta_rad: Array | None, pulls: int) -> Array:
    """Probability (P, N) that a wheel stands on rigid material."""
    part = model.grip.rigid_fraction
    if theta_rad is None:
        return np.tile(part, (pulls, 1))
    from scipy.special import ndtr

    phase = np.mod(theta_rad / pitch(model.grip.rollers), 1.0)
    around = np.zeros(phase.shape)
    for turn in (-1.0, 0.0, 1.0):  # the rigid part is [1 − c, 1) of every pitch
        around += ndtr((1.0 + turn - phase) / PULLS.edge) - ndtr((1.0 + turn - part - phase) / PULLS.edge)
    return np.clip(np.where(part <= 0.0, 0.0, np.where(part >= 1.0, 1.0, around)), 0.0, 1.0)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullProblem:
    """Pulls of one robot on one surface, as the fits of :mod:`slipmargin.diagnosis.fit` want them.

    A *group* is what was pulled in one setting; where a fit says trial it is meant.  ``rows`` (G, K) are
    the pulls of each group, −1 where it has fewer than K.
    """

    recipe: Recipe
    surface: str
    pulls: Pulls
    sigma_N: float
    noise_known: bool  #: σ is the noise of a pull, not what scatters with the material under the wheels
    nominal: Model
    settings: Array
    which: Index
    rows: Index
    watch: Watch | None = None  #: ends a search, where it is asked for residuals after its time

    @staticmethod
    def of(recipe: Recipe, surface: str, pulls: Pulls, sigma_N: float, noise_known: bool) -> PullProblem:
        """The problem of these pulls, with the noise σ [N] of one."""
        settings, which = pulls.settings()
        most = int(np.bincount(which).max())
        rows = np.full((len(settings), most), -1, dtype=np.int64)
        for group in range(len(settings)):
            own = np.flatnonzero(which == group)
            rows[group, : len(own)] = own
        return PullProblem(
            recipe=recipe,
            surface=surface,
            pulls=pulls,
            sigma_N=sigma_N,
            noise_known=noise_known,
            nominal=nominal_model(recipe.robot, surface),
            settings=settings,
            which=which,
            rows=rows,
        )

    @property
    def everyone(self) -> Index:
        """Every group."""
        return np.arange(len(self.rows), dtype=np.int64)

    def count(self, groups: Index) -> int:
        """Number of pulls in these groups."""
        return int(np.count_nonzero(self.rows[groups] >= 0))

    def model(self, effects: tuple[AnyEffect, ...]) -> Model:
        """The model with these effects on top of those that the robot file lists."""
        return with_effects(self.nominal, (*self.recipe.effects, *effects))

    def possible(self, effects: tuple[AnyEffect, ...]) -> Model | None:
        """The model, or None where two of the effects are laws for one thing, which refuse each other."""
        try:
            return self.model(effects)
        except InputError:
            return None

    def expected(self, effects: tuple[AnyEffect, ...]) -> Expectation:
        """What the model with these effects expects of every pull."""
        return expectation(self.model(effects), self.settings, self.which, self.pulls.theta_rad)

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """For each set of effects, the residuals (R_k, 2 K) of its groups, zero where there is no pull.

        They are :attr:`PullSettings.wild` where the model cannot stand.

        Raises
        ------
        OutOfTime
            Once the time of ``watch`` is over.
        """
        return [self._residual(e, groups) for e, groups in zip(effects, trials, strict=True)]

    def near(self, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index) -> list[Array]:
        """The residuals a step on, as they are: no pull takes long."""
        return self.residuals([way(1.0) for way in ways], [trials] * len(ways))

    def rough(self) -> PullProblem:
        """Itself: no pull takes long."""
        return self

    def _residual(self, effects: tuple[AnyEffect, ...], groups: Index) -> Array:
        if self.watch is not None:
            self.watch.check()
        rows = self.rows[groups]
        there = rows >= 0
        which, theta = np.nonzero(there)[0], self.pulls.theta_rad
        out = np.zeros((*rows.shape, 2))
        out[there] = PULLS.wild
        angles = None if theta is None else theta[rows[there]]
        try:
            with np.errstate(divide="ignore", invalid="ignore"):  # a fit may try a wheel without friction
                found = expectation(self.model(effects), self.settings[groups], which, angles)
        except (InputError, NoSolution):
            return out.reshape(len(groups), -1)
        if np.all(np.isfinite(found.force_N)):
            out[there] = deviance(self.pulls.force_N[rows[there]], found, self.sigma_N)
        return out.reshape(len(groups), -1)


def deviance(force_N: Array, found: Expectation, sigma_N: float) -> Array:
    """(P, 2) residuals (a, b) of pulls."""
    gap = np.clip((force_N[:, None] - found.force_N.T) / sigma_N, -PULLS.wild, PULLS.wild)
    with np.errstate(divide="ignore"):  # a state that is impossible in one pull
        power = np.log(found.share) - 0.5 * gap**2
    top = power.max(axis=1, keepdims=True)
    weight = np.exp(power - top)
    total = weight.sum(axis=1)
    a = np.sum(weight * gap, axis=1) / total
    rest = -2.0 * (top[:, 0] + np.log(total)) - a**2
    return np.stack([a, np.sqrt(np.maximum(rest, 0.0))], axis=1)
