"""The variables of each sample and their ranges, computed from the measured motion."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.odometry import bridged
from slipmargin.diagnosis.forms import Ranges
from slipmargin.diagnosis.prepare import Trial
from slipmargin.model import Model
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import to_body
from slipmargin.physics.sectors import pitch

#: Over how long the measured pose is differentiated [s].
_SPAN_S = 0.08
#: Share of the samples [1] that a range covers: the last few may be mistakes.
_MOST = 0.98


def motion_of(trial: Trial, convention: Convention = Convention.PAPER) -> dict[str, Array]:
    """Measured pose without gaps, velocity and acceleration in the body frame, each (T,)."""
    t = trial.t_s
    pose = _filled(t, trial.pose)
    velocity = _slope(t, pose)
    phi = pose[:, 2]
    right, forward = convention.right_forward(*to_body(phi, velocity[:, 0], velocity[:, 1]))
    change = _slope(t, velocity)
    push_right, push_forward = convention.right_forward(*to_body(phi, change[:, 0], change[:, 1]))
    return {
        "time": trial.record.since_s,
        "position x": pose[:, 0],
        "position y": pose[:, 1],
        "heading": np.mod(phi, 2.0 * np.pi),
        "velocity right": right,
        "velocity forward": forward,
        "yaw rate": velocity[:, 2],
        "speed": np.hypot(right, forward),
        "acceleration right": push_right,
        "acceleration forward": push_forward,
    }


def variables_of(trial: Trial, model: Model) -> dict[str, Array]:
    """Every variable a residual is compared with: the motion's and each wheel's, each (T,)."""
    found = motion_of(trial, model.convention)
    record = trial.record
    speeds = record.omega if record.omega is not None else record.omega_cmd
    for i, name in enumerate(model.geometry.names):
        if record.theta is not None:
            angle = _filled(trial.t_s, record.theta)[:, i]
            found[f"wheel angle {name}"] = np.mod(angle, pitch(float(model.grip.rollers[i])))
        if speeds is not None:
            found[f"wheel speed {name}"] = _filled(trial.t_s, speeds)[:, i]
    return found


def ranges(trials: tuple[Trial, ...]) -> Ranges:
    """The reach of these trials; never zero, so that every basis has a scale."""
    motions = [motion_of(t) for t in trials]
    place = np.concatenate([np.column_stack([m["position x"], m["position y"]]) for m in motions])
    middle = np.quantile(place, [1.0 - _MOST, _MOST], axis=0).mean(axis=0)

    def reach(*names: str) -> float:
        return float(np.quantile(np.abs(np.concatenate([m[n] for m in motions for n in names])), _MOST))

    speed = max(reach("speed"), 1e-2)
    commands = [t.record.omega_cmd if t.record.omega_cmd is not None else t.record.omega for t in trials]
    fastest = max((float(np.nanmax(np.abs(c))) for c in commands if c is not None), default=1.0)
    return Ranges(
        speed_m_s=speed,
        slip_m_s=0.5 * speed,
        acceleration_m_s2=max(reach("acceleration right", "acceleration forward"), 1e-1),
        yaw_rate_rad_s=max(reach("yaw rate"), 1e-1),
        position_m=max(float(np.quantile(np.abs(place - middle), _MOST)), 5e-2),
        middle_m=(float(middle[0]), float(middle[1])),
        duration_s=max(float(t.record.since_s[-1]) for t in trials),
        command_rad_s=max(fastest, 1.0),
    )


def _filled(t: Array, values: Array) -> Array:
    """``values`` (T, C) with missing samples interpolated; a column that was never seen is zero."""
    return np.nan_to_num(bridged(t, values))


def _slope(t: Array, values: Array) -> Array:
    """Central difference over about :data:`_SPAN_S`, (T, C)."""
    half = max(1, round(_SPAN_S / 2.0 / max(1e-9, float(np.median(np.diff(t))))))
    index = np.arange(len(t))
    low, high = np.maximum(index - half, 0), np.minimum(index + half, len(t) - 1)
    return np.asarray((values[high] - values[low]) / (t[high] - t[low])[:, None])
