"""What a slip monitor looks at: numbers from one sample after the other, in constant memory.

Every channel runs through first-order filters with the time constant τ, so that a number describes about
the last 2 τ and the delay is bounded.  Which numbers there are depends on what is logged:

* the share of its grip that the robot's own model gives the most loaded wheel at the motion of the wheels;
* the null-space residual: wheel speeds that no body motion has (four wheels and more);
* acceleration, roughness and size of the motion of the wheels;
* how far wheel speeds are from the commanded ones;
* yaw rate of the gyro against that of the wheels;
* motor currents: each, their sum, and the power they make per speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_realised import LIGHTEST
from slipmargin.onboard.table import LimitTable
from slipmargin.physics.friction_laws import law_share

#: Time constant of the filters [s].
TAU_S = 0.06
#: What is added before a logarithm, so that a robot at rest has finite numbers [m/s, m/s², rad/s, A, 1].
SLOW, CALM, STILL, FAINT, UNUSED = 2e-3, 0.05, 0.02, 0.02, 0.01


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Channels:
    """Which channels a robot logs besides its wheel speeds."""

    commanded: bool = False
    gyro: bool = False
    current: bool = False


@final
class Signals:
    """The numbers of one robot's stream; :meth:`update` takes a sample, :attr:`names` names the numbers."""

    def __init__(self, table: LimitTable, channels: Channels, tau_s: float = TAU_S) -> None:
        self.table, self.channels, self._tau = table, channels, tau_s
        n = table.count
        self._twist = np.linalg.pinv(table.rolling)
        left = np.eye(n) - table.rolling @ self._twist
        self._null = np.linalg.svd(left)[2][: n - 3]
        #: metres a second of the rim per rad/s
        self._rim = 1.0 / float(np.mean(np.linalg.norm(table.rolling[:, :2], axis=1)))
        self.names = self._names()
        self._last: float | None = None
        self._mean = np.zeros(n)
        self._rate = np.zeros(n)
        self._rough, self._residual = 0.0, 0.0
        self._behind, self._yaw = 0.0, 0.0
        self._current = np.zeros(n)

    def _names(self) -> tuple[str, ...]:
        names = ["utilisation", "acceleration", "yaw acceleration", "roughness", "speed", "yaw rate"]
        if len(self._null):
            names.append("null-space residual")
        if self.channels.commanded:
            names.append("behind command")
        if self.channels.gyro:
            names.append("gyro against wheels")
        if self.channels.current:
            names += [f"current {w}" for w in self.table.names] + ["current", "power per speed"]
        return tuple(names)

    def twist(self, omega: Array) -> Array:
        """Body twist (3,) that wheel speeds (N,) mean without slip."""
        return np.asarray(self._twist @ omega)

    def update(
        self,
        t_s: float,
        omega: Array,
        commanded: Array | None = None,
        gyro_rad_s: float | None = None,
        current_A: Array | None = None,
    ) -> Array:
        """The numbers (F,) after one more sample."""
        if self._last is None:
            self._mean, dt = omega.copy(), self._tau
        else:
            dt = max(t_s - self._last, 1e-6)
        self._last = t_s
        k = 1.0 - math.exp(-dt / self._tau)
        off = omega - self._mean
        self._mean += k * off
        self._rate += k * (off / self._tau - self._rate)
        rough = off - self._tau * self._rate
        self._rough += k * (float(rough @ rough) - self._rough)
        twist, rate = self._twist @ self._mean, self._twist @ self._rate
        speed = math.hypot(twist[0], twist[1])
        pull = math.hypot(rate[0] - twist[2] * twist[1], rate[1] + twist[2] * twist[0])
        out = [
            math.log(UNUSED + self._share(twist, rate)),
            math.log(CALM + pull),
            math.log(CALM + abs(rate[2])),
            math.log(SLOW + math.sqrt(self._rough) * self._rim),
            speed,
            math.log(STILL + abs(twist[2])),
        ]
        if len(self._null):
            apart = self._null @ omega * self._rim
            self._residual += k * (float(apart @ apart) - self._residual)
            out.append(math.log(SLOW + math.sqrt(self._residual)))
        if self.channels.commanded:
            assert commanded is not None
            behind = (commanded - omega) * self._rim
            self._behind += k * (float(behind @ behind) - self._behind)
            out.append(math.log(SLOW + math.sqrt(self._behind)))
        if self.channels.gyro:
            assert gyro_rad_s is not None
            self._yaw += k * (gyro_rad_s - float(self._twist[2] @ omega) - self._yaw)
            out.append(math.log(STILL + abs(self._yaw)))
        if self.channels.current:
            assert current_A is not None
            self._current += k * (np.abs(current_A) - self._current)
            total = float(self._current.sum())
            power = float(self._current @ np.abs(self._mean)) * self._rim
            out += [math.log(FAINT + c) for c in self._current]
            out += [math.log(FAINT + total), math.log((FAINT + power) / (SLOW + speed + abs(twist[2]) * 0.1))]
        return np.array(out)

    def shares(self) -> Array:
        """Share (N,) of its grip that the model gives each wheel at the filtered motion."""
        twist, rate = self._twist @ self._mean, self._twist @ self._rate
        return self._shares(twist, rate)

    def _share(self, twist: Array, rate: Array) -> float:
        return float(self._shares(twist, rate).max())

    def _shares(self, twist: Array, rate: Array) -> Array:
        """As :func:`~slipmargin.onboard.limiter.utilisation` on one level floor, for one state."""
        t, (cx, cy), w = self.table, self.table.com_m, twist[2]
        # com_acceleration of one state, written out: called here it takes as long as the rest of a sample.
        a = np.array(
            [
                rate[0] - w * twist[1] - rate[2] * cy - w * w * cx,
                rate[1] + w * twist[0] + rate[2] * cx - w * w * cy,
                rate[2],
            ]
        )
        load = np.maximum(t.rest_low_N[0] + t.per_acceleration_kg @ a[:2], LIGHTEST * t.mean_load_N)
        drag = t.drag_high * law_share(t.law, t.slope_high * (t.lateral @ twist))
        wrench = a * t.mass - 0.5 * (t.wrench_low + t.wrench_high) + t.across @ (drag * load)
        return np.asarray(np.abs(t.spread @ wrench) / (t.drive * load))
