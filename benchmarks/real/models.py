"""The rows of the benchmark: what predicts a robot's motion from its wheels.

A model is fitted to runs and gives, for a run, the path in the body frame (T, 3) that it predicts:
forwards and sideways way [m] and heading [rad], each added up from the run's first pose. Who adds a row
writes a class with ``fit`` and ``path`` and a line in :data:`ROWS`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from real.sets import RealSet
from slipmargin.checks import Array
from slipmargin.data.odometry import body_path, bridged, wheel_angles, wheel_path
from slipmargin.data.record import Record
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.confined import acting

#: Wheels' past that a learnt model sees [s], and how many samples of it.
PAST_S, SAMPLES = 0.25, 6
#: Over how long a measured velocity is differentiated for fits [s].
SPAN_S = 0.1


class Model(Protocol):
    """A row."""

    def fit(self, data: RealSet) -> None:
        """Learn from the runs that may be fitted."""

    def path(self, record: Record) -> Array:
        """(T, 3) path in the body frame from the first row."""


def wheels_path(record: Record, data: RealSet) -> Array:
    """(T, 3) what the wheels say if nothing slips."""
    angles = wheel_angles(record.t_s, record.theta, record.omega)
    assert angles is not None
    return wheel_path(data.recipe.build(data.surface).geometry, angles)


def rate(t: Array, path: Array, span_s: float = SPAN_S) -> Array:
    """(T, 3) its rate of change over ``span_s``."""
    half = max(1, round(0.5 * span_s / float(np.median(np.diff(t)))))
    index = np.arange(len(t))
    low, high = np.maximum(index - half, 0), np.minimum(index + half, len(t) - 1)
    return np.asarray((path[high] - path[low]) / (t[high] - t[low])[:, None])


def bridged_path(record: Record) -> Array:
    """(T, 3) as measured, frames that are missing bridged."""
    return body_path(bridged(record.t_s, record.pose))


def measured_path(record: Record) -> Array:
    """(T, 3) as measured, NaN where the pose is not known."""
    path = bridged_path(record)
    path[~record.seen] = np.nan
    return path


def summed(t: Array, velocity: Array) -> Array:
    """(T, 3) velocities added up by the trapezoidal rule."""
    step = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(t)[:, None]
    return np.vstack([np.zeros(3), np.cumsum(step, axis=0)])


class AsTheyAre:
    """The wheels as they are: no slip, radii as stated."""

    def fit(self, data: RealSet) -> None:
        """Nothing to learn."""
        self.data = data

    def path(self, record: Record) -> Array:
        """What the wheels say."""
        return wheels_path(record, self.data)


class RunsBeside:
    """No model: the mean of the two fitted runs whose headings lie beside.

    How well runs repeat: what two runs and this one differ by at random no model of a robot can know.
    """

    def fit(self, data: RealSet) -> None:
        """The runs are the fit."""
        self.beside = data.beside

    def path(self, record: Record) -> Array:
        """Their mean, as far as it must be lengthened for pointing to the left and to the right."""
        since = record.t_s - record.t_s[0]
        one, two = (
            np.column_stack([np.interp(since, r.t_s - r.t_s[0], column) for column in bridged_path(r).T])
            for r in self.beside[record.name]
        )
        mean = 0.5 * (one + two)
        apart = angle_between(one[-1, :2], two[-1, :2])
        return mean / np.array([np.cos(0.5 * apart), np.cos(0.5 * apart), 1.0])


def angle_between(a: Array, b: Array) -> float:
    """Between two directions in the plane [rad]."""
    return float(np.arctan2(abs(a[0] * b[1] - a[1] * b[0]), a @ b))


class Linear:
    """Velocity as a linear function of features of the wheels' velocity, axis by axis, least squares."""

    def features(self, t: Array, wheels: Array) -> list[Array]:
        """For each axis its features (T, K)."""
        raise NotImplementedError

    def fit(self, data: RealSet) -> None:
        """Least squares over the samples of all fitted runs."""
        self.data = data
        rows: list[list[Array]] = [[], [], []]
        sought: list[list[Array]] = [[], [], []]
        for record in data.own:
            t = record.t_s
            velocity = rate(t, bridged_path(record))
            known = record.seen
            features = self.features(t, rate(t, wheels_path(record, data)))
            for axis in range(3):
                rows[axis].append(features[axis][known])
                sought[axis].append(velocity[known, axis])
        self.weights = [
            self.solve(np.concatenate(a), np.concatenate(b)) for a, b in zip(rows, sought, strict=True)
        ]

    def solve(self, rows: Array, sought: Array) -> Array:
        """Weights (K,) of one axis."""
        return np.asarray(np.linalg.lstsq(rows, sought, rcond=None)[0])

    def path(self, record: Record) -> Array:
        """Its velocity added up."""
        features = self.features(record.t_s, rate(record.t_s, wheels_path(record, self.data)))
        velocity = np.column_stack([f @ w for f, w in zip(features, self.weights, strict=True)])
        return summed(record.t_s, velocity)


class ScalePerAxis(Linear):
    """v = g u: one factor for each axis."""

    def features(self, t: Array, wheels: Array) -> list[Array]:
        """The axis itself."""
        return [wheels[:, [axis]] for axis in range(3)]


class GainCoulombLag(Linear):
    """TIGERs-type: v = g u − c sign u − τ u̇ on each axis (gain, Coulomb friction, lag)."""

    #: Below this a wheel counts as standing [m/s, rad/s].
    STANDS = 0.02

    def features(self, t: Array, wheels: Array) -> list[Array]:
        """The axis, its sign and its rate."""
        change = rate(t, wheels)
        return [
            np.column_stack([wheels[:, k], np.tanh(wheels[:, k] / self.STANDS), change[:, k]])
            for k in range(3)
        ]


class Sparse(Linear):
    """Sparse regression: products and magnitudes of the wheels' velocity and its rate, small terms dropped.

    Sequentially thresholded least squares (Brunton, Proctor, Kutz, PNAS 113, 3932, 2016).
    """

    #: Terms that move the velocity by less than this share of its spread are dropped, so many times.
    LEAST, TIMES = 0.05, 10

    def features(self, t: Array, wheels: Array) -> list[Array]:
        """The same library for every axis."""
        a = rate(t, wheels)
        u, v, w = wheels.T
        library = [u, v, w, *a.T, u * w, v * w, np.abs(u) * u, np.abs(v) * v, np.abs(w) * w, u**3, v**3]
        library += [np.abs(v) * u, np.abs(u) * v, np.tanh(u / 0.02), np.tanh(v / 0.02), np.tanh(w / 0.1)]
        return [np.column_stack(library)] * 3

    def solve(self, rows: Array, sought: Array) -> Array:
        """Weights, most of them zero."""
        size = np.maximum(rows.std(axis=0), 1e-9)
        keep = np.ones(rows.shape[1], dtype=bool)
        weights = np.zeros(rows.shape[1])
        for _ in range(self.TIMES):
            weights = np.zeros(rows.shape[1])
            if not keep.any():
                break
            scaled = rows[:, keep] / size[keep]
            ridge = 1e-3 * len(rows) * np.eye(int(keep.sum()))
            weights[keep] = np.linalg.solve(scaled.T @ scaled + ridge, scaled.T @ sought)
            small = np.abs(weights) < self.LEAST * np.std(sought)
            if not (small & keep).any():
                break
            keep &= ~small
        return np.asarray(weights / size)


class Network:
    """A small neural network: wheel speeds of the last quarter second to the body's velocity.

    Two layers of 32; a fifth of the fitted runs, whole ones, says when to stop.
    """

    EPOCHS, PATIENCE = 200, 15

    def features(self, record: Record) -> Array:
        """(T, K) wheels' velocities now and before."""
        t = record.t_s
        angles = wheel_angles(t, record.theta, record.omega)
        assert angles is not None
        speeds = rate(t, angles)
        back = np.linspace(0.0, PAST_S, SAMPLES)
        columns = [np.interp(t - lag, t, column) for lag in back for column in speeds.T]
        return np.column_stack(columns)

    def fit(self, data: RealSet) -> None:
        """By Adam, until the runs set aside get no better."""
        from sklearn.neural_network import MLPRegressor

        pairs = [(self.features(r)[r.seen], rate(r.t_s, bridged_path(r))[r.seen]) for r in data.own]
        aside = pairs[::5] if len(pairs) > 1 else pairs
        used = [p for i, p in enumerate(pairs) if i % 5] or pairs
        x, y = (np.concatenate(part) for part in zip(*used, strict=True))
        self.middle, self.spread = x.mean(axis=0), np.maximum(x.std(axis=0), 1e-9)
        self.size = np.maximum(y.std(axis=0), 1e-9)
        far, near = (np.concatenate(part) for part in zip(*aside, strict=True))
        net = MLPRegressor(hidden_layer_sizes=(32, 32), learning_rate_init=2e-3, random_state=0)
        best, since, kept = np.inf, 0, None
        for _ in range(self.EPOCHS):
            net.partial_fit(self._scaled(x), y / self.size)
            error = float(np.mean((net.predict(self._scaled(far)) - near / self.size) ** 2))
            if error < best:
                best, since = error, 0
                kept = [c.copy() for c in net.coefs_], [c.copy() for c in net.intercepts_]
            else:
                since += 1
            if since >= self.PATIENCE:
                break
        assert kept is not None
        net.coefs_, net.intercepts_ = kept
        self.net = net

    def _scaled(self, x: Array) -> Array:
        return np.asarray((x - self.middle) / self.spread)

    def path(self, record: Record) -> Array:
        """Its velocity added up."""
        velocity = self.net.predict(self._scaled(self.features(record))) * self.size
        return summed(record.t_s, velocity)


class Simulated:
    """slipmargin's simulator with the robot as its file describes it (camera as calibrated)."""

    said: tuple[str, ...] = ()
    effects: tuple[AnyEffect, ...] = ()

    def fit(self, data: RealSet) -> None:
        """Nothing to learn."""
        self.data = data

    def path(self, record: Record) -> Array:
        """The simulated pose's path, with the effects that act in the run's recording."""
        effects = acting(self.effects, self.data.member(record))
        return simulated(self.data.recipe.with_effects(*effects), self.data, record)


def simulated(recipe: Recipe, data: RealSet, record: Record) -> Array:
    """(T, 3) path of a run as the simulator predicts it; the start is fitted to the measured run."""
    sigma = data.fitted.sigma if data.fitted.sigma is not None else np.array([1e-3, 1e-3, 1e-2])
    problem = Problem.of(recipe, data.surface, (clean(record, sigma),), sigma, False)
    pose = problem.predict([()], [np.zeros(1, dtype=np.int64)])[0][0]
    return body_path(pose[: len(record.t_s)])


class Diagnosed(Simulated):
    """The same after ``slipmargin diagnose`` was left alone with the fitted runs."""

    def fit(self, data: RealSet) -> None:
        """What the loop finds."""
        self.data = data
        found = diagnose(data.fitted)
        self.effects = tuple(f.effect for f in found.findings)
        self.said = tuple(
            (f"{f.name} (fitted: {f.label}, a name that is not claimed): " if f.doubts else f"{f.label}: ")
            + ", ".join(f"{e.name} {e.value:.4g} ({e.low:.4g} … {e.high:.4g})" for e in f.parameters)
            + (f"; not told apart from {', '.join(f.confused_with)}" if f.confused_with else "")
            for f in found.findings
        ) or (found.verdict.value,)


#: Row that asks how well runs repeat; it needs runs in many directions.
REPEATS = "mean of the two runs beside it (no model)"

#: Name in the table → what makes the row.
ROWS: dict[str, Callable[[], Model]] = {
    "wheels as they are": AsTheyAre,
    "scale per axis": ScalePerAxis,
    "gain, Coulomb, lag per axis (TIGERs-type)": GainCoulombLag,
    "neural network": Network,
    "sparse regression": Sparse,
    REPEATS: RunsBeside,
    "slipmargin, robot as stated": Simulated,
    "slipmargin diagnose": Diagnosed,
}


def rows_for(data: RealSet) -> list[str]:
    """The rows that a set can have."""
    return [name for name in ROWS if name != REPEATS or data.beside]


def windows(t: Array, seen: Array, horizon_s: float | None) -> Sequence[tuple[int, int]]:
    """First and last rows of stretches of a run that follow each other; None: the whole run."""
    rows = np.flatnonzero(seen)
    if horizon_s is None or t[rows[-1]] - t[rows[0]] <= horizon_s:
        return [(int(rows[0]), int(rows[-1]))] if horizon_s is None else []
    found, start = [], int(rows[0])
    while True:
        late = rows[t[rows] >= t[start] + horizon_s - 1e-9]
        if not len(late):
            return found
        found.append((start, int(late[0])))
        start = int(late[0])
