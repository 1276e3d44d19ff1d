"""Where wheels stand and grip, and every linear map between body motion, wheel speeds and wheel forces.

A wheel at p with drive direction ŝ grips along ĝ (its roller's axle on the floor) and rolls freely along
f̂.  With the body twist (v, ω) of the origin and the wheel's rate θ̇ its contact moves over the floor with

    u = v + ω ẑ×p + ρ θ̇ ŝ           (eq. 3; positive θ̇ moves the contact along +ŝ)

A wheel that is out of round has ρ (1 + a cos θ + b sin θ) in place of ρ; limits are those of round wheels.

and no slip along the grip means u·ĝ = 0.  A unit force of the wheel along ĝ has the wrench
(ĝ, (p − c) × ĝ) about the centre of mass c (eqs 14–15).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, frozen, read_only
from slipmargin.physics.frames import moment

#: Geometries whose maps are kept: they are frozen, and a limit asks for the same map several times [1].
KEPT = 64


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WheelGeometry:
    """Where N wheels stand and which way they grip; every vector array is (N, 2), body frame.

    Parameters
    ----------
    names : tuple of N str
    position_m : (N, 2)
        Wheel centres p [m].
    drive, grip, free : (N, 2)
        Unit vectors ŝ, ĝ, f̂ (omni: ĝ = ŝ, f̂ = r̂; mecanum: both turned by the roller angle).  In the
        convention of ROS ŝ is the negative of the file's drive direction, ĝ and f̂ belong to the latter.
    radius_m : (N,)
        ρ [m].
    runout : (N, 2), optional
        a and b [1], how far each wheel is out of round; zero by default.
    wobble : (N, 2), optional
        a and b [rad]: with the wheel at angle θ all three vectors are turned by a cos θ + b sin θ, positive
        counter-clockwise from above; zero by default.
    """

    names: tuple[str, ...]
    position_m: Array
    drive: Array
    grip: Array
    free: Array
    radius_m: Array
    runout: Array = field(default_factory=lambda: np.zeros((0, 2)))
    wobble: Array = field(default_factory=lambda: np.zeros((0, 2)))

    def __post_init__(self) -> None:
        n, put = len(self.names), object.__setattr__
        for name in ("runout", "wobble"):
            if not len(getattr(self, name)):
                put(self, name, np.zeros((n, 2)))
        for name in ("position_m", "drive", "grip", "free", "runout", "wobble"):
            put(self, name, frozen(name, getattr(self, name), (n, 2)))
        put(self, "radius_m", frozen("radius_m", self.radius_m, (n,)))

    @property
    def count(self) -> int:
        """Number of wheels N."""
        return len(self.names)

    @property
    def changes_in_a_turn(self) -> bool:
        """Whether how a wheel rolls depends on its angle."""
        return bool(np.any(self.runout) or np.any(self.wobble))

    @property
    def reach_m(self) -> float:
        """Mean distance of the wheels from the body's origin [m]."""
        return float(np.mean(np.hypot(*self.position_m.T)))

    def hub_rows(self) -> Array:
        """(N, 2, 3): velocity of the wheel centres from the body twist of the origin."""
        rows = np.zeros((self.count, 2, 3))
        rows[:, 0, 0] = rows[:, 1, 1] = 1.0
        rows[:, 0, 2], rows[:, 1, 2] = -self.position_m[:, 1], self.position_m[:, 0]
        return rows

    @lru_cache(maxsize=KEPT)  # noqa: B019
    def rolling_rows(self) -> Array:
        """(N, 3): rolling speed ρ θ̇ [m/s] without slip along the grip, −(v + ω×p)·ĝ / ŝ·ĝ; read-only."""
        grip = np.einsum("id,idj->ij", self.grip, self.hub_rows())
        return read_only(-grip / np.sum(self.drive * self.grip, axis=1, keepdims=True))

    @lru_cache(maxsize=KEPT)  # noqa: B019
    def lateral_rows(self) -> Array:
        """(N, 3): lateral slip u·f̂ [m/s] left when the wheel does not slip along its grip; read-only."""
        free = np.einsum("id,idj->ij", self.free, self.hub_rows())
        across = np.sum(self.drive * self.free, axis=1, keepdims=True)
        return read_only(free + across * self.rolling_rows())

    def wheel_speeds(self, twist: Array) -> Array:
        """Wheel speeds θ̇ (..., N) [rad/s] that roll without slip at body twists (..., 3)."""
        return np.asarray(twist @ self.rolling_rows().T / self.radius_m)

    def no_slip_map(self) -> Array:
        """(3, N): body twist of the origin that wheel speeds θ̇ imply without slip (least squares).

        Row by row v·ĝ + ω (p × ĝ) = −ρ θ̇ ŝ·ĝ (eq. 3 with zero slip along the grip).
        """
        lever = moment(self.position_m[:, 0], self.position_m[:, 1], self.grip[:, 0], self.grip[:, 1])
        rows = np.column_stack([self.grip, lever])
        return np.asarray(-np.linalg.pinv(rows) * self.torque_arms()[0])

    @lru_cache(maxsize=KEPT)  # noqa: B019
    def torque_arms(self) -> Array:
        """(2, N): torque on a wheel per unit force along ĝ and along f̂, ρ ŝ·ĝ and ρ ŝ·f̂ [m]; read-only.

        A radian of the wheel slides its contact by as much along them.
        """
        along = [np.sum(self.drive * axis, axis=1) for axis in (self.grip, self.free)]
        return read_only(self.radius_m * np.stack(along))

    def wrench_maps(self, com_m: Array) -> tuple[Array, Array]:
        """B_W and B_T of eqs (14)–(15), each (3, N), about the centre of mass ``com_m``, body frame.

        Column i is the wrench of a unit force of wheel i along ĝ_i (or f̂_i); read-only.
        """
        return self._wrench_maps(float(com_m[0]), float(com_m[1]))

    @lru_cache(maxsize=KEPT)  # noqa: B019
    def _wrench_maps(self, com_x_m: float, com_y_m: float) -> tuple[Array, Array]:
        arm = self.position_m - np.array([com_x_m, com_y_m])

        def columns(direction: Array) -> Array:
            lever = moment(arm[:, 0], arm[:, 1], direction[:, 0], direction[:, 1])
            return read_only(np.vstack([direction.T, lever]))

        return columns(self.grip), columns(self.free)


def com_acceleration(com_m: Array, twist: Array, acceleration: Array) -> Array:
    """Body-frame acceleration (M, 3) of the centre of mass from that of the origin.

    a_com = a + α ẑ×c − ω² c, with c = ``com_m`` (2,), ``twist`` and ``acceleration`` (M, 3).
    """
    out = np.array(acceleration, dtype=float)
    out[:, 0], out[:, 1] = at_centre(com_m[0], com_m[1], twist[:, 2], *np.array(acceleration, dtype=float).T)
    return out


def rate_as_axes_turn(twist: Array) -> Array:
    """Rate (..., 3) of the body twist (..., 3) of a motion whose origin does not accelerate: −ω ẑ×v."""
    vx, vy, turn = np.moveaxis(np.asarray(twist, dtype=float), -1, 0)
    return np.stack([turn * vy, -turn * vx, np.zeros_like(turn)], axis=-1)


def at_centre(cx: Any, cy: Any, wz: Any, ax: Any, ay: Any, alpha: Any) -> tuple[Any, Any]:
    """Both parts of the centre of mass's acceleration by :func:`com_acceleration`, numbers or arrays."""
    return ax + (-alpha * cy - wz * wz * cx), ay + (alpha * cx - wz * wz * cy)


def integrated(t: Array, rate: Array) -> Array:
    """What rates (T,) or (T, C) have added up to since the first sample, by the trapezoidal rule."""
    step = np.diff(t).reshape(-1, *[1] * (rate.ndim - 1))
    return np.concatenate(
        [np.zeros((1, *rate.shape[1:])), np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step, axis=0)]
    )
