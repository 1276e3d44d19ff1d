"""The wheels' motion of a trial, interpolated between the samples of its log."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.odometry import body_path, bridged, wheel_path
from slipmargin.diagnosis.prepare import Trial
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.physics.frames import rotate_rows
from slipmargin.sim.signal import WheelSignal, angles, angles_at, held, hermite, linear


class InterpolationScheme(Enum):
    """How the wheels' motion between samples is interpolated; the log does not say which one is right."""

    THIN = "cubic through as few samples as reproduce the others: for searching"
    ROUGH = "cubic through fewer samples still: for how much a change of the model changes a run"
    FULL = "cubic through every sample: for the final numbers"
    OTHER = "angles alone, or speeds held from row to row: to see how much the choice matters"


def wheel_signal(
    trial: Trial, commanded: bool, scheme: InterpolationScheme = InterpolationScheme.THIN
) -> WheelSignal:
    """Wheel angles over time: cubic between samples where angle and speed are known.

    Missing samples are interpolated.  Without logged angles the wheel angles start at zero, which matters
    only to effects of the wheel angle (:mod:`~slipmargin.diagnosis.wheel_phase`).
    """
    if scheme is InterpolationScheme.ROUGH:
        return _rough(trial, wheel_signal(trial, commanded, InterpolationScheme.FULL))
    record = trial.record
    t = record.t_s
    if commanded:
        if record.omega_cmd is None:
            raise InputError(trial.name, "has no commanded wheel speeds", "add omega{i}_cmd_rad_s")
        return _by_speed(t, bridged(t, record.omega_cmd), scheme, record.commands_held)
    if record.theta is not None and np.isfinite(record.theta).any(axis=0).all():
        theta = bridged(t, record.theta)
        if (
            scheme is not InterpolationScheme.OTHER
            and record.omega is not None
            and np.isfinite(record.omega).any(axis=0).all()
        ):
            omega = bridged(t, record.omega)
            return (
                _thinned(t, theta, omega, _trust(t, theta, omega))
                if scheme is InterpolationScheme.THIN
                else hermite(t, theta, omega)
            )
        return angles(t, theta)
    if record.omega is None:
        raise InputError(trial.name, "has no measured wheel speeds", "add omega{i}_rad_s or theta{i}_rad")
    return _by_speed(t, bridged(t, record.omega), scheme, False)


def with_phases(signal: WheelSignal, phase: Array) -> WheelSignal:
    """The same motion with ``phase`` (N,) added to the wheel angles [rad]."""
    if not phase.any():
        return signal
    pieces = signal.pieces.copy()
    pieces[:, :, 0] += phase
    return replace(signal, pieces=pieces)


def _by_speed(t: Array, omega: Array, scheme: InterpolationScheme, hold: bool) -> WheelSignal:
    other = scheme is InterpolationScheme.OTHER
    return held(t, omega) if hold != other else linear(t, omega)


#: What a run changes by with the model needs the wheels' motion to this [rad], [rad/s]: 5 µm and 1 mm/s at a
#: wheel of 50 mm. Differences are then right to 1 % in the median; 20 times as much is as fast and 5 % off.
_ROUGHLY = (1e-4, 0.02)


def _rough(trial: Trial, full: WheelSignal) -> WheelSignal:
    """The cubic through few samples of a signal; where its speeds jump, from the middle of the jumps."""
    t = trial.t_s
    theta = angles_at(full, t)
    after = full.pieces[:, :, 1]
    h = np.diff(full.knots_s)[:, None]
    ends = after + h * (2.0 * full.pieces[:, :, 2] + 3.0 * h * full.pieces[:, :, 3])
    omega = 0.5 * (np.vstack([after[:1], ends]) + np.vstack([after, ends[-1:]]))
    noise = _trust(t, theta, omega)
    same = max(_ROUGHLY[0], noise[0]), max(_ROUGHLY[1], noise[1])
    return _thinned(t, theta, omega, same)


#: A sample is left out where the cubic through its neighbours meets it this closely [rad], [rad/s] …
_SAME = (2e-5, 4e-3)
#: … or as closely as angles and speeds agree with themselves, but never less closely than this.
_LOOSEST = (2e-3, 0.1)
_LONGEST = 32


def _thinned(t: Array, theta: Array, omega: Array, same: tuple[float, float]) -> WheelSignal:
    """The cubic through as few samples as reproduce all the others: the integrator stops at each."""
    signal = (t, theta, omega)
    keep = [0]
    last = len(t) - 1
    while keep[-1] < last:
        start, span = keep[-1], 1
        while start + 2 * span <= last and span < _LONGEST:
            ends, inside = [start, start + 2 * span], slice(start + 1, start + 2 * span)
            angle, speed = _misses(*(v[ends] for v in signal), *(v[inside] for v in signal))
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
    signal = (t, theta, omega)
    found = []
    misses = _misses(*(np.stack([v[:-2], v[2:]]) for v in signal), *(v[1:-1] for v in signal))
    for axis, missed in enumerate(misses):
        change = np.diff(missed, n=2, axis=0)
        noise = 1.5 * float(np.median(np.max(np.abs(change), axis=1)))
        found.append(min(max(_SAME[axis], 3.0 * noise), _LOOSEST[axis]))
    return found[0], found[1]


def _misses(
    end_t: Array, end_theta: Array, end_omega: Array, t: Array, theta: Array, omega: Array
) -> tuple[Array, Array]:
    """What a cubic misses samples (T), (T, N) between its two ends by: (T, N) each.

    The ends are (2), (2, N) for all samples, or (2, T), (2, T, N) for each its own.
    """
    h = np.asarray(end_t[1] - end_t[0])[..., None]
    u = (t - end_t[0])[:, None] / h
    th0, th1, w0, w1 = end_theta[0], end_theta[1], end_omega[0] * h, end_omega[1] * h
    angle = (
        (1 + 2 * u) * (1 - u) ** 2 * th0
        + u * (1 - u) ** 2 * w0
        + u**2 * (3 - 2 * u) * th1
        + u**2 * (u - 1) * w1
    )
    speed = (6 * u * (u - 1) * (th0 - th1) + (3 * u - 1) * (u - 1) * w0 + u * (3 * u - 2) * w1) / h
    return angle - theta, speed - omega


def started(
    model: Model, trial: Trial, signal: WheelSignal, sigma: Array, commanded: bool
) -> tuple[WheelSignal, Array]:
    """A trial's signal with what was commanded before it, and the floor-frame velocity (3,) it begins with.

    Where commands alone are known, the first poses, whose noise is ``sigma`` (3,), say whether the robot
    stands when they begin or follows the first of them already; what is cut from a run goes on as it was.
    """
    if commanded and not _goes_on(trial) and not _moves_at_once(trial, sigma):
        return signal, np.zeros(3)
    before = signal.pieces[0, :, 1] if commanded else signal.spin_rad_s
    return replace(signal, spin_rad_s=before), start_twist(model, trial, signal, sigma)


def _goes_on(trial: Trial) -> bool:
    """Whether a trial is cut from a run that began before."""
    return trial.record.start_s < float(trial.t_s[0])


def _early(trial: Trial) -> NDArray[np.bool_]:
    """Which samples (T,) of a trial are poses that say how fast it began."""
    return np.asarray((trial.t_s <= trial.t_s[0] + SETTINGS.start_s) & np.isfinite(trial.pose).all(axis=1))


def _moves_at_once(trial: Trial, sigma: Array) -> bool:
    """Whether a robot is as fast at first as a little later; so it is taken to be where too few poses tell.

    It may be slower than it was asked to be.  One that starts from rest, with or without a lag, has to gain
    its speed.
    """
    rows = np.flatnonzero(np.isfinite(trial.pose).all(axis=1))
    if len(rows) < SETTINGS.start_poses:
        return True
    stamps = trial.t_s[rows]
    rows = rows[stamps <= max(stamps[0] + SETTINGS.start_s, stamps[SETTINGS.start_poses - 1])]
    t, moved = trial.t_s[rows] - trial.t_s[rows[0]], body_path(trial.pose[rows]) / sigma
    powers = t[:, None] ** np.arange(1, 3)  # from the first pose: what starts from rest stays behind
    to_fit = np.linalg.pinv(powers)
    by_time = to_fit @ moved
    missed = np.sqrt(np.sum((moved - powers @ by_time) ** 2) / (3 * len(t) - 6))
    error = max(1.0, float(missed)) * float(np.hypot(np.linalg.norm(to_fit[0]), np.sum(to_fit[0])))
    mean = by_time[0] + t[-1] * by_time[1]
    size = float(np.linalg.norm(mean))
    if size <= SETTINGS.start_deviations * error:
        return False
    return float(by_time[0] @ mean) > SETTINGS.start_share * size**2


def start_twist(model: Model, trial: Trial, signal: WheelSignal, sigma: Array) -> Array:
    """Floor-frame velocity (3,) with which a run begins [m/s, m/s, rad/s].

    It is what the wheels' first speeds make without slip.  Where the first poses, whose noise is ``sigma``
    (3,), say clearly that the robot slid, it is what they say, and in the directions in which it did not what
    the wheels say over the same time: a run may begin in the middle of a motion.
    """
    geometry, speeds = model.geometry, signal.pieces[0, :, 1]
    body = geometry.no_slip_map() @ speeds
    early = _early(trial)
    count, t = int(early.sum()), trial.t_s[early] - trial.t_s[0]
    if count < SETTINGS.start_poses:
        return rotate_rows(trial.start[2], body)
    turned = angles_at(signal, trial.t_s[early])
    # From rest the wheels run away from the floor in no time: of such a start no parabola tells.
    pace = np.max(np.abs(turned[-1] - turned[0])) / t[-1]
    if _goes_on(trial) or np.max(np.abs(speeds)) >= SETTINGS.start_pace * pace:
        moved = body_path(trial.pose[early])
        slid = moved - wheel_path(geometry, turned)
        powers = t[:, None] ** np.arange(3)  # where it began, the velocity then, and how that changed
        to_fit = np.linalg.pinv(powers)
        by_slip = to_fit @ slid
        missed = np.sqrt(np.sum((slid - powers @ by_slip) ** 2, axis=0) / (count - 3))
        error = np.maximum(sigma, missed) * np.linalg.norm(to_fit[1])
        clearly = np.abs(by_slip[1]) > SETTINGS.start_deviations * error
        if clearly.any():  # then not the wheels' first speeds, which may be the edge of noisy angles
            body = (to_fit @ moved)[1] - np.where(clearly, 0.0, by_slip[1])
    return rotate_rows(trial.start[2], body)
