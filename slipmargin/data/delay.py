"""The constant delay between camera and encoders, estimated from the start of a run, which both record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.odometry import body_path, wheel_angles, wheel_path
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS
from slipmargin.errors import InputError
from slipmargin.physics.kinematics import WheelGeometry

_GRID_S = np.arange(-0.4, 0.4001, 0.005)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Delay:
    """How late the camera is: median over runs and its standard error [s]; negative where encoders are."""

    value_s: float
    sd_s: float
    runs: int


def estimate_delay(records: tuple[Record, ...], contacts: WheelGeometry) -> Delay:
    """The delay at which the wheels' path, scaled and turned, fits the camera's best.

    On a floor that slips, spinning up looks like a longer delay: estimate it where slip is least.

    Raises
    ------
    InputError
        Where no run starts to move.
    """
    found = [d for d in (_one(r.first(), contacts) for r in records) if d is not None]
    if not found:
        raise InputError(
            "trials",
            "no run starts from rest with wheel angles and pose",
            "a delay can only be estimated from a start; give runs that begin at rest",
        )
    values = np.array(found)
    spread = 1.4826 * float(np.median(np.abs(values - np.median(values))))
    return Delay(
        value_s=float(np.median(values)), sd_s=1.2533 * spread / len(values) ** 0.5, runs=len(values)
    )


def _one(record: Record, contacts: WheelGeometry) -> float | None:
    t = record.t_s
    angle = wheel_angles(t, record.theta, record.omega)
    if angle is None:
        return None
    wheel = wheel_path(contacts, angle)[:, :2] @ np.array([1.0, 1.0j])
    seen = body_path(record.pose)[:, :2] @ np.array([1.0, 1.0j])
    moving = np.abs(wheel) > 0.02 * np.abs(wheel).max()
    if not np.abs(wheel).max() > 0.0 or moving[0] or not moving.any():
        return None
    start = t[int(np.argmax(moving))]
    near = (t > start - 1.0) & (t < start + SETTINGS.early_s)
    if np.count_nonzero(near) < 8:
        return None
    misfit = np.array([_misfit(t[near], seen[near], t, wheel, delay) for delay in _GRID_S])
    k = int(np.argmin(misfit))
    if k in (0, len(_GRID_S) - 1):
        return None
    left, here, right = misfit[k - 1 : k + 2]
    curve = left - 2.0 * here + right
    return float(_GRID_S[k] + (0.5 * 0.005 * (left - right) / curve if curve > 0.0 else 0.0))


def _misfit(at: Array, seen: Array, t: Array, wheel: Array, delay: float) -> float:
    late = np.interp(at - delay, t, wheel.real) + 1j * np.interp(at - delay, t, wheel.imag)
    power = np.vdot(late, late).real
    factor = np.vdot(late, seen) / power if power > 0.0 else 0.0
    return float(np.sum(np.abs(seen - factor * late) ** 2))
