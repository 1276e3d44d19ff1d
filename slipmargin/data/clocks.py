"""Faults of the stamps: times counted from 1970, stamps that tremble, a camera with a clock of its own."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.record import WHEEL_SIGNALS, Record
from slipmargin.data.repair import Repair, run_by_run
from slipmargin.data.settings import SETTINGS


def from_zero(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Times from the start of each run where they are counted from long before."""

    def mend(record: Record) -> tuple[Record, float]:
        start = float(record.t_s[0])
        if abs(start) < SETTINGS.epoch_s:
            return record, 0.0
        return record.restamped(record.t_s - start), start

    return run_by_run(
        data_set,
        mend,
        "epoch_time",
        "s",
        lambda size, where: (
            f"Times are counted from long before the runs ({size:.10g} s), {where}: they were counted "
            f"from each run's start."
        ),
        total=min,
    )


def regular(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Equal steps of time where stamps tremble about them and the motion does not.

    Each sample is compared with the line between its neighbours, on the stamps as they are and on equal
    steps.  Where samples were taken at equal steps and stamped late or early, equal steps make the wheel
    angles (or, without them, the pose) smoother.
    """
    found = [_grid(trial) for trial in data_set.trials]
    pairs = [(t, g) for t, g in zip(data_set.trials, found, strict=True) if g is not None]
    if not pairs:
        return data_set, ()
    stamped, equal = (
        np.sqrt(np.mean([_roughness(x, _signal(t)) ** 2 for t, x in times]))
        for times in ([(t, t.t_s) for t, _ in pairs], pairs)
    )
    if equal > SETTINGS.smoother * stamped:
        return data_set, ()

    def mend(record: Record) -> tuple[Record, float]:
        grid = _grid(record)
        if grid is None:
            return record, 0.0
        return record.restamped(grid), float(np.sqrt(np.mean((record.t_s - grid) ** 2)))

    return run_by_run(
        data_set,
        mend,
        "trembling_stamps",
        "s",
        lambda size, where: (
            f"Stamps miss equal steps by {1e3 * size:.2g} ms (root mean square), {where}, though the "
            f"wheels turn "
            "smoothly on equal steps: the time was made regular."
        ),
        total=max,
    )


def _grid(record: Record) -> Array | None:
    """Equal steps of time through the stamps of a run; None where they are equal, or far from it."""
    t = record.t_s
    if len(t) < 16:
        return None
    for number in (np.arange(len(t), dtype=float), np.round((t - t[0]) / float(np.median(np.diff(t))))):
        if np.min(np.diff(number)) < 1.0:  # no rows are missing, or the stamps tremble by more than a step
            continue
        step, start = np.polyfit(number, t, 1)
        grid = np.asarray(start + step * number)
        off = np.abs(t - grid)
        if off.max() < step:
            return grid if float(np.sqrt(np.mean(off**2))) > SETTINGS.tremble * step else None
    return None


def _signal(record: Record) -> Array:
    """The smoothest signal of a run."""
    signals = (record.theta, record.omega, record.pose)
    return next((s for s in signals if s is not None and np.isfinite(s).any()), record.pose)


def _roughness(t: Array, signal: Array) -> float:
    """What samples miss the line between their neighbours by: root mean square over columns of the median."""
    w = ((t[1:-1] - t[:-2]) / (t[2:] - t[:-2]))[:, None]
    miss = np.abs(signal[1:-1] - signal[:-2] * (1.0 - w) - signal[2:] * w)
    middle = [float(np.quantile(c[np.isfinite(c)], 0.75)) for c in miss.T if np.isfinite(c).any()]
    return float(np.sqrt(np.mean(np.square(middle)))) if middle else 0.0


def at_times(record: Record, t_s: Array, pose: Array) -> Record:
    """The wheels' signals of a run at other times, with poses measured then."""
    signals: dict[str, Any] = {}
    for field in WHEEL_SIGNALS:
        value: Array | None = getattr(record, field)
        if value is None:
            continue
        if field == "theta" and record.omega is not None and np.isfinite(record.omega).all():
            signals[field] = _cubic(record.t_s, value, record.omega, t_s)
        else:
            signals[field] = np.column_stack([_line(record.t_s, c, t_s) for c in value.T])
    return replace(record, t_s=t_s, pose=pose, **signals)


def _line(t: Array, values: Array, at: Array) -> Array:
    known = np.isfinite(values)
    return np.interp(at, t[known], values[known]) if known.any() else np.full(len(at), np.nan)


def _cubic(t: Array, values: Array, rates: Array, at: Array) -> Array:
    """Cubic through values (T, N) with known rates."""
    k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    h = (t[k + 1] - t[k])[:, None]
    u = (at[:, None] - t[k][:, None]) / h
    return np.asarray(
        (1 + 2 * u) * (1 - u) ** 2 * values[k]
        + u * (1 - u) ** 2 * h * rates[k]
        + u**2 * (3 - 2 * u) * values[k + 1]
        + u**2 * (u - 1) * h * rates[k + 1]
    )
