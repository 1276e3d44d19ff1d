"""Wheel motion as data: cubic pieces of the wheel angle, from whatever was logged or asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WheelSignal:
    """θ_i(t) = c0 + c1 τ + c2 τ² + c3 τ³ between knots.

    Parameters
    ----------
    knots_s : array (K+1,)
        Ascending times [s]; the run starts at the first and may last to the last.
    pieces : array (K, N, 4)
        Coefficients [rad, rad/s, rad/s², rad/s³] with τ since the piece's first knot.
    spin_rad_s : array (N,)
        Speed that was commanded before the first knot, which wheels have followed [rad/s]; only a drive that
        lags or is a state of its own asks for it.
    """

    knots_s: Array
    pieces: Array
    spin_rad_s: Array

    def __post_init__(self) -> None:
        knots = frozen("t_s", self.knots_s, (None,))
        pieces = frozen("pieces", self.pieces, (max(len(knots) - 1, 0), None, 4))
        put = object.__setattr__
        put(self, "knots_s", knots)
        put(self, "pieces", pieces)
        put(self, "spin_rad_s", frozen("spin_rad_s", self.spin_rad_s, (pieces.shape[1],)))

    @property
    def wheels(self) -> int:
        """Number of wheels N."""
        return int(self.pieces.shape[1])

    def peak_speed(self) -> Array:
        """(N,) largest |ω| of each wheel [rad/s]: at the ends of pieces or where ω̇ is zero between."""
        h = np.diff(self.knots_s)[:, None]
        _, c1, c2, c3 = np.moveaxis(self.pieces, 2, 0)
        flat = np.clip(-c2 / np.where(c3 == 0.0, np.inf, 3.0 * c3), 0.0, h)
        speeds = [np.abs(c1 + x * (2.0 * c2 + 3.0 * c3 * x)) for x in (np.zeros_like(h), flat, h)]
        return np.asarray(np.max(speeds, axis=(0, 1)))


def held(t_s: Array, omega: Array, *, end_s: float | None = None, theta0: Array | None = None) -> WheelSignal:
    """Wheel speeds ``omega`` (T, N) [rad/s], each held until the next row; the last until ``end_s``.

    Without ``end_s`` the last row only says when the one before it ends.  ``theta0`` (N,): wheel
    angles at the start [rad], 0 where not given.
    """
    t, om = _rows(t_s, omega, "omega")
    if end_s is not None:
        if not np.isfinite(end_s) or end_s <= t[-1]:
            raise InputError("end_s", f"is {end_s}", "let the run end after the last row")
        t, om = np.append(t, float(end_s)), np.vstack([om, om[-1]])
    _enough(t)
    return _from_speed(t, om[:-1], np.zeros_like(om[:-1]), theta0)


def linear(
    t_s: Array, omega: Array, *, theta0: Array | None = None, spin: Array | None = None
) -> WheelSignal:
    """Wheel speeds (T, N) [rad/s] with straight lines between rows; ``spin`` (N,): commanded speed before."""
    t, om = _rows(t_s, omega, "omega")
    _enough(t)
    return _from_speed(t, om[:-1], np.diff(om, axis=0) / np.diff(t)[:, None], theta0, spin)


def hermite(t_s: Array, theta: Array, omega: Array) -> WheelSignal:
    """Cubic Hermite pieces through angles [rad] and speeds [rad/s], both (T, N): for measured logs."""
    t, th = _rows(t_s, theta, "theta")
    _, om = _rows(t_s, omega, "omega")
    if om.shape != th.shape:
        raise InputError("omega", f"has shape {om.shape}, theta {th.shape}", "give both for every wheel")
    _enough(t)
    h = np.diff(t)[:, None]
    rise = np.diff(th, axis=0) / h
    c2 = (3.0 * rise - 2.0 * om[:-1] - om[1:]) / h
    c3 = (om[:-1] + om[1:] - 2.0 * rise) / h**2
    return WheelSignal(knots_s=t, pieces=np.stack([th[:-1], om[:-1], c2, c3], axis=2), spin_rad_s=om[0])


def angles(t_s: Array, theta: Array) -> WheelSignal:
    """Wheel angles (T, N) [rad] only: speeds from the parabola through neighbouring samples."""
    t, th = _rows(t_s, theta, "theta")
    _enough(t)
    if len(t) == 2:
        return hermite(t, th, np.repeat(np.diff(th, axis=0) / (t[1] - t[0]), 2, axis=0))
    return hermite(t, th, np.asarray(np.gradient(th, t, axis=0, edge_order=2)))


def angles_at(signal: WheelSignal, t_s: Array) -> Array:
    """Wheel angles (T, N) [rad] at some instants of a signal [s]."""
    piece = np.clip(np.searchsorted(signal.knots_s, t_s, side="right") - 1, 0, len(signal.pieces) - 1)
    tau = (np.asarray(t_s) - signal.knots_s[piece])[:, None]
    c0, c1, c2, c3 = np.moveaxis(signal.pieces[piece], 2, 0)
    return np.asarray(c0 + tau * (c1 + tau * (c2 + tau * c3)))


def _from_speed(
    t: Array, om: Array, slope: Array, theta0: Array | None, spin: Array | None = None
) -> WheelSignal:
    h = np.diff(t)[:, None]
    n = om.shape[1]
    first = np.zeros(n) if theta0 is None else frozen("theta0", theta0, (n,))
    with np.errstate(over="ignore", invalid="ignore"):
        gain = h * (om + 0.5 * slope * h)
        angle = first + np.vstack([np.zeros(n), np.cumsum(gain, axis=0)[:-1]])
    pieces = np.stack([angle, om, 0.5 * slope, np.zeros_like(om)], axis=2)
    return WheelSignal(knots_s=t, pieces=pieces, spin_rad_s=np.zeros(n) if spin is None else spin)


def _rows(t_s: Array, values: Array, place: str) -> tuple[Array, Array]:
    t = frozen("t_s", t_s, (None,))
    array = frozen(place, values, (len(t), None))
    step = np.diff(t)
    if len(step) and step.min() <= 0.0:
        row = int(np.argmax(step <= 0.0)) + 1
        raise InputError(
            "t_s",
            f"row {row + 1} is at {t[row]:g} s, not after {t[row - 1]:g} s",
            "time must increase from row to row",
        )
    size = float(np.max(np.abs(array), initial=0.0))
    if size > 1e6:
        raise InputError(place, f"reaches {size:.3g}", "give wheel angles and speeds below 1e6 [rad, rad/s]")
    return t, array


def _enough(t: Array) -> None:
    if len(t) < 2:
        raise InputError("t_s", f"{len(t)} row makes no motion", "give two rows or more")
