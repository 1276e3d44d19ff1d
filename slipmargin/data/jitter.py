"""How much the instants of camera frames differ from their rows' times, read from the measured poses alone.

A frame that is early or late by δ is off by δ v along the motion and not across it.  The samples' distances
from the cubic through their neighbours therefore have a larger variance along the motion than across, by
δ² v², which a regression over all samples tells from noise that is the same in both directions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.odometry import bridged
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS

#: The cubic through the two neighbours on each side, in equal steps: its weights at the sample.
_NEIGHBOURS = np.array([-1.0, 4.0, 0.0, 4.0, -1.0]) / 6.0


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Jitter:
    """Standard deviation [s] of a frame's instant about its row's time, with a 95 % interval over runs."""

    value_s: float
    low_s: float
    high_s: float

    @property
    def sentence(self) -> str:
        """What it says."""
        return (
            f"Camera frames come {1e3 * self.value_s:.2g} ms "
            f"({1e3 * self.low_s:.2g} … {1e3 * self.high_s:.2g}) before or after the times of their rows "
            "(one standard deviation)."
        )


def jitter(records: tuple[Record, ...]) -> Jitter | None:
    """The jitter of the frames; None where fewer than three runs move."""
    parts = [p for r in records if (p := _sums(r)) is not None]
    if len(parts) < 3:
        return None
    from scipy.special import stdtrit

    top, bottom = np.array(parts).T
    count = len(parts)
    value = top.sum() / bottom.sum()
    without = (top.sum() - top) / (bottom.sum() - bottom)
    spread = np.sqrt((count - 1) / count * np.sum((without - without.mean()) ** 2))
    half = float(stdtrit(count - 1, 0.5 * (1.0 + SETTINGS.sure))) * spread
    low, middle, high = (float(np.sqrt(max(0.0, v))) for v in (value - half, value, value + half))
    return Jitter(value_s=middle, low_s=low, high_s=high)


def _sums(record: Record) -> tuple[float, float] | None:
    """Σ v² (along² − across²) and Σ v⁴ over the samples of a run that move [m⁴/s², m⁴/s⁴]."""
    place = record.pose[:, :2]
    if len(place) < 9:
        return None
    misses = place[2:-2] - np.stack([np.convolve(c, _NEIGHBOURS, "valid") for c in place.T], axis=1)
    misses = misses / np.sqrt(1.0 + np.sum(_NEIGHBOURS**2))
    path = bridged(record.t_s, place)
    velocity = (path[4:] - path[:-4]) / (record.t_s[4:] - record.t_s[:-4])[:, None]
    speed = np.hypot(*velocity.T)
    even = np.ptp(
        np.lib.stride_tricks.sliding_window_view(np.diff(record.t_s), 4), axis=1
    ) < 1e-3 * np.median(np.diff(record.t_s))
    rows = even & np.isfinite(misses).all(axis=1) & (speed > SETTINGS.jitter_moves * np.nanmax(speed))
    if rows.sum() < 20:
        return None
    unit = velocity[rows] / speed[rows, None]
    along: Array = np.sum(misses[rows] * unit, axis=1)
    across: Array = misses[rows, 1] * unit[:, 0] - misses[rows, 0] * unit[:, 1]
    square = speed[rows] ** 2
    return float(np.sum(square * (along**2 - across**2))), float(np.sum(square**2))
