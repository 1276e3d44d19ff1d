"""The measured pose as a function of the true one, by the measurement model, and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.model.parts import MeasurementModel
from slipmargin.physics.frames import rotate_rows, to_floor
from slipmargin.physics.variables import Variable

#: Newton steps that undo a lens; and how far off [m] the last of them may be.
_STEPS, _MISSED_M = 30, 1e-9


def is_ideal(sensing: MeasurementModel) -> bool:
    """Whether the measurement model changes nothing."""
    return bool(
        np.all(sensing.scale == 1.0)
        and not sensing.rotation_rad
        and sensing.heading_gain == 1.0
        and not sensing.delay_s
        and not np.any(sensing.marker_m)
        and not sensing.warps
        and not any(lens.bend_per_m2 for lens in sensing.lenses)
    )


def measure(sensing: MeasurementModel, times_s: Sequence[Array], pose: Array) -> Array:
    """What the sensor reports of motions.

    Parameters
    ----------
    sensing : MeasurementModel
        Faults of the measurement.
    times_s : sequence of M arrays
        Instants of each motion since its run began [s], increasing; none after T.
    pose : array (M, T, 3)
        True x [m], y [m], φ [rad] of the body frame's origin, at these instants and anything after them.

    Returns
    -------
    array (M, T, 3)
        Measured poses at those instants; both scale and rotation act about the start position.
    """
    if is_ideal(sensing):
        return pose
    true, own = np.array(pose, dtype=np.float64), [t_s * sensing.clock for t_s in times_s]
    if sensing.delay_s:
        for row, t_s in zip(true, own, strict=True):
            late_s = t_s - sensing.delay_s
            row[: len(t_s)] = np.stack([np.interp(late_s, t_s, c) for c in row[: len(t_s)].T], axis=1)
    start, phi = true[:, :1], true[..., 2]
    seen = np.stack(to_floor(phi, *sensing.marker_m), axis=-1)
    moved = true[..., :2] - start[..., :2] + seen - seen[:, :1]
    out = np.empty_like(true)
    out[..., :2] = start[..., :2] + sensing.scale * rotate_rows(sensing.rotation_rad, moved)
    out[..., 2] = start[..., 2] + sensing.heading_gain * (phi - start[..., 2])
    bent = _bent(sensing, true[..., :2])
    out[..., :2] += bent - bent[:, :1]
    for warp in sensing.warps:
        for measured, row, t_s in zip(out, true, own, strict=True):
            shift = warp.shift(_variable(warp.variable, t_s, row[: len(t_s)]))
            measured[: len(t_s)] += shift - shift[0]
    return out


def true_pose(sensing: MeasurementModel, t_s: Array, pose: Array) -> Array:
    """The motion (T, 3) of which a sensor reports ``pose`` (T, 3) at ``t_s`` (T,): :func:`measure` undone.

    It begins where the report begins; NaN at instants of which the sensor reports before or after the run.

    Raises
    ------
    InputError
        For a clock that is off and for a general form, which depends on what is sought.
    """
    if sensing.warps or sensing.clock != 1.0:
        problem = "a clock or a general form of the measurement cannot be undone"
        raise InputError("effect", problem, "correct the runs by it and remove the effect")
    if is_ideal(sensing):
        return pose
    out = np.array(pose, dtype=np.float64)
    if sensing.delay_s:
        columns = [np.interp(t_s + sensing.delay_s, t_s, c, left=np.nan, right=np.nan) for c in out.T]
        out = np.column_stack(columns)
    start = pose[np.argmax(np.isfinite(pose).all(axis=1))]
    out[:, 2] = start[2] + (out[:, 2] - start[2]) / sensing.heading_gain
    seen = np.stack(to_floor(out[:, 2], *sensing.marker_m), axis=-1)
    seen -= np.stack(to_floor(start[2], *sensing.marker_m))
    moved = rotate_rows(-sensing.rotation_rad, (out[:, :2] - start[:2]) / sensing.scale)
    straight = start[:2] + moved - seen
    out[:, :2] = _straightened(sensing, start[:2], seen, out[:, :2], straight) if sensing.lenses else straight
    return out


def _straightened(
    sensing: MeasurementModel, start: Array, seen: Array, reported: Array, there: Array
) -> Array:
    """Positions (T, 2) that are ``reported`` through lenses, from guesses ``there``."""
    turned = np.stack([rotate_rows(sensing.rotation_rad, way) for way in np.eye(2)], axis=1)
    miss = np.full_like(there, np.inf)
    for _ in range(_STEPS):
        moved = sensing.scale * rotate_rows(sensing.rotation_rad, there - start + seen)
        miss = start + moved + _bent(sensing, there) - _bent(sensing, start) - reported
        slope = sensing.scale[:, None] * turned + sum(lens.slope(there) for lens in sensing.lenses)
        there = there - np.linalg.solve(slope, miss[..., None])[..., 0]
    if np.nanmax(np.abs(miss), initial=0.0) > _MISSED_M:
        raise InputError(
            "effect", "a lens that bends so much shows two places at one point", "correct the runs by hand"
        )
    return there


def _bent(sensing: MeasurementModel, position: Array) -> Array:
    """How far off (..., 2) lenses show positions [m]."""
    return np.asarray(sum((lens.shift(position) for lens in sensing.lenses), np.zeros_like(position)))


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
