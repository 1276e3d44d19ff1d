"""Single events in a run: a bump, a lifted wheel, a camera that jumped.  No effect is meant to explain them.

A run is cut at its events and each part is predicted from its own start, so that no effect is fitted to them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.record import Record
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Event
from slipmargin.diagnosis.settings import SETTINGS

_CHANNELS = ("x", "y", "phi")


def find_events(problem: Problem, predicted: Array, plain: Array, ordinary: Index) -> tuple[Event, ...]:
    """Jumps of the residual that are far larger than in the other trials, largest first.

    Parameters
    ----------
    problem : Problem
        The trials.
    predicted : array (R, T, 3)
        Their poses by the final model.
    plain : array (R, T, 3)
        Their poses without effects.  A jump that only the effects make is their mistake: nothing happened.
    ordinary : array of int
        The trials whose jumps say what is ordinary.
    """
    jumps, without = (
        [_jumps_of(problem, i, poses[i]) for i in range(len(poses))] for poses in (predicted, plain)
    )
    found = []
    for number, (trial, jump) in enumerate(zip(problem.trials, jumps, strict=True)):
        usual = _ordinary([jumps[i] for i in ordinary if i != number] or jumps)
        for axis, channel in enumerate(_CHANNELS):
            size = np.nan_to_num(np.abs(jump[:, axis]))
            size[~(np.abs(without[number][:, axis]) >= SETTINGS.event_own * size)] = 0.0
            at = int(np.argmax(size))
            if size[at] > max(SETTINGS.event_sigmas, SETTINGS.event_ordinary * float(usual[axis])):
                found.append(
                    Event(
                        trial=trial.name,
                        t_s=float(trial.t_s[at]),
                        channel=channel,
                        size_sigma=float(size[at]),
                    )
                )
    return tuple(sorted(found, key=lambda e: -e.size_sigma))


def _ordinary(jumps: list[Array]) -> Array:
    pooled = np.concatenate([np.abs(j) for j in jumps])
    return np.nanquantile(pooled, 0.99, axis=0) if np.isfinite(pooled).any() else np.zeros(3)


def _jumps_of(problem: Problem, number: int, pose: Array) -> Array:
    """Jumps (T, 3) of what is measured of a trial over its predicted ``pose`` (≥ T, 3), over the noise."""
    trial = problem.trials[number]
    half = max(2, round(SETTINGS.event_span_s / max(1e-9, float(np.median(np.diff(trial.t_s))))))
    return _jumps((trial.pose - pose[: len(trial.t_s)]) / problem.sigma, half)


def _jumps(gap: Array, half: int) -> Array:
    """Mean of the next ``half`` samples minus mean of the last ``half``, (T, C), NaN at the ends."""
    out = np.full(gap.shape, np.nan)
    if len(gap) < 2 * half + 1:
        return out
    total = np.cumsum(np.vstack([np.zeros((1, gap.shape[1])), np.nan_to_num(gap)]), axis=0)
    count = np.cumsum(np.vstack([np.zeros((1, gap.shape[1])), np.isfinite(gap)]), axis=0)
    mean = (total[half:] - total[:-half]) / np.maximum(1.0, count[half:] - count[:-half])
    out[half:-half] = (mean[half:] - mean[:-half])[1:]
    return out


def cut_apart(
    records: Sequence[Record], events: Sequence[Event]
) -> tuple[tuple[Record, ...], tuple[int, ...]]:
    """The runs cut at their events, and of each part the number of the run it comes from."""
    parts: list[Record] = []
    runs: list[int] = []
    for number, record in enumerate(records):
        times = sorted(e.t_s for e in events if e.trial == record.name)
        for part in _parts(record, times) if times else (record,):
            parts.append(part)
            runs.append(number)
    return tuple(parts), tuple(runs)


def _parts(record: Record, times: list[float]) -> list[Record]:
    starts = [-np.inf, *(t + SETTINGS.event_span_s for t in times)]
    ends = [*(t - SETTINGS.event_span_s for t in times), np.inf]
    parts = []
    for start, end in zip(starts, ends, strict=True):
        rows = (record.t_s >= start) & (record.t_s <= end)
        if rows.sum() < 2 or np.ptp(record.t_s[rows]) < SETTINGS.least_part_s or not record.seen[rows].any():
            continue
        name = f"{record.name} ({record.t_s[rows][0]:.2f}–{record.t_s[rows][-1]:.2f} s)"
        parts.append(replace(record.part(rows), name=name))
    return parts
