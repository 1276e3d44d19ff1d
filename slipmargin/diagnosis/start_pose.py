"""Where a run may start: predictions moved to where their start fits best, and the whitened gap left.

The noise of a channel is white noise plus noise of first order (Ornstein-Uhlenbeck: it fades by 1/e in its
time).  A Kalman filter predicts the lasting part from the samples before; what a sample adds to that, over
its standard deviation, is independent of all others (the innovations form; Harvey, Forecasting, Structural
Time Series Models and the Kalman Filter, 1989, section 3.4).  The filter is linear: the gap and the
directions in which a start may move, which are projected off it, pass through the same one.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.physics.compiled import fast
from slipmargin.physics.frames import to_floor

#: What a direction that nothing was seen of is held by, as a share of the others, and beside nothing [1].
_HELD, _LEAST = 1e-12, 1e-30


def aligned(pose: Array, measured: Array, seen: NDArray[np.bool_]) -> Array:
    """Each piece rotated about its first point by the mean difference of heading, then moved likewise."""
    known = seen[..., 2]
    off = np.sum(np.where(known, measured[..., 2] - pose[..., 2], 0.0), axis=1)
    off = off / np.maximum(1, known.sum(axis=1))
    arm = pose[..., :2] - pose[:, :1, :2]
    place = np.stack(to_floor(off[:, None], arm[..., 0], arm[..., 1]), axis=-1)
    middle = np.sum(np.where(seen[..., :2], measured[..., :2] - place, 0.0), axis=1) / np.maximum(
        1, seen[..., :2].sum(axis=1)
    )
    return np.concatenate([place + middle[:, None], pose[..., 2:] + off[:, None, None]], axis=-1)


def fitted_start(
    pose: Array,
    measured: Array,
    seen: NDArray[np.bool_],
    sigma: Array,
    lasting: LastingNoise | None = None,
    step_s: float = 0.0,
) -> tuple[Array, Array]:
    """Predicted poses moved to where their start fits best, and the whitened gap left.

    Parameters
    ----------
    pose, measured : array (M, T, 3)
        x [m], y [m], φ [rad] of M runs, a sample every ``step_s``.
    seen : array (M, T, 3) of bool
        Which samples exist.
    sigma : array (3,)
        Standard deviation of the whole noise.
    lasting : LastingNoise, optional
        The part of it that lasts; none by default.

    Returns
    -------
    array (M, T, 3), array (M, T, 3)
        Poses, and measured − pose in noises: 0 where nothing was seen, at most ``SETTINGS.wild`` large.
    """
    share = np.zeros(3) if lasting is None else lasting.share
    keep = np.zeros(3) if lasting is None else np.exp(-step_s / lasting.time_s)
    moved, left = np.empty((2, *pose.shape))
    row = np.ascontiguousarray  # other layouts would be compiled once more
    _fit_starts(row(pose), row(measured), row(seen), sigma, share, keep, float(SETTINGS.wild), moved, left)
    return moved, left


@fast
def _fit_starts(
    pose: Array,
    measured: Array,
    seen: NDArray[np.bool_],
    sigma: Array,
    share: Array,
    keep: Array,
    wild: float,
    moved: Array,
    left: Array,
) -> None:
    """Fill ``moved`` and ``left`` (M, T, 3).

    To first order a start moves a run by (1, 0, 0), (0, 1, 0) and, turned by 1 rad, (−b, a, 1) at (a, b)
    from it.  Shifts along x and y do not meet, so that the normal equations are solved by hand.
    """
    ways = np.empty((pose.shape[1], 3, 2))  # whitened: along the axis, turned
    for m in range(len(pose)):
        x, y = pose[m, 0, 0], pose[m, 0, 1]
        x, y = x if math.isfinite(x) else 0.0, y if math.isfinite(y) else 0.0
        own, both, right = np.zeros(3), np.zeros(2), np.zeros(3)
        for axis in range(3):
            lasting = share[axis] * sigma[axis] ** 2
            white = sigma[axis] ** 2 - lasting
            spread, of_gap, of_one, of_turn = lasting, 0.0, 0.0, 0.0  # of the lasting part, as predicted
            for k in range(pose.shape[1]):
                left[m, k, axis], ways[k, axis, 0], ways[k, axis, 1] = 0.0, 0.0, 0.0
                if seen[m, k, axis]:
                    gap = measured[m, k, axis] - pose[m, k, axis]
                    gap = gap if math.isfinite(gap) else wild * sigma[axis]
                    arm = (y - pose[m, k, 1], pose[m, k, 0] - x, 1.0)[axis]
                    new, one = gap - of_gap, 1.0 - of_one
                    turn = (arm if math.isfinite(arm) else 0.0) - of_turn
                    root, gain = math.sqrt(spread + white), spread / (spread + white)
                    of_gap, of_one, of_turn = of_gap + gain * new, of_one + gain * one, of_turn + gain * turn
                    spread *= 1.0 - gain
                    new, one, turn = new / root, one / root, turn / root
                    left[m, k, axis], ways[k, axis, 0], ways[k, axis, 1] = new, one, turn
                    if axis < 2:
                        own[axis] += one * one
                        both[axis] += one * turn
                        right[axis] += one * new
                    own[2] += turn * turn
                    right[2] += turn * new
                of_gap, of_one, of_turn = keep[axis] * of_gap, keep[axis] * of_one, keep[axis] * of_turn
                spread = keep[axis] ** 2 * spread + (1.0 - keep[axis] ** 2) * lasting
        own += _HELD * (own[0] + own[1] + own[2]) + _LEAST
        by = both / own[:2]
        turned = (right[2] - by[0] * right[0] - by[1] * right[1]) / (
            own[2] - by[0] * both[0] - by[1] * both[1]
        )
        shift = (right[:2] - both * turned) / own[:2]
        for k in range(pose.shape[1]):
            a, b = pose[m, k, 0] - x, pose[m, k, 1] - y
            a, b = a if math.isfinite(a) else 0.0, b if math.isfinite(b) else 0.0
            moved[m, k, 0] = pose[m, k, 0] + shift[0] - turned * b
            moved[m, k, 1] = pose[m, k, 1] + shift[1] + turned * a
            moved[m, k, 2] = pose[m, k, 2] + turned
            for axis in range(3):
                way = ways[k, axis, 1] * turned
                if axis < 2:
                    way += ways[k, axis, 0] * shift[axis]
                left[m, k, axis] = min(max(left[m, k, axis] - way, -wild), wild)
