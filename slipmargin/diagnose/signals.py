"""The wheels' motion of a trial, rebuilt from what was logged."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnose.prepare import Trial
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.sim.signal import WheelSignal, angles, held, hermite, linear


class Way(Enum):
    """How the motion between samples is rebuilt; where two ways differ, the log does not say."""

    THIN = "through as few samples as reproduce the rest: for searching"
    FULL = "through every sample: for the final numbers"
    OTHER = "as somebody else might: angles alone, or speeds held from row to row"


def wheel_signal(trial: Trial, commanded: bool, way: Way = Way.THIN) -> WheelSignal:
    """Wheel angles over time: cubic between samples where angle and speed are known.

    Missing samples are bridged by their neighbours.  Without logged angles the rotor angles start at
    zero, which matters only to effects of the wheel angle (:mod:`~slipmargin.diagnose.rotor`).
    """
    record = trial.record
    t = record.t_s
    if commanded:
        if record.omega_cmd is None:
            raise InputError(trial.name, "has no commanded wheel speeds", "add omega{i}_cmd_rad_s")
        return _by_speed(t, _bridged(t, record.omega_cmd), way)
    if record.theta is not None and np.isfinite(record.theta).any(axis=0).all():
        theta = _bridged(t, record.theta)
        if way is not Way.OTHER and record.omega is not None and np.isfinite(record.omega).any(axis=0).all():
            omega = _bridged(t, record.omega)
            return _thinned(t, theta, omega) if way is Way.THIN else hermite(t, theta, omega)
        return angles(t, theta)
    if record.omega is None:
        raise InputError(trial.name, "has no measured wheel speeds", "add omega{i}_rad_s or theta{i}_rad")
    return _by_speed(t, _bridged(t, record.omega), way)


def turned(signal: WheelSignal, angle: Array) -> WheelSignal:
    """The same motion with ``angle`` (N,) added to the wheel angles [rad]."""
    if not angle.any():
        return signal
    pieces = signal.pieces.copy()
    pieces[:, :, 0] += angle
    return replace(signal, pieces=pieces)


def _by_speed(t: Array, omega: Array, way: Way) -> WheelSignal:
    return held(t, omega) if way is Way.OTHER else linear(t, omega)


#: A sample is left out where the cubic through its neighbours meets it this closely [rad], [rad/s] …
_SAME = (2e-5, 4e-3)
#: … or as closely as angles and speeds agree with themselves, but never less closely than this.
_LOOSEST = (2e-3, 0.1)
_LONGEST = 32


def _thinned(t: Array, theta: Array, omega: Array) -> WheelSignal:
    """The cubic through as few samples as reproduce all the others: the integrator stops at each."""
    same = _trust(t, theta, omega)
    keep = [0]
    last = len(t) - 1
    while keep[-1] < last:
        start, span = keep[-1], 1
        while start + 2 * span <= last and span < _LONGEST:
            inside = slice(start, start + 2 * span + 1)
            angle, speed = _misses(t[inside], theta[inside], omega[inside])
            if np.max(np.abs(angle)) >= same[0] or np.max(np.abs(speed)) >= same[1]:
                break
            span *= 2
        keep.append(min(start + span, last))
    return hermite(t[keep], theta[keep], omega[keep])


def _trust(t: Array, theta: Array, omega: Array) -> tuple[float, float]:
    """How closely angles [rad] and speeds [rad/s] are to be met: to three times their own noise.

    The noise is what a sample misses the cubic through its neighbours by, where that changes from one
    sample to the next: in a smooth motion, however fast, it does not.
    """
    if len(t) < 5:
        return _SAME
    misses = [_misses(t[k : k + 3], theta[k : k + 3], omega[k : k + 3]) for k in range(len(t) - 2)]
    found = []
    for axis in range(2):
        change = np.diff(np.concatenate([m[axis] for m in misses]), n=2, axis=0)
        noise = 1.5 * float(np.median(np.max(np.abs(change), axis=1)))
        found.append(min(max(_SAME[axis], 3.0 * noise), _LOOSEST[axis]))
    return found[0], found[1]


def _misses(t: Array, theta: Array, omega: Array) -> tuple[Array, Array]:
    """What the cubic from the first to the last sample misses those between by: (T − 2, N) each."""
    h = t[-1] - t[0]
    u = ((t[1:-1] - t[0]) / h)[:, None]
    th0, th1, w0, w1 = theta[0], theta[-1], omega[0] * h, omega[-1] * h
    angle = (
        (1 + 2 * u) * (1 - u) ** 2 * th0
        + u * (1 - u) ** 2 * w0
        + u**2 * (3 - 2 * u) * th1
        + u**2 * (u - 1) * w1
    )
    speed = (6 * u * (u - 1) * (th0 - th1) + (3 * u - 1) * (u - 1) * w0 + u * (3 * u - 2) * w1) / h
    return angle - theta[1:-1], speed - omega[1:-1]


def _bridged(t: Array, values: Array) -> Array:
    """``values`` (T, N) with missing samples on the line between their neighbours."""
    if np.isfinite(values).all():
        return values
    columns = []
    for column in values.T:
        known = np.isfinite(column)
        columns.append(np.interp(t, t[known], column[known]))
    return np.stack(columns, axis=1)


def rolling_twist(model: Model, trial: Trial, signal: WheelSignal) -> Array:
    """Floor-frame velocity (3,) that the wheels' first speeds make without slip [m/s, m/s, rad/s]."""
    contacts = model.geometry
    arm, grip = contacts.position_m, contacts.grip
    rows = np.column_stack([grip, arm[:, 0] * grip[:, 1] - arm[:, 1] * grip[:, 0]])
    along = contacts.radius_m * np.sum(contacts.drive * grip, axis=1)
    body = -np.linalg.pinv(rows) @ (along * signal.pieces[0, :, 1])
    c, s = np.cos(trial.start[2]), np.sin(trial.start[2])
    return np.array([c * body[0] - s * body[1], s * body[0] + c * body[1], body[2]])
