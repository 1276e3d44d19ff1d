"""Where a run may start: predictions moved to where their start fits best, and the whitened gap left."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.whitening import whitened
from slipmargin.physics.frames import to_floor


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


def fitted_start(pose: Array, measured: Array, seen: NDArray[np.bool_], sigma: Array) -> tuple[Array, Array]:
    """Predicted poses (M, T, 3) moved to where the start fits best, and the whitened gap left."""
    gap = np.where(seen, measured - pose, 0.0)
    gap = np.where(np.isfinite(gap), gap, SETTINGS.wild * sigma)
    shift = _start_shift(pose, gap, seen, sigma)
    return pose + shift, np.where(seen, (gap - shift) / sigma, 0.0).clip(-SETTINGS.wild, SETTINGS.wild)


def fitted_to_lasting(
    pose: Array,
    measured: Array,
    seen: NDArray[np.bool_],
    sigma: Array,
    lasting: LastingNoise,
    step_s: float,
) -> tuple[Array, Array]:
    """As :func:`fitted_start` where part of the noise lasts: gap and tangents pass through one filter."""
    gap = np.where(seen, measured - pose, 0.0)
    gap = np.where(np.isfinite(gap), gap, SETTINGS.wild * sigma)
    first = np.where(np.isfinite(pose[:, :1, :2]), pose[:, :1, :2], 0.0)
    arm = np.where(np.isfinite(pose[..., :2]), pose[..., :2], 0.0) - first
    one = np.ones(seen.shape[:2])
    turning = (-arm[..., 1], arm[..., 0], one)

    def white(values: Array, axis: int) -> Array:
        return whitened(values, seen[..., axis], float(sigma[axis]), lasting, axis, step_s)

    left = np.stack([white(gap[..., axis], axis) for axis in range(3)], axis=-1)
    tangents = np.zeros((*left.shape, 3))
    for axis in range(3):
        tangents[..., axis, 2] = white(turning[axis], axis)
        if axis < 2:
            tangents[..., axis, axis] = white(one, axis)
    rows = tangents.reshape(len(pose), -1, 3)
    across = rows.transpose(0, 2, 1)
    normal = across @ rows
    normal += (1e-12 * np.trace(normal, axis1=1, axis2=2) + 1e-30)[:, None, None] * np.eye(3)
    found = np.linalg.solve(normal, across @ left.reshape(len(pose), -1, 1))
    x, y, turn = found[..., 0].T[..., None]
    shift = np.stack([x + turn * turning[0], y + turn * turning[1], turn * one], axis=-1)
    left = left - (rows @ found).reshape(left.shape)
    return pose + shift, np.where(seen, left, 0.0).clip(-SETTINGS.wild, SETTINGS.wild)


def _start_shift(pose: Array, gap: Array, seen: NDArray[np.bool_], sigma: Array) -> Array:
    """The change (M, T, 3) of each prediction by the start shift and turn that fit it best.

    The tangents of a shift are (1, 0, 0) and (0, 1, 0), that of a turn is (−b, a, 1) at (a, b) from
    the start; the 3 × 3 normal equations are written out.
    """
    first = np.where(np.isfinite(pose[:, :1, :2]), pose[:, :1, :2], 0.0)
    arm = np.where(np.isfinite(pose[..., :2]), pose[..., :2], 0.0) - first
    a, b = arm[..., 0], arm[..., 1]
    wx, wy, wt = (seen[..., i] / sigma[i] ** 2 for i in range(3))
    xb, ya = wx * b, wy * a
    normal = np.zeros((len(pose), 3, 3))
    normal[:, 0, 0], normal[:, 1, 1] = wx.sum(axis=1), wy.sum(axis=1)
    normal[:, 0, 2] = normal[:, 2, 0] = -xb.sum(axis=1)
    normal[:, 1, 2] = normal[:, 2, 1] = ya.sum(axis=1)
    normal[:, 2, 2] = (xb * b + ya * a + wt).sum(axis=1)
    gx, gy, gt = gap[..., 0], gap[..., 1], gap[..., 2]
    right = np.stack(
        [(wx * gx).sum(axis=1), (wy * gy).sum(axis=1), (ya * gy - xb * gx + wt * gt).sum(axis=1)], axis=1
    )
    normal += (1e-12 * np.trace(normal, axis1=1, axis2=2) + 1e-30)[:, None, None] * np.eye(3)
    shift = np.linalg.solve(normal, right[..., None])
    turn = shift[:, 2]
    return np.stack([shift[:, 0] - turn * b, shift[:, 1] + turn * a, np.broadcast_to(turn, a.shape)], axis=-1)
