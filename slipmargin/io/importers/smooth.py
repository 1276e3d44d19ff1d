"""Wheel angles whose time stamps tremble, made smooth."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array


def smooth_angles(t: Array, theta: Array, window_s: float) -> tuple[Array, Array]:
    """Angle and speed by a parabola fitted to the neighbourhood of every sample.

    A bus that hands out an encoder value up to one cycle old makes the wheel seem to jerk from row to
    row.  A slip law turns such jerks, which never happened, into slip; averaging over several cycles
    takes them away.

    Parameters
    ----------
    t : array (T,)
        Time stamps [s], ascending, irregular.
    theta : array (T, N)
        Wheel angles [rad], none missing.
    window_s : float
        Half width of the neighbourhood [s], weighted (1 − |Δt/window|³)³.

    Returns
    -------
    (array (T, N), array (T, N))
        Angles [rad] and speeds [rad/s]; where fewer than four neighbours are near, the angle itself
        and the difference to the next sample.
    """
    usual = float(np.median(np.diff(t)))
    reach = max(2, int(np.ceil(window_s / usual)) + 1)
    index = np.arange(len(t))[:, None] + np.arange(-reach, reach + 1)[None, :]
    inside = (index >= 0) & (index < len(t))
    index = np.clip(index, 0, len(t) - 1)
    off = (t[index] - t[:, None]) / window_s
    weight = np.where(inside & (np.abs(off) < 1.0), (1.0 - np.minimum(np.abs(off), 1.0) ** 3) ** 3, 0.0)
    powers = np.stack([np.ones_like(off), off, off**2], axis=-1)  # (T, K, 3)
    normal = np.einsum("tk,tki,tkj->tij", weight, powers, powers)
    right = np.einsum("tk,tki,tkn->tin", weight, powers, theta[index] - theta[:, None, :])
    known = np.count_nonzero(weight > 1e-6, axis=1) >= 4
    normal[~known] = np.eye(3)
    fit = np.linalg.solve(normal, right)
    speed = fit[:, 1] / window_s
    speed[~known] = np.gradient(theta, t, axis=0)[~known]
    angle = theta + np.where(known[:, None], fit[:, 0], 0.0)
    return np.asarray(angle), np.asarray(speed)
