"""Predict every trial with any set of effects, and compare: the whitened residual.

The unknown start pose is a nuisance of three numbers a trial.  It is removed linearly: the residual
is projected off the change that a small shift and turn of the start makes to the whole run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index
from slipmargin.diagnose.prepare import Trial
from slipmargin.diagnose.sense import is_ideal, measure
from slipmargin.diagnose.signals import Way, rolling_twist, wheel_signal
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.recipe import with_effects
from slipmargin.errors import InputError
from slipmargin.model import Model, nominal_model
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack, stack

#: Residuals are clipped here [σ]: a run that went wild must not blind the fit to the others.
_WILD = 1e4
#: Integration tolerance: its error stays below a hundredth of any camera's noise.
_RTOL = 1e-4
_FINE_RTOL = 1e-6
#: Steps after which a run has gone wild (an ordinary one takes a few hundred a second of motion).
_MOST_STEPS = 40_000


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """Cleaned trials on one surface, the recipe believed so far, and the compiled simulator.

    ``measured`` (R, T, 3) and ``seen`` (R, T, 3) are padded to the longest trial.
    """

    recipe: Recipe
    surface: str
    nominal: Model
    trials: tuple[Trial, ...]
    sigma: Array
    batch: Batch
    measured: Array
    seen: NDArray[np.bool_]
    starts: Array
    twists: Array
    commanded: bool
    rtol: float = _RTOL

    @staticmethod
    def of(recipe: Recipe, surface: str, trials: tuple[Trial, ...], sigma: Array, commanded: bool) -> Problem:
        """Pad the trials and compile their wheel signals."""
        nominal = nominal_model(recipe.robot, surface)
        signals = tuple(wheel_signal(t, commanded) for t in trials)
        batch = Batch(signals, [t.t_s for t in trials], commanded=commanded)
        longest = max(len(t.t_s) for t in trials)
        measured = np.full((len(trials), longest, 3), np.nan)
        for row, trial in zip(measured, trials, strict=True):
            row[: len(trial.t_s)] = trial.pose
        seen = np.isfinite(measured)
        return Problem(
            recipe=recipe,
            surface=surface,
            nominal=nominal,
            trials=trials,
            sigma=sigma,
            batch=batch,
            measured=np.where(seen, measured, 0.0),
            seen=seen,
            commanded=commanded,
            starts=np.array([t.start for t in trials]),
            twists=np.array([rolling_twist(nominal, t, s) for t, s in zip(trials, signals, strict=True)]),
        )

    def model(self, effects: Sequence[AnyEffect]) -> Model:
        """The recipe's model with these effects on top."""
        return with_effects(self.nominal, (*self.recipe.effects, *effects))

    def predict(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """Measured pose as each set of effects predicts it on its trials: (R_k, T, 3), start fitted."""
        return [pose for pose, _ in self._compare(effects, trials)]

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """Whitened residual (R_k, 3 T) of each set of effects on its trials; 0 where nothing was seen."""
        return [gap.transpose(0, 2, 1).reshape(len(gap), -1) for _, gap in self._compare(effects, trials)]

    def _compare(
        self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]
    ) -> list[tuple[Array, Array]]:
        built = [self._possible(e) for e in effects]
        models = [self.nominal if m is None else m for m in built]
        which = np.repeat(np.arange(len(models)), [len(t) for t in trials])
        runs = np.concatenate([np.asarray(t, dtype=np.int64) for t in trials])
        pose = self.batch.run(
            stack([pack(m) for m in models]),
            self.starts[runs],
            start_twist=self.twists[runs],
            which=which,
            signal=runs,
            rtol=self.rtol,
            max_steps=_MOST_STEPS,
        ).pose
        for k, model in enumerate(models):
            if is_ideal(model.sensing):
                continue
            for row in np.flatnonzero(which == k):
                clock = self.trials[runs[row]].t_s
                pose[row, : len(clock)] = measure(model.sensing, clock, pose[row, : len(clock)])
        seen = self.seen[runs]
        gap = np.where(seen, self.measured[runs] - pose, 0.0)
        gap = np.where(np.isfinite(gap), gap, _WILD * self.sigma)
        shift = _start_shift(pose, gap, seen, self.sigma)
        pose = pose + shift
        gap = np.where(seen, (gap - shift) / self.sigma, 0.0).clip(-_WILD, _WILD)
        impossible = np.array([m is None for m in built])[which]
        gap = np.where(seen & impossible[:, None, None], _WILD, gap)
        parts = np.split(np.arange(len(runs)), np.cumsum([len(t) for t in trials])[:-1])
        return [(pose[part], gap[part]) for part in parts]

    def _possible(self, effects: Sequence[AnyEffect]) -> Model | None:
        """The model, or None where no machine is like that (a wheel would lift)."""
        try:
            return self.model(effects)
        except InputError:
            return None

    def rebuilt(self, way: Way) -> Problem:
        """The same problem with the wheels' motion rebuilt another way, and integrated finely."""
        signals = tuple(wheel_signal(t, self.commanded, way) for t in self.trials)
        batch = Batch(signals, [t.t_s for t in self.trials], commanded=self.commanded)
        return replace(self, batch=batch, rtol=_FINE_RTOL)

    def samples(self, trials: Index) -> float:
        """Number of measured values in these trials."""
        return float(np.count_nonzero(self.seen[trials]))


def _start_shift(pose: Array, gap: Array, seen: Array, sigma: Array) -> Array:
    """The change (M, T, 3) of each prediction by the start shift and turn that fit it best."""
    arm = np.where(np.isfinite(pose), pose, 0.0) - np.where(np.isfinite(pose[:, :1]), pose[:, :1], 0.0)
    tangent = np.zeros((*pose.shape, 3))
    tangent[..., 0, 0] = tangent[..., 1, 1] = tangent[..., 2, 2] = 1.0
    tangent[..., 0, 2] = -arm[..., 1]
    tangent[..., 1, 2] = arm[..., 0]
    white = np.where(seen[..., None], tangent / sigma[:, None], 0.0)
    normal = np.einsum("mtip,mtiq->mpq", white, white)
    right = np.einsum("mtip,mti->mp", white, gap / sigma)
    normal += 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    return np.asarray(np.einsum("mtip,mp->mti", tangent, np.linalg.solve(normal, right[..., None])[..., 0]))
