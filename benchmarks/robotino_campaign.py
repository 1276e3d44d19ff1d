"""Runs of a real robot on two floors, ready to predict, and how a prediction is judged.

A run's error is |predicted − measured displacement| / measured distance, displacements as vectors, added up
in the body frame by each one's own heading (a heading error is not charged twice), and predicted − measured
change of heading; root mean squares over runs, all runs.  Beside it the error of the displacement's length.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from slipmargin.data.calibration import Calibration, calibrate
from slipmargin.data.odometry import body_path
from slipmargin.data.record import Record
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.sense import measure
from slipmargin.diagnosis.signals import wheel_signal
from slipmargin.effects import Recipe
from slipmargin.io.importers.plug import import_files
from slipmargin.io.importers.robotino import RobotinoImporter
from slipmargin.io.robot_file import read_recipe
from slipmargin.sim.batch import Batch, Outcome
from slipmargin.sim.pack import pack, stack

Array = NDArray[np.float64]

#: Noise of the camera [m, m, rad], only to tell outliers.
SIGMA = np.array([0.001, 0.001, 0.01])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Runs:
    """Runs of one floor and speed, ready to predict: what was measured over each (R, 3), distance (R,)."""

    names: tuple[str, ...]
    trials: tuple[Record, ...]
    batch: Batch
    starts: Array
    went: Array
    distance: Array

    @staticmethod
    def of(records: tuple[Record, ...]) -> Runs:
        trials = [clean(r, SIGMA) for r in records]
        paths = np.array([body_path(t.pose)[-1] for t in trials])
        return Runs(
            names=tuple(r.name for r in records),
            trials=records,
            batch=Batch([wheel_signal(t, False) for t in trials], [t.t_s for t in trials]),
            starts=np.array([t.start for t in trials]),
            went=paths,
            distance=np.hypot(paths[:, 0], paths[:, 1]),
        )

    @property
    def direction(self) -> Array:
        """(R, 2) unit vectors of the measured displacements, body frame."""
        return np.asarray(self.went[:, :2] / self.distance[:, None])

    def errors(self, recipes: list[Recipe], surface: str, which: NDArray[np.int64] | None = None) -> Array:
        """Predicted − measured (M, R, 3): displacement / distance (2) [1], heading change [rad]."""
        own = np.arange(len(self.names)) if which is None else which
        models = [r.build(surface) for r in recipes]
        run = np.tile(own, len(models))
        outcome: Outcome = self.batch.run(
            stack([pack(m) for m in models]),
            self.starts[run],
            signal=run,
            which=np.repeat(np.arange(len(models)), len(own)),
            rtol=1e-4,
        )
        found = np.empty((len(run), 3))
        for row, r in enumerate(run):
            clock = self.trials[r].t_s
            sensor = models[row // len(own)].measurement
            pose = measure(sensor, [clock], outcome.pose[row : row + 1, : len(clock)])[0]
            found[row] = body_path(pose)[-1] - self.went[r]
            found[row, :2] /= self.distance[r]
        return found.reshape(len(models), len(own), 3)


def summary(error: Array, direction: Array) -> dict[str, float]:
    """Root mean square over runs of displacement, as a vector and in length [1], and of heading change [deg].

    ``direction`` (R, 2) is the unit vector of each run's measured displacement.
    """
    return {
        "displacement": float(np.sqrt(np.mean(np.sum(error[:, :2] ** 2, axis=1)))),
        "length": float(np.sqrt(np.mean((np.hypot(*(direction + error[:, :2]).T) - 1.0) ** 2))),
        "heading_deg": float(np.rad2deg(np.sqrt(np.mean(error[:, 2] ** 2)))),
    }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Campaign:
    """Calibration from ``table``, the recipe it gives, runs on ``gray``, indices of the fitted half."""

    calibration: Calibration
    recipe: Recipe
    slow: Runs
    fast: Runs
    seen: NDArray[np.int64]

    @staticmethod
    def read(folder: Path) -> Campaign:
        """Import all logs as ``slipmargin import robotino`` does."""

        def records(name: str) -> tuple[Record, ...]:
            return import_files(RobotinoImporter(), sorted((folder / name).glob("*.csv"))).records

        recipe = read_recipe("robotino")
        found = calibrate(records("table_0.1"), recipe.build("table").geometry)
        slow, fast = (
            Runs.of(tuple(found.rectified(r) for r in records(name))) for name in ("gray_0.1", "gray_0.2")
        )
        seen = np.arange(0, len(slow.names), 2)  # of all headings: 0, 10, 20, … degrees
        return Campaign(
            calibration=found,
            recipe=replace(recipe, effects=found.effects()),
            slow=slow,
            fast=fast,
            seen=seen,
        )

    def judged(self, recipe: Recipe) -> dict[str, dict[str, float]]:
        """Errors on what was fitted and on what was not."""
        slow, fast = (runs.errors([recipe], "gray")[0] for runs in (self.slow, self.fast))
        other = np.setdiff1d(np.arange(len(slow)), self.seen)
        error = np.concatenate([slow, fast])
        direction = np.concatenate([runs.direction for runs in (self.slow, self.fast)])
        later = len(slow) + np.arange(len(fast))
        worst = later[np.argmax(np.sum(fast[:, :2] ** 2, axis=1))]
        held = np.concatenate([other, later])
        groups = {
            "fitted": self.seen,
            "headings": other,
            "speed": later,
            "held out": held,
            f"held out but {self.fast.names[worst - len(slow)]} at 0.2 m/s": held[held != worst],
        }
        return {name: summary(error[rows], direction[rows]) for name, rows in groups.items()}
