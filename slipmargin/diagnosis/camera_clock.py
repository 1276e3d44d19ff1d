"""One clock for the wheels and the camera: poses that were stamped by another are brought to the wheels'."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.clocks import at_times
from slipmargin.data.data_set import DataSet
from slipmargin.data.record import Record
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS


def one_clock(data_set: DataSet, problem: Problem) -> tuple[DataSet, tuple[Repair, ...]]:
    """With the camera's poses on the wheels' clock, where the camera's runs faster or slower.

    ``problem`` is that of the data set.  A robot that slips by the same share all along falls behind as
    evenly as a slow clock does, but it stops when its wheels stop: the clock must explain the runs far better
    than a longer or shorter way.
    """
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    predicted = problem.predict([()], [everyone])[0]
    found = [
        _rate(t.t_s, t.pose, p[: len(t.t_s)], problem.sigma)
        for t, p in zip(problem.trials, predicted, strict=True)
    ]
    known = np.array([f for f in found if f is not None])
    if len(known) < 3:
        return data_set, ()
    each, weight, without, with_rate = known.T
    order = np.argsort(each)
    rate = float(each[order][np.searchsorted(np.cumsum(weight[order]), 0.5 * weight.sum())])
    spread = 1.4826 * float(np.median(np.abs(each - rate)))
    if not SETTINGS.clock_least < abs(rate) < SETTINGS.clock_most or spread > SETTINGS.clock_agree * abs(
        rate
    ):
        return data_set, ()
    if with_rate.sum() > SETTINGS.clock_leaves * without.sum():
        return data_set, ()
    trials = tuple(_on_wheel_clock(t, 1.0 + rate) for t in data_set.trials)
    return replace(data_set, trials=trials), (
        Repair(
            kind="camera_clock",
            runs=tuple(t.name for t in data_set.trials),
            size=rate,
            unit="1",
            sentence=f"What the camera stamps at t the wheels stamp at {1.0 + rate:.4g} t: its clock runs "
            f"{-100.0 * rate / (1.0 + rate):+.2g} % off. Its poses were brought to the wheels' times.",
        ),
    )


def _rate(t: Array, pose: Array, predicted: Array, sigma: Array) -> tuple[float, float, float, float] | None:
    """How much faster the camera sees a run pass, its weight, and the squared residual without and with that.

    The start pose and a constant delay are fitted with it, since neither is a matter of the clock's rate;
    without it, a share of the way and one of the turn as well.
    """
    seen = np.isfinite(pose).all(axis=1)
    if seen.sum() < 20:
        return None
    since, rate, late = t - t[0], 0.0, 0.0
    without = with_rate = precision = 0.0
    for step in range(5):
        at = t + late + rate * since
        moved = np.column_stack([np.interp(at, t, c) for c in predicted.T])
        speed = np.gradient(moved, t, axis=0)
        arm = moved[:, :2] - moved[0, :2]
        columns = np.zeros((len(t), 3, 5))
        columns[:, 0, 0] = columns[:, 1, 1] = columns[:, 2, 2] = 1.0
        columns[:, 0, 2], columns[:, 1, 2] = -arm[:, 1], arm[:, 0]
        columns[:, :, 3], columns[:, :, 4] = speed, speed * since[:, None]
        rows = (columns / sigma[:, None])[seen].reshape(-1, 5)
        gap = ((pose - moved) / sigma)[seen].ravel()
        if step == 0:
            share = np.zeros((len(t), 3, 2))
            share[:, :2, 0], share[:, 2, 1] = arm, moved[:, 2] - moved[0, 2]
            other = np.hstack([rows[:, :4], (share / sigma[:, None])[seen].reshape(-1, 2)])
            only = np.linalg.lstsq(other, gap, rcond=1e-9)[0]
            without = float(np.sum((gap - other @ only) ** 2))
        found = np.linalg.lstsq(rows, gap, rcond=1e-9)[0]
        with_rate = float(np.sum((gap - rows @ found) ** 2))
        late += float(np.clip(found[3], -0.1, 0.1))
        rate += float(np.clip(found[4], -0.05, 0.05))
        free = rows[:, 4] - rows[:, :4] @ np.linalg.lstsq(rows[:, :4], rows[:, 4], rcond=1e-9)[0]
        precision = float(np.sum(free**2))
    return rate, np.sqrt(precision), without, with_rate


def _on_wheel_clock(record: Record, factor: float) -> Record:
    """The run at the wheels' times of its poses: what the camera saw at t, the wheels did at ``factor`` t."""
    at = record.t_s[0] + factor * (record.t_s - record.t_s[0])
    inside = at <= record.t_s[-1]
    return at_times(record, at[inside], record.pose[inside])
