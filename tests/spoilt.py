"""Faults of measured data, each put into good data, to test the repairs and the checks with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.record import Record
from slipmargin.effects import Trace
from slipmargin.effects.friction_coefficients import FrictionCoefficients

Random = np.random.Generator


@cache
def good(seed: int = 3, *, count: int = 8, duration_s: float = 2.5, rate_hz: float = 100.0) -> DataSet:
    """A small data set in which nothing is wrong and nothing is missing."""
    return planted(smooth_kiwi(), None, seed, count=count, duration_s=duration_s, rate_hz=rate_hz)


def each(data_set: DataSet, change: Callable[[Record], Record], runs: set[int] | None = None) -> DataSet:
    """The data set with some runs changed (None: all)."""
    trials = (change(t) if runs is None or i in runs else t for i, t in enumerate(data_set.trials))
    return replace(data_set, trials=tuple(trials))


def posed(data_set: DataSet, change: Callable[[Array], Array], runs: set[int] | None = None) -> DataSet:
    """The data set with the poses of some runs changed."""
    return each(data_set, lambda r: replace(r, pose=change(np.array(r.pose))), runs)


def sampled(record: Record, t: Array) -> Array:
    """The poses at other times, on the line between samples."""
    return np.column_stack([np.interp(t, record.t_s, column) for column in record.pose.T])


def slow_camera(data_set: DataSet, rate_hz: float, random: Random, *, absent: bool = False) -> DataSet:
    """A camera that is slower than the log: each frame is repeated until the next, or is there once."""

    def slow(record: Record) -> Record:
        t = record.t_s
        frame = np.floor((t - t[0]) * rate_hz + 1e-9)
        clean = np.column_stack([_smoothed(column) for column in record.pose.T])
        at = sampled(replace(record, pose=clean), t[0] + frame / rate_hz)
        first = np.unique(frame, return_index=True)[1]
        noise = np.zeros_like(at)
        sigma = data_set.sigma if data_set.sigma is not None else np.full(3, 5e-4)
        drawn = sigma * random.standard_normal((len(first), 3))
        noise[:] = drawn[np.searchsorted(first, np.arange(len(t)), side="right") - 1]
        pose = at + noise
        if absent:
            pose[np.setdiff1d(np.arange(len(t)), first)] = np.nan
        return replace(record, pose=pose)

    return each(data_set, slow)


def _smoothed(column: Array) -> Array:
    from scipy.signal import savgol_filter

    return np.asarray(savgol_filter(column, 9, 2))


def held_frames(data_set: DataSet, random: Random, share: float = 0.1, *, zero: bool = False) -> DataSet:
    """Frames that repeat the one before, or are zero."""

    def change(pose: Array) -> Array:
        for k in range(1, len(pose)):
            if random.random() < share:
                pose[k] = 0.0 if zero else pose[k - 1]
        return pose

    return posed(data_set, change)


def jumps(data_set: DataSet, random: Random, share: float = 0.05, size_m: float = 0.05) -> DataSet:
    """Single frames that are far off."""

    def change(pose: Array) -> Array:
        hit = random.random(len(pose)) < share
        pose[hit] += np.array([size_m, size_m, 5 * size_m]) * random.standard_normal((hit.sum(), 3))
        return pose

    return posed(data_set, change)


def relocking(data_set: DataSet, random: Random, size_m: float = 0.5, span_s: float = 0.15) -> DataSet:
    """Each run is somewhere else for a moment."""

    def change(record: Record) -> Record:
        start = random.uniform(0.2, record.duration_s - 0.5)
        way = random.uniform(0.0, 2.0 * np.pi)
        pose = np.array(record.pose)
        off = (record.t_s >= start) & (record.t_s < start + span_s)
        pose[off, :2] += size_m * np.array([np.cos(way), np.sin(way)])
        return replace(record, pose=pose)

    return each(data_set, change)


def coloured(data_set: DataSet, random: Random, sd: Array, time_s: float) -> DataSet:
    """Noise of first order (an Ornstein-Uhlenbeck process) added to what is there."""

    def change(record: Record) -> Record:
        keep = np.exp(-np.diff(record.t_s) / time_s)
        noise = np.zeros_like(record.pose)
        noise[0] = sd * random.standard_normal(3)
        for k, a in enumerate(keep):
            noise[k + 1] = a * noise[k] + np.sqrt(1.0 - a * a) * sd * random.standard_normal(3)
        return replace(record, pose=record.pose + noise)

    return each(data_set, change)


def random_walk(data_set: DataSet, random: Random, sd: Array) -> DataSet:
    """A random walk added, as far as ``sd`` after one run."""

    def change(record: Record) -> Record:
        step = sd * np.sqrt(1.0 / len(record.t_s)) * random.standard_normal(record.pose.shape)
        return replace(record, pose=record.pose + np.cumsum(step, axis=0))

    return each(data_set, change)


def heavy_tails(data_set: DataSet, random: Random) -> DataSet:
    """Noise of Student's t distribution with three degrees of freedom, added."""
    assert data_set.sigma is not None
    sigma = data_set.sigma
    return posed(data_set, lambda p: p + sigma * random.standard_t(3, p.shape))


def noise_stated(data_set: DataSet, factor: float) -> DataSet:
    """The noise is stated wrong by a factor."""
    assert data_set.sigma is not None
    return replace(data_set, sigma=factor * data_set.sigma)


def jitter(data_set: DataSet, random: Random, sd_s: float = 0.002) -> DataSet:
    """Samples were taken regularly; their stamps tremble."""

    def change(record: Record) -> Record:
        t = record.t_s + (sd_s * random.standard_normal(len(record.t_s))).clip(-0.0045, 0.0045)
        return replace(record, t_s=t)

    return each(data_set, change)


def camera_clock(data_set: DataSet, random: Random, factor: float = 1.02) -> DataSet:
    """The camera's clock runs slow: what it says at t was at ``factor`` t."""
    assert data_set.sigma is not None
    sigma = data_set.sigma

    def change(record: Record) -> Record:
        clean = replace(record, pose=np.column_stack([_smoothed(c) for c in record.pose.T]))
        at = factor * record.t_s
        pose = sampled(clean, at) + sigma * random.standard_normal(record.pose.shape)
        pose[at > record.t_s[-1]] = np.nan
        return replace(record, pose=pose)

    return each(data_set, change)


def all_clocks(data_set: DataSet, factor: float = 1.02) -> DataSet:
    """The one clock of the log runs fast."""
    return each(data_set, lambda r: replace(r, t_s=factor * r.t_s))


def wrapped(values: Array) -> Array:
    """Angles within ±π."""
    return np.asarray((values + np.pi) % (2.0 * np.pi) - np.pi)


def heading_turned(record: Record) -> Record:
    """The same run on a floor frame turned so that the heading starts at 179°, with headings within ±π."""
    turn = np.deg2rad(179.0) - record.pose[0, 2]
    c, s = np.cos(turn), np.sin(turn)
    x, y, phi = record.pose.T
    return replace(record, pose=np.column_stack([c * x - s * y, s * x + c * y, wrapped(phi + turn)]))


def wheel(record: Record, **change: Callable[[Array], Array]) -> Record:
    """The record with wheel signals changed."""
    signals: dict[str, Any] = {
        f: c(np.array(v)) for f, c in change.items() if (v := getattr(record, f)) is not None
    }
    return replace(record, **signals)


def turned_wheel(record: Record, i: int = 1) -> Record:
    """Wheel ``i`` counts the other way."""

    def turn(values: Array) -> Array:
        values[:, i] *= -1.0
        return values

    return wheel(record, theta=turn, omega=turn)


def swapped(record: Record) -> Record:
    """The columns of the first two wheels are swapped."""

    def swap(values: Array) -> Array:
        return np.asarray(values[:, [1, 0, *range(2, values.shape[1])]])

    return wheel(record, theta=swap, omega=swap)


def coarse(record: Record, ticks: int = 100) -> Record:
    """Encoders of so many ticks a turn; the speed is the difference of the counts."""
    assert record.theta is not None
    tick = 2.0 * np.pi / ticks
    theta = np.floor(record.theta / tick) * tick
    omega = np.gradient(theta, record.t_s, axis=0)
    return replace(record, theta=theta, omega=omega)


def other_floor(data_set: DataSet, runs: set[int], factor: float = 0.7, seed: int = 3) -> DataSet:
    """Some runs on a floor with ``factor`` of the grip."""
    slick = FrictionCoefficients(drive_factor=factor, transverse_factor=factor)
    plant = Plant(name="slick", traces=(Trace.COEFFICIENT,), effects=(slick,))
    first = data_set.trials[0]
    rate = 1.0 / float(np.median(np.diff(first.t_s)))
    other = planted(
        data_set.recipe, plant, seed, count=len(data_set.trials), duration_s=first.duration_s, rate_hz=rate
    )
    trials = tuple(
        o if i in runs else t for i, (t, o) in enumerate(zip(data_set.trials, other.trials, strict=True))
    )
    return replace(data_set, trials=trials)
