"""The measured pose as a function of the true one, by the measurement model."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.model.parts import MeasurementModel
from slipmargin.physics.frames import rotate_rows, to_floor
from slipmargin.physics.variables import Variable


def is_ideal(sensing: MeasurementModel) -> bool:
    """Whether the measurement model changes nothing."""
    return bool(
        np.all(sensing.scale == 1.0)
        and not sensing.rotation_rad
        and sensing.heading_gain == 1.0
        and not sensing.delay_s
        and not np.any(sensing.marker_m)
        and not sensing.warps
    )


def measure(sensing: MeasurementModel, t_s: Array, pose: Array) -> Array:
    """What the sensor reports of a motion.

    Parameters
    ----------
    sensing : MeasurementModel
        Faults of the measurement.
    t_s : array (T,)
        Instants since the run began [s], increasing.
    pose : array (T, 3)
        True x [m], y [m], φ [rad] of the body frame's origin.

    Returns
    -------
    array (T, 3)
        Measured pose at those instants; both scale and rotation act about the start position.
    """
    if is_ideal(sensing):
        return pose
    true = pose
    t_s = t_s * sensing.clock
    if sensing.delay_s:
        late = t_s - sensing.delay_s
        true = np.stack([np.interp(late, t_s, column) for column in pose.T], axis=1)
    start, phi = true[0], true[:, 2]
    seen = np.stack(to_floor(phi, *sensing.marker_m), axis=1)
    moved = true[:, :2] - start[:2] + seen - seen[0]
    out = np.empty_like(pose)
    out[:, :2] = start[:2] + sensing.scale * rotate_rows(sensing.rotation_rad, moved)
    out[:, 2] = start[2] + sensing.heading_gain * (phi - start[2])
    for warp in sensing.warps:
        shift = warp.shift(_variable(warp.variable, t_s, true))
        out += shift - shift[0]
    return np.asarray(out, dtype=np.float64)


def _variable(variable: Variable, t_s: Array, pose: Array) -> Array:
    column = {Variable.POSITION_X: 0, Variable.POSITION_Y: 1, Variable.HEADING: 2}
    if variable is Variable.TIME:
        return np.asarray(t_s, dtype=np.float64)
    if variable is Variable.UNITY:
        return np.ones(len(t_s))
    if variable is Variable.SPEED:
        return np.asarray(np.hypot(*np.gradient(pose[:, :2], t_s, axis=0).T))
    if variable is Variable.YAW_RATE:
        return np.asarray(np.gradient(pose[:, 2], t_s))
    if variable not in column:
        raise InputError(
            "variable",
            f"a pose measurement cannot depend on {variable.name.lower()}",
            "use position_x, position_y, heading, speed, yaw_rate or time",
        )
    return np.asarray(pose[:, column[variable]], dtype=np.float64)
