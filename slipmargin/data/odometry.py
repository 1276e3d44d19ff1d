"""What the wheels alone would say of a run, and what the camera says, in one frame: the body's.

Displacements in the body frame (increments turned by the heading that was measured) do not charge a
heading error twice, once as itself and once as a displacement.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.frames import rotate_rows
from slipmargin.physics.kinematics import WheelGeometry, integrated


def wheel_path(contacts: WheelGeometry, theta: Array) -> Array:
    """(T, 3) path in the body frame by the wheels alone: x [m], y [m], φ [rad], zero at the start.

    ``theta`` (T, N) wheel angles [rad].
    """
    return np.asarray((theta - theta[0]) @ contacts.no_slip_map().T)


def body_path(pose: Array) -> Array:
    """(T, 3) path in the body frame by the measured pose, zero at the start; missing rows are bridged."""
    whole = bridged(np.arange(len(pose), dtype=float), pose)
    step = np.diff(whole, axis=0)
    middle = whole[:-1, 2] + 0.5 * step[:, 2]
    return np.vstack([np.zeros(3), np.cumsum(rotate_rows(middle, step, inverse=True), axis=0)])


def driven_m(path: Array, noise_m: float) -> float:
    """Length [m] of the fewest chords that a path (T, 2) leaves by no more than the noise.

    Noise adds nothing to it: a straight path is one chord, however long the robot stands on the way.
    """
    total, parts = 0.0, [path]
    while parts:
        part = parts.pop()
        off, way = part - part[0], part[-1] - part[0]
        length = float(np.hypot(*way))
        along = np.clip(off @ way / max(length**2, 1e-300), 0.0, 1.0)
        far = np.hypot(*(off - along[:, None] * way).T)
        k = int(np.argmax(far))
        if far[k] <= noise_m:
            total += length
        else:
            parts += [part[: k + 1], part[k:]]
    return total


def bridged(t: Array, values: Array) -> Array:
    """``values`` (T, C) with missing samples on the line between their neighbours; all-NaN stays NaN."""
    out = np.array(values, dtype=float)
    for column in out.T:
        known = np.isfinite(column)
        if known.any() and not known.all():
            column[~known] = np.interp(t[~known], t[known], column[known])
    return out


def body_velocity(t_s: Array, pose: Array, half: int) -> Array:
    """Velocity (T − 2 half, 3) in the body's axes by a pose (T, 3), over ``half`` samples to either side."""
    rate = (pose[2 * half :] - pose[: -2 * half]) / (t_s[2 * half :] - t_s[: -2 * half])[:, None]
    return rotate_rows(pose[half:-half, 2], rate, inverse=True)


def wheel_angles(t: Array, theta: Array | None, omega: Array | None) -> Array | None:
    """(T, N) wheel angles: as measured, or by the trapezoidal rule from measured speeds, or None."""
    if theta is not None and np.isfinite(theta).any(axis=0).all():
        return bridged(t, theta)
    if omega is None or not np.isfinite(omega).any(axis=0).all():
        return None
    return integrated(t, bridged(t, omega))
