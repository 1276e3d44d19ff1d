"""Make measured trials ready to compare: noise, outliers, start pose.

Nothing here knows a model; it only reads the pose as measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.data.record import Record

#: A sample farther than this many standard deviations from the line between its neighbours, and
#: from their median, is an outlier.
OUTLIER_SIGMA = 8.0


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trial:
    """A cleaned run: ``t_s`` (T,), ``pose`` (T, 3) with NaN where missing or an outlier.

    ``start`` (3,) is the pose at the first instant; ``dropped`` counts the outliers.
    """

    name: str
    t_s: Array
    pose: Array
    start: Array
    dropped: int
    record: Record

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", frozen("start", self.start, (3,)))


def noise(records: tuple[Record, ...]) -> Array:
    """Standard deviation (3,) of x [m], y [m], φ [rad], from neighbours that smooth motion cannot explain.

    Each sample is compared with the straight line between its neighbours; the spread of that
    difference is σ √(1 + w² + (1 − w)²), w the neighbour's weight.  The median makes it robust
    against outliers and against short hard accelerations.
    """
    parts = [np.abs(_against_neighbours(r.t_s, r.pose)) for r in records]
    found = np.empty(3)
    for axis in range(3):
        values = np.concatenate([p[:, axis] for p in parts])
        values = values[np.isfinite(values)]
        if not len(values):
            found[axis] = 1e-3
            continue
        spread = 1.4826 * float(np.median(values))
        if spread == 0.0:  # a coarse sensor repeats its value: its step is the noise
            steps = values[values > 0.0]
            spread = float(np.min(steps)) if len(steps) else 1e-6
        found[axis] = max(spread, 1e-9)
    return found


def _against_neighbours(t: Array, pose: Array) -> Array:
    """Each inner sample minus the line between its neighbours, per √(1 + w² + (1 − w)²)."""
    w = ((t[1:-1] - t[:-2]) / (t[2:] - t[:-2]))[:, None]
    line = pose[:-2] * (1.0 - w) + pose[2:] * w
    return np.asarray((pose[1:-1] - line) / np.sqrt(1.0 + w**2 + (1.0 - w) ** 2))


def clean(record: Record, sigma: Array) -> Trial:
    """A run without its outliers, and where it started."""
    pose = np.array(record.pose)
    lone = np.abs(_against_neighbours(record.t_s, pose)) > OUTLIER_SIGMA * sigma
    padded = np.pad(pose, ((2, 2), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 5, axis=0)
    middle = np.nanmedian(np.where(np.isfinite(windows), windows, np.nan), axis=-1) if len(pose) > 2 else pose
    travel = np.abs(np.gradient(middle, record.t_s, axis=0)) * np.median(np.diff(record.t_s))
    far = np.abs(pose - middle) > OUTLIER_SIGMA * sigma + 2.0 * np.nan_to_num(travel)
    bad = np.zeros(pose.shape, dtype=bool)
    bad[1:-1] = lone
    bad &= far
    pose[bad] = np.nan
    pose.setflags(write=False)
    return Trial(
        name=record.name,
        t_s=record.t_s,
        pose=pose,
        start=_start(record, pose, sigma),
        dropped=int(bad.sum()),
        record=record,
    )


def _start(record: Record, pose: Array, sigma: Array) -> Array:
    """Mean pose over the first half of the time in which it stands: no sample 4 σ from the mean so far."""
    first = np.array([col[np.isfinite(col)][0] if np.isfinite(col).any() else 0.0 for col in pose.T])
    seen = np.isfinite(pose)
    mean = first + np.cumsum(np.where(seen, pose - first, 0.0), axis=0) / np.maximum(
        1, np.cumsum(seen, axis=0)
    )
    moved = np.any(np.abs(pose - mean) > 4.0 * sigma, axis=1)
    still = int(np.argmax(moved)) if moved.any() else len(pose)
    head = pose[: max(1, still // 2)]
    middle = [np.nanmean(c) if np.isfinite(c).any() else f for c, f in zip(head.T, first, strict=True)]
    return np.array(middle)
