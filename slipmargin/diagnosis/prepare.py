"""Make measured trials ready to compare: outliers, start pose.

Nothing here knows a model; it only reads the pose as measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen
from slipmargin.data.record import Record
from slipmargin.diagnosis.settings import SETTINGS


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trial:
    """A cleaned run: ``t_s`` (T,), ``pose`` (T, 3) with NaN where missing or an outlier.

    ``start`` (3,) is the pose at the first instant; ``dropped`` counts the numbers that were outliers.
    """

    name: str
    t_s: Array
    pose: Array
    start: Array
    dropped: int
    record: Record

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", frozen("start", self.start, (3,)))


def clean(record: Record, sigma: Array) -> Trial:
    """A run without the poses that are outliers in one number or more, and where it started."""
    pose = np.array(record.pose)
    bad = np.zeros(pose.shape, dtype=bool)
    for axis in range(3):
        known = np.flatnonzero(np.isfinite(pose[:, axis]))
        if len(known) > 2:
            bad[known, axis] = _outlying(record.t_s[known], pose[known, axis], float(sigma[axis]))
    pose[bad.any(axis=1)] = np.nan  # a camera that errs in one number has erred
    pose.setflags(write=False)
    return Trial(
        name=record.name,
        t_s=record.t_s,
        pose=pose,
        start=_start(record, pose, sigma),
        dropped=int(bad.sum()),
        record=record,
    )


def _outlying(t: Array, values: Array, sigma: float) -> NDArray[np.bool_]:
    """Which samples (T,) are far both from the line between their neighbours and from the middle of five."""
    w = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    line = values[:-2] * (1.0 - w) + values[2:] * w
    lone = np.zeros(len(values), dtype=bool)
    far = SETTINGS.outlier_sigma * sigma
    lone[1:-1] = np.abs(values[1:-1] - line) > far * np.sqrt(1.0 + w**2 + (1.0 - w) ** 2)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(values, 2, mode="edge"), 5)
    middle = np.median(windows, axis=1)
    travel = np.abs(np.gradient(middle, t)) * np.median(np.diff(t))
    return np.asarray(lone & (np.abs(values - middle) > far + 2.0 * travel))


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
