"""Predict every trial with any set of effects, and compare: the whitened residual.

The unknown start pose of a trial is three nuisance parameters.  They are removed linearly: the residual
is projected off the change that a small shift and rotation of the start makes to the whole run.

Where the prediction is far off, a wrong heading early in a run changes everything after it, and a fit of
whole runs has many local minima.  A problem *in pieces* moves and rotates every short piece of a predicted
run onto the measured one first, so that the residual is that of the motion within the piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index
from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.near import Way, near
from slipmargin.diagnosis.prepare import Trial
from slipmargin.diagnosis.residual_diagnostics import residual_rate
from slipmargin.diagnosis.sense import is_ideal, measure
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.signals import InterpolationScheme, started, wheel_signal, with_phases
from slipmargin.diagnosis.start_pose import aligned, fitted_start
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.confined import acting
from slipmargin.effects.recipe import with_effects
from slipmargin.errors import InputError
from slipmargin.model import Model, nominal_model
from slipmargin.physics.frames import rotate_rows
from slipmargin.sim.batch import Batch, Ending, Outcome
from slipmargin.sim.pack import pack, stack
from slipmargin.sim.signal import WheelSignal, angles_at

#: Relative tolerance of a simulation per noise of the position [1/m] while its error was not looked at, and
#: its range [1]: friction on the edge of slipping makes errors grow to about a tenth of the noise at worst.
_RTOL_PER_M, _RTOL = 0.1, (1e-5, 1e-4)
FINE_RTOL = 1e-6  #: that for the final numbers [1]
#: The wheels' motion by few samples is used where it has less than this share of the others' samples: the
#: run that differences are taken from must be simulated once more.
_MUCH_FEWER = 0.5
#: Steps after which a run counts as diverged: 2.9 s of a fast robot on a steep law take up to 13 000.
_MOST_STEPS = 40_000


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """Cleaned trials on one surface, the recipe to compare them with, and the compiled simulator.

    ``measured`` (R, T, 3) and ``seen`` (R, T, 3) are padded to the longest trial; ``wheel_phases`` (R, N)
    are added to the wheel angles [rad]; ``piece`` is the number of samples a piece, None for whole runs;
    ``step_s`` is the usual time from sample to sample [s]; ``weights`` (R,) are those of the trials in
    residuals, none where all are one; ``lasting`` is the part of the noise that lasts, None where it is
    white.  The trials of a campaign are of several ``members``, each a recipe and its nominal model;
    ``member_of`` (R,) says of which.  ``signals`` is the wheels' motion without these phases;
    ``rough_signals`` is that by fewer samples, where it is known.
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
    step_s: float
    wheel_phases: Array
    scheme: InterpolationScheme = InterpolationScheme.THIN
    rtol: float = _RTOL[0]
    piece: int | None = None
    lasting: LastingNoise | None = None
    weights: Array = field(default_factory=lambda: np.zeros(0))
    members: tuple[tuple[Recipe, Model], ...] = ()
    member_of: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    signals: tuple[WheelSignal, ...] = ()
    rough_signals: tuple[WheelSignal, ...] = ()

    @staticmethod
    def of(
        recipe: Recipe,
        surface: str,
        trials: tuple[Trial, ...],
        sigma: Array,
        commanded: bool,
        members: Sequence[tuple[Recipe, Model]] = (),
        member_of: Sequence[int] | Index = (),
    ) -> Problem:
        """Pad the trials and compile their wheel signals; without members all are of one data set."""
        nominal = nominal_model(recipe.robot, surface)
        members = tuple(members) or ((recipe, nominal),)
        own = np.zeros(len(trials), dtype=np.int64) if not len(member_of) else np.asarray(member_of)
        begun = [
            started(members[m][1], t, wheel_signal(t, commanded), sigma, commanded)
            for m, t in zip(own, trials, strict=True)
        ]
        signals = tuple(signal for signal, _ in begun)
        batch = _flattened(trials, signals, commanded)
        wheels = [(members[m][1], t, s) for m, t, s in zip(own, trials, signals, strict=True)]
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
            step_s=float(np.median(np.concatenate([np.diff(t.t_s) for t in trials]))),
            wheel_phases=np.zeros((len(trials), nominal.count)),
            starts=np.array([_first_pose(*of) for of in wheels]),
            twists=np.array([twist for _, twist in begun]),
            members=members,
            member_of=own,
            signals=signals,
            rtol=float(np.clip(_RTOL_PER_M * np.min(sigma[:2]), *_RTOL)),
        )

    def model(self, effects: Sequence[AnyEffect], member: int = 0) -> Model:
        """The model of a member's recipe with those of these effects on top that act in it."""
        recipe, nominal = self.members[member]
        return with_effects(nominal, (*recipe.effects, *acting(effects, member)))

    def predict(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """Measured pose as each set of effects predicts it on its trials: (R_k, T, 3), start fitted."""
        return [pose for pose, _ in self.compare(effects, trials)]

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """Whitened, weighted residual (R_k, 3 T) of each set of effects on its trials; 0 where not seen."""
        return [
            self._flat(gap, part)
            for part, (_, gap) in zip(trials, self.compare(effects, trials), strict=True)
        ]

    def residual_of(self, pose: Array, runs: Index) -> Array:
        """Whitened, weighted residual (R, 3 T) of predicted poses (R, T, 3) of trials ``runs``."""
        return self._flat(self.gaps(pose, runs)[1], runs)

    def _flat(self, gap: Array, runs: Index) -> Array:
        """Weighted residual (R, 3 T) of gaps (R, T, 3)."""
        flat = gap.transpose(0, 2, 1).reshape(len(gap), -1)
        return self.weights[runs][:, None] * flat if len(self.weights) else flat

    def near(self, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index) -> list[Array]:
        """Residual (R, K) a step on each of several ways from ``effects``.

        It is told to first order, from one simulation for all, where a way changes forces only.
        """
        return near(self, effects, ways, trials)

    def compare(
        self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]
    ) -> list[tuple[Array, Array]]:
        """Predicted pose and whitened gap, both (R_k, T, 3), of each set of effects on its trials."""
        sets = np.repeat(np.arange(len(effects)), [len(t) for t in trials])
        runs = np.concatenate([np.asarray(t, dtype=np.int64) for t in trials])
        pairs, which = np.unique(np.column_stack([sets, self.member_of[runs]]), axis=0, return_inverse=True)
        built = [self.possible(effects[k], int(member)) for k, member in pairs]
        models = [self.nominal if m is None else m for m in built]
        pose = self._simulated(models, which.ravel(), runs)
        pose, gap = self.gaps(pose, runs)
        impossible = np.asarray([m is None for m in built], dtype=bool)[which.ravel()]
        gap = np.where(self.seen[runs] & impossible[:, None, None], SETTINGS.wild, gap)
        parts = np.split(np.arange(len(runs)), np.cumsum([len(t) for t in trials])[:-1])
        return [(pose[part], gap[part]) for part in parts]

    def gaps(self, pose: Array, runs: Index) -> tuple[Array, Array]:
        """Poses (M, T, 3) predicted for trials ``runs`` (M,), with their starts fitted; the whitened gaps."""
        seen = self.seen[runs]
        # Not seen at first: the start may be far from what is assumed.
        moving: NDArray[np.bool_] = ~np.all(seen[:, :1], axis=2)
        if self.piece is None and moving.any():
            turned = aligned(pose, self.measured[runs], seen)
            pose = np.where(moving[..., None], turned, pose)
        if self.piece is None:
            return self._fitted(pose, self.measured[runs], seen)
        cut = [_cut(array, self.piece) for array in (pose, self.measured[runs], seen)]
        fitted = self._fitted(aligned(*cut), cut[1], cut[2])
        moved, gap = (a.reshape(len(runs), -1, 3)[:, : pose.shape[1]] for a in fitted)
        return moved, gap

    def _simulated(self, models: Sequence[Model], which: Index, runs: Index) -> Array:
        """Measured pose (R, T, 3) of each run as its model predicts it; equal cases are simulated once."""
        packed = [pack(m) for m in models]
        keys = [(p.tobytes(), m.measurement.clock) for p, m in zip(packed, models, strict=True)]
        first: dict[tuple[bytes, float], int] = {}
        same = np.array([first.setdefault(key, k) for k, key in enumerate(keys)])
        cases, back = np.unique(np.column_stack([same[which], runs]), axis=0, return_inverse=True)
        pose = np.empty((len(cases), self.measured.shape[1], 3))
        rows = stack(packed)
        clocks = np.array([m.measurement.clock for m in models])[cases[:, 0]]
        for clock in np.unique(clocks):
            part = np.flatnonzero(clocks == clock)
            pose[part] = self._told(float(clock), rows, *cases[part].T)
        pose = pose[back.ravel()]
        for k, model_k in enumerate(models):
            self.sense(model_k, np.flatnonzero(which == k), runs, pose)
        return pose

    def _told(self, clock: float, rows: Array, which: Index, runs: Index) -> Array:
        """Pose (K, T, 3) of packed models in runs; of those that take too many steps more coarsely."""
        found = self.simulated(clock, rows, runs, which=which)
        long = np.flatnonzero(found.ending == Ending.TOO_LONG)
        if len(long) and self.rtol < _RTOL[1]:
            coarser = replace(self, rtol=min(10.0 * self.rtol, _RTOL[1]))
            found.pose[long] = coarser._told(clock, rows, which[long], runs[long])
        return found.pose

    def simulated(self, clock: float, rows: Array, runs: Index, **more: Any) -> Outcome:
        """Packed models ``rows`` simulated in runs, on a clock."""
        by_speed = self.commanded or any(t.record.theta is None for t in self.trials)
        return self.batch.at_clock(clock, by_speed=by_speed).run(
            rows,
            self.starts[runs],
            start_twist=self.twists[runs] / clock,
            signal=runs,
            rtol=self.rtol,
            max_steps=_MOST_STEPS,
            held_down=np.inf,  # what was measured did not tip: a prediction of it goes on
            **more,
        )

    def sense(self, model: Model, rows: Index, runs: Index, pose: Array) -> None:
        """In place: what a model's sensor reports of some rows of ``pose`` (M, T, 3), of trials ``runs``."""
        if not is_ideal(model.measurement):
            times_s = [self.trials[run].record.since_s for run in runs[rows]]
            pose[rows] = measure(model.measurement, times_s, pose[rows])

    def _fitted(self, pose: Array, measured: Array, seen: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Predicted poses (M, T, 3) moved to where the start fits best, and the whitened gap left."""
        return fitted_start(pose, measured, seen, self.sigma, self.lasting, self.step_s)

    def possible(self, effects: Sequence[AnyEffect], member: int = 0) -> Model | None:
        """The model, or None where no machine is like that (a wheel would lift)."""
        try:
            return self.model(effects, member)
        except InputError:
            return None

    def residual_rates(self, predicted: Array) -> list[Array]:
        """Rate (T, 3) of measured − ``predicted`` (R, T, 3) of each trial, body frame [m/s, m/s, rad/s]."""
        return [
            residual_rate(t.t_s, t.pose, p[: len(t.t_s)], self.nominal.convention)
            for t, p in zip(self.trials, predicted, strict=True)
        ]

    def restarted(self, effects: tuple[AnyEffect, ...], trials: Index) -> Problem:
        """The same problem, whose ``trials`` start where all of their frames together put them.

        The first frame alone says less exactly where a run began and which way the robot looked, and with
        that what a floor does to it that is not the same everywhere or in every direction.
        """
        if self.piece is not None:
            return self
        members, which = np.unique(self.member_of[trials], return_inverse=True)
        pose = self._simulated([self.model(effects, int(m)) for m in members], which.ravel(), trials)
        shift = self.gaps(pose, trials)[0][:, 0] - pose[:, 0]
        starts = self.starts.copy()
        starts[trials] += np.where(np.isfinite(shift), shift, 0.0)
        return replace(self, starts=starts)

    def rebuilt(self, scheme: InterpolationScheme) -> Problem:
        """The same problem with the wheels' motion interpolated differently, and integrated finely."""
        signals = self._interpolated(scheme)
        batch = self._batch(signals, self.wheel_phases)
        return replace(self, batch=batch, signals=signals, rough_signals=(), scheme=scheme, rtol=FINE_RTOL)

    def with_rough(self) -> Problem:
        """The same problem, which knows the wheels' motion by few samples where these are much fewer."""
        if self.commanded and any(t.record.commands_held for t in self.trials):
            return self  # each jump of a command makes the wheels slide: a smooth motion is another one
        made = self._interpolated(InterpolationScheme.ROUGH)
        fewer = sum(len(s.knots_s) for s in made) < _MUCH_FEWER * sum(len(s.knots_s) for s in self.signals)
        return replace(self, rough_signals=made) if fewer else self

    def rough(self) -> Problem:
        """For differences of runs: the same problem with the wheels' motion by few samples, where known."""
        if not self.rough_signals:
            return self
        batch = self._batch(self.rough_signals, self.wheel_phases)
        return replace(
            self,
            batch=batch,
            signals=self.rough_signals,
            rough_signals=(),
            scheme=InterpolationScheme.ROUGH,
        )

    def with_wheel_phases(self, phases: Array) -> Problem:
        """The same problem with other angles (R, N) added to the wheels' [rad]."""
        return replace(self, batch=self._batch(self.signals, phases), wheel_phases=phases)

    def seen_after(self, t_s: Array) -> Problem:
        """The same problem with only those samples of each trial that come after its time ``t_s`` (R,)."""
        late = np.zeros(self.seen.shape[:2], dtype=bool)
        for row, trial, start in zip(late, self.trials, t_s, strict=True):
            row[: len(trial.t_s)] = trial.t_s > start
        return replace(self, seen=self.seen & late[..., None])

    def _interpolated(self, scheme: InterpolationScheme) -> tuple[WheelSignal, ...]:
        """The wheels' motion interpolated differently, after the same speeds."""
        return tuple(
            replace(wheel_signal(t, self.commanded, scheme), spin_rad_s=known.spin_rad_s)
            for t, known in zip(self.trials, self.signals, strict=True)
        )

    def _batch(self, signals: tuple[WheelSignal, ...], phases: Array) -> Batch:
        turned = [with_phases(signal, row) for signal, row in zip(signals, phases, strict=True)]
        return _flattened(self.trials, turned, self.commanded)

    @property
    def knots(self) -> float:
        """How many samples of the wheels' motion a run of differences has on average."""
        return float(np.mean([len(s.knots_s) for s in self.rough_signals or self.signals]))

    def in_pieces(self, duration_s: float) -> Problem:
        """The same problem compared piece by piece, each with a start pose of its own."""
        return replace(self, piece=max(4, round(duration_s / self.step_s)))

    @property
    def piece_s(self) -> float:
        """Length of a piece [s]; infinite for whole runs."""
        return np.inf if self.piece is None else self.piece * self.step_s

    def as_seen_in(self, view: Problem, runs: Sequence[int] | None = None) -> Problem:
        """The same problem, compared as a view does: in pieces as long, trials weighted alike, as finely.

        ``runs`` are the numbers in the view of the trials that those of this problem are cut from.
        """
        weights = view.weights
        if runs is not None and len(weights):
            weights = weights[list(runs)]
        return replace(self, piece=view.piece, weights=weights, rtol=min(self.rtol, view.rtol))

    def evened(self, effects: tuple[AnyEffect, ...], trials: Index) -> Problem:
        """The same problem, in which none of these trials far outweighs the middle one of those missed.

        What a model lacks may show a hundred times as strongly in one run as in all others, and in a sum of
        squares that run alone would say what it is.
        """
        chi = np.nan_to_num(self.misses(effects, trials), posinf=SETTINGS.wild)
        loud = chi[chi > SETTINGS.noise_chi]
        if not len(loud):
            return replace(self, weights=np.zeros(0))
        weights = np.ones(len(self.trials))
        weights[trials] = np.minimum(1.0, SETTINGS.loudest * np.median(loud) / np.maximum(chi, 1e-12))
        return replace(self, weights=weights)

    def misses(self, effects: tuple[AnyEffect, ...], trials: Index) -> Array:
        """Root mean square (R,) of what the model with effects misses each trial by, over the noise."""
        residual = replace(self, weights=np.zeros(0)).residuals([effects], [trials])[0]
        counts = np.maximum(1, np.count_nonzero(residual, axis=1))
        return np.asarray(np.nan_to_num(np.sqrt(np.sum(residual**2, axis=1) / counts), nan=np.inf))

    def samples(self, trials: Index) -> float:
        """Number of measured values in these trials."""
        return float(np.count_nonzero(self.seen[trials]))


def _flattened(trials: Sequence[Trial], signals: Sequence[WheelSignal], commanded: bool) -> Batch:
    """The trials' signals and times, which count from where the runs began."""
    times_s, began_s = [t.t_s for t in trials], [t.record.start_s for t in trials]
    return Batch(signals, times_s, commanded=commanded, began_s=began_s)


def _first_pose(model: Model, trial: Trial, signal: WheelSignal) -> Array:
    """Pose (3,) at the first instant: as measured, or led back by the wheels from where it is first seen."""
    first = int(np.argmax(np.isfinite(trial.pose).all(axis=1)))
    if not first:
        return trial.start
    turned = angles_at(signal, trial.t_s[[0, first]])
    way = model.geometry.no_slip_map() @ (turned[1] - turned[0])
    if not way.any():
        return trial.start
    seen = trial.pose[first]
    heading = float(seen[2] - way[2])
    return np.append(seen[:2] - rotate_rows(heading + 0.5 * way[2], way[:2]), heading)


def _cut(array: NDArray[Any], piece: int) -> NDArray[Any]:
    """(M, T, 3) into pieces (M W, piece, 3); the last is filled up with zeros, which count as not seen."""
    fill = -array.shape[1] % piece
    return np.pad(array, ((0, 0), (0, fill), (0, 0))).reshape(-1, piece, 3)
