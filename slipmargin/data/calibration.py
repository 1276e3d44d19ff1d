"""Calibration of the camera against the wheels, kept apart from the physics of slip.

It is estimated once with the no-slip model, on the floor with the least slip, then held fixed on every
other floor.  Slip on that floor that is the same in all directions cannot be distinguished from the scale
and is part of it.

Signs: measured displacement in the body frame = scale · R(rotation) · (what the wheels say), read
``delay`` late.  The scale of a tilted camera varies over the floor: with p the measured
position and p₀ the middle of the calibration runs, the rectified position is
p₀ + (p − p₀) / (1 + tilt·(p − p₀)), the plane projective map of a tilted pinhole camera.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.data.delay import estimate_delay
from slipmargin.data.odometry import bridged, wheel_angles, wheel_path
from slipmargin.data.record import Record
from slipmargin.data.settings import SETTINGS
from slipmargin.effects import Effect
from slipmargin.effects.camera import camera_effects
from slipmargin.errors import InputError
from slipmargin.physics.frames import rotate_rows
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Calibration:
    """Camera against wheels, with one standard deviation each (clustered by run).

    ``scale`` [1], ``rotation_rad``, ``delay_s``; ``tilt_per_m`` (2,) and ``middle_m`` (2,) of the
    tilted camera, zero tilt where none was found.  ``spread`` is the rms of what is left, per
    distance driven [1]; ``runs`` how many runs it rests on.
    """

    scale: float
    rotation_rad: float
    delay_s: float
    tilt_per_m: Array = field(default_factory=lambda: np.zeros(2))
    middle_m: Array = field(default_factory=lambda: np.zeros(2))
    scale_sd: float = 0.0
    rotation_sd_rad: float = 0.0
    delay_sd_s: float = 0.0
    tilt_sd_per_m: Array = field(default_factory=lambda: np.zeros(2))
    spread: float = 0.0
    runs: int = 0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(
            self,
            "scale",
            real(
                "scale",
                self.scale,
                low=0.5,
                high=2.0,
                cure="measured over true distance lies between 0.5 and 2: check the units",
            ),
        )
        put(
            self,
            "rotation_rad",
            real(
                "rotation_rad",
                self.rotation_rad,
                low=-0.5,
                high=0.5,
                cure="the camera's rotation lies within 0.5 rad: check the axes",
            ),
        )
        put(
            self,
            "delay_s",
            real(
                "delay_s",
                self.delay_s,
                low=-0.5,
                high=0.5,
                cure="the delay lies within 0.5 s: check the time stamps",
            ),
        )
        for name in ("tilt_per_m", "middle_m", "tilt_sd_per_m"):
            put(self, name, frozen(name, getattr(self, name), (2,)))

    def effects(self) -> tuple[Effect, ...]:
        """The same as effects of the measurement, for the robot file."""
        return camera_effects(self.scale, self.rotation_rad, self.delay_s)

    def rectified(self, record: Record) -> Record:
        """The record as a camera without tilt would have seen it; headings stay."""
        if not self.tilt_per_m.any():
            return record
        pose = np.array(record.pose)
        off = pose[:, :2] - self.middle_m
        pose[:, :2] = self.middle_m + off / (1.0 + off @ self.tilt_per_m)[:, None]
        return replace(record, pose=pose)

    def lines(self) -> tuple[str, ...]:
        """The report."""
        report = (
            f"scale {self.scale:.4f} ± {self.scale_sd:.4f} (measured over wheels)",
            f"rotation {self.rotation_rad:+.4f} ± {self.rotation_sd_rad:.4f} rad",
            f"camera delay {self.delay_s * 1e3:.0f} ± {self.delay_sd_s * 1e3:.0f} ms",
            f"left over {100.0 * self.spread:.2f} % of the distance, {self.runs} runs",
        )
        if not self.tilt_per_m.any():
            return report
        tilt = ", ".join(
            f"{100 * g:+.2f} ± {100 * s:.2f}"
            for g, s in zip(self.tilt_per_m, self.tilt_sd_per_m, strict=True)
        )
        return (*report, f"camera tilt ({tilt}) % of scale per metre along x, y")


def calibrate(records: tuple[Record, ...], contacts: WheelGeometry, tilt: bool = True) -> Calibration:
    """Scale, rotation, delay and (where the runs show one) tilt of the camera, by the wheels.

    Parameters
    ----------
    records : tuple of Record
        Runs on the floor with the least slip.
    contacts : WheelGeometry
        Where the wheels stand and how large they are.
    tilt : bool
        Whether to look for a tilt.

    Raises
    ------
    InputError
        Where fewer than two runs move, or wheel angles are missing.
    """
    paths = [wheel_path(contacts, _measured(record)) for record in records]
    delay = estimate_delay(records, contacts)
    pieces = [
        _pieces(r, path, delay.value_s, SETTINGS.calibration_piece_s)
        for r, path in zip(records, paths, strict=True)
    ]
    pieces = [p for p in pieces if len(p.wheel)]
    if len(pieces) < 2:
        raise InputError(
            "trials",
            f"{len(pieces)} runs move long enough to calibrate by",
            f"give two or more runs of at least {SETTINGS.calibration_piece_s:g} s",
        )
    middle = np.mean(np.concatenate([p.place for p in pieces]), axis=0)
    found, sd, left = _fit(pieces, middle, tilt)
    if tilt and not np.any(np.abs(found[2:]) > SETTINGS.tilt_sure * sd[2:]):
        found, sd, left = _fit(pieces, middle, False)
    whole = np.array([np.hypot(*r.sum(axis=0)) for r in left])
    length = np.array([np.hypot(*p.wheel.T).sum() for p in pieces])
    return Calibration(
        scale=float(np.hypot(*found[:2])),
        rotation_rad=float(np.arctan2(found[1], found[0])),
        delay_s=delay.value_s,
        tilt_per_m=found[2:],
        middle_m=middle,
        scale_sd=float(sd[0]),
        rotation_sd_rad=float(sd[1] / np.hypot(*found[:2])),
        delay_sd_s=delay.sd_s,
        tilt_sd_per_m=sd[2:],
        spread=float(np.sqrt(np.mean((whole / length) ** 2))),
        runs=len(pieces),
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Pieces:
    """A run in K pieces, in the frames they were measured in."""

    wheel: Array  # (K, 2) displacement by the wheels, body frame
    ends: Array  # (K + 1, 3) measured pose
    place: Array  # (K, 2) middle of each piece


def _measured(record: Record) -> Array:
    angle = wheel_angles(record.t_s, record.theta, record.omega)
    if angle is None:
        raise InputError(
            record.name,
            "has no measured wheel angles or speeds",
            'calibrate by a data set with wheel_signal = "measured"',
        )
    return angle


def _pieces(record: Record, path: Array, delay_s: float, piece_s: float) -> _Pieces:
    """The pieces of a run; ``path`` (T, 3) is that of its wheels."""
    t = record.t_s
    count = int((t[-1] - t[0]) // piece_s)
    edges = t[0] + 0.5 + np.arange(count) * piece_s if count else np.zeros(0)
    edges = edges[edges <= t[-1]]
    pose = bridged(t, record.pose)
    ends = np.column_stack([np.interp(edges, t, column) for column in pose.T])
    by = np.column_stack([np.interp(edges - delay_s, t, column) for column in path[:, :2].T])
    wheel = np.diff(by, axis=0)
    moves = np.hypot(*wheel.T) > 0.2 * np.hypot(*wheel.T).max() if len(wheel) else np.zeros(0, dtype=bool)
    if not moves.all():  # a run that stops: keep the moving part in one piece
        stop = int(np.argmin(moves))
        wheel, ends = wheel[:stop], ends[: stop + 1]
    return _Pieces(wheel=wheel, ends=ends, place=0.5 * (ends[1:, :2] + ends[:-1, :2]))


def _fit(pieces: list[_Pieces], middle: Array, tilt: bool) -> tuple[Array, Array, list[Array]]:
    """(a, b, gx, gy), their standard deviations, and what is left of each run's pieces (K, 2).

    Measured = [[a, −b], [b, a]] wheels: linear in (a, b), and in the tilt after one linearisation,
    so Gauss–Newton settles in a few steps.
    """
    value = np.array([1.0, 0.0, 0.0, 0.0])
    free = 4 if tilt else 2
    for _ in range(8):
        rows, left = zip(*[_linear(p, middle, value) for p in pieces], strict=True)
        jac = np.concatenate([r.reshape(-1, 4) for r in rows])[:, :free]
        step = np.linalg.lstsq(jac, np.concatenate([e.ravel() for e in left]), rcond=None)[0]
        value[:free] += step
        if np.abs(step).max() < 1e-10:
            break
    rows, left = zip(*[_linear(p, middle, value) for p in pieces], strict=True)
    jac = np.concatenate([r.reshape(-1, 4) for r in rows])[:, :free]
    inverse = np.linalg.inv(jac.T @ jac)
    score = [r.reshape(-1, 4)[:, :free].T @ e.ravel() for r, e in zip(rows, left, strict=True)]
    covariance = inverse @ (np.array(score).T @ np.array(score)) @ inverse
    sd = np.zeros(4)
    sd[:free] = np.sqrt(np.diag(covariance))
    return value, sd, list(left)


def _linear(p: _Pieces, middle: Array, value: Array) -> tuple[Array, Array]:
    """Derivatives (K, 2, 4) of model − rectified camera, and the negative of that difference (K, 2)."""
    off = p.ends[:, :2] - middle
    q = 1.0 + off @ value[2:]
    flat = off / q[:, None]
    slope = -flat[:, :, None] * (off / q[:, None])[:, None, :]  # d flat / d tilt
    seen = _in_body(np.diff(flat, axis=0), p.ends)
    seen_slope = np.stack([_in_body(np.diff(slope[..., j], axis=0), p.ends) for j in range(2)], axis=-1)
    a, b = value[:2]
    x, y = p.wheel.T
    model = np.column_stack([a * x - b * y, b * x + a * y])
    jac = np.empty((len(x), 2, 4))
    jac[:, 0, 0], jac[:, 1, 0] = x, y
    jac[:, 0, 1], jac[:, 1, 1] = -y, x
    jac[..., 2:] = -seen_slope
    return jac, seen - model


def _in_body(step: Array, ends: Array) -> Array:
    """Floor-frame steps (K, 2) in the body frame of each piece's mean heading, with the chord's factor."""
    turn = np.diff(ends[:, 2])
    chord = np.sinc(turn / (2.0 * np.pi))  # an arc's chord is shorter than the arc
    return rotate_rows(ends[:-1, 2] + 0.5 * turn, step, inverse=True) / chord[:, None]
