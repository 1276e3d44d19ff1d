"""Things that happened once: a bump, a lifted wheel, a camera that jumped.  Reported, not explained."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnose.diagnosis import Event
from slipmargin.diagnose.problem import Problem

#: Within how long an event happens [s].
_SPAN_S = 0.1
#: A jump of the residual must exceed both: so many standard deviations, and so many times the
#: largest ordinary jump (99th percentile over all trials).
_SIGMAS, _ORDINARY = 12.0, 4.0
_CHANNELS = ("x", "y", "phi")


def find_events(problem: Problem, predicted: Array) -> tuple[Event, ...]:
    """Jumps of the residual that stand out from everything else in these trials, largest first.

    Parameters
    ----------
    problem : Problem
        The trials.
    predicted : array (R, T, 3)
        Their poses by the final model.
    """
    jumps = []
    for trial, pose in zip(problem.trials, predicted, strict=True):
        gap = (trial.pose - pose[: len(trial.t_s)]) / problem.sigma
        half = max(2, round(_SPAN_S / max(1e-9, float(np.median(np.diff(trial.t_s))))))
        jumps.append(_jumps(gap, half))
    pooled = np.concatenate([np.abs(j) for j in jumps])
    ordinary = np.nanquantile(pooled, 0.99, axis=0) if np.isfinite(pooled).any() else np.zeros(3)
    found = []
    for trial, jump in zip(problem.trials, jumps, strict=True):
        for axis, channel in enumerate(_CHANNELS):
            size = np.nan_to_num(np.abs(jump[:, axis]))
            at = int(np.argmax(size))
            if size[at] > max(_SIGMAS, _ORDINARY * float(ordinary[axis])):
                found.append(
                    Event(
                        trial=trial.name,
                        t_s=float(trial.t_s[at]),
                        channel=channel,
                        size_sigma=float(size[at]),
                    )
                )
    return tuple(sorted(found, key=lambda e: -e.size_sigma))


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
