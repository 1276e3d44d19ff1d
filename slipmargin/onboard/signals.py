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
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_realised import LIGHTEST
from slipmargin.onboard.limiter import LEAST_LEFT
from slipmargin.onboard.table import LimitTable, threes

#: Time constant of the filters [s].
TAU_S = 0.06
#: What is added to a share before its logarithm [1].
UNUSED = 0.01


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
        from slipmargin.onboard.sample import sample, shares

        self.table, self.channels, self._tau = table, channels, tau_s
        self._sample = sample
        n = table.count
        to_twist = np.linalg.pinv(table.rolling)
        null = np.linalg.svd(np.eye(n) - table.rolling @ to_twist)[2][: n - 3]
        #: metres a second of the rim per rad/s
        self._rim = 1.0 / float(np.mean(np.linalg.norm(table.rolling[:, :2], axis=1)))
        self.names = self._names()
        self._maps = np.array(to_twist), np.array(null)
        rest = 0.5 * (table.rest_low_N[0] + table.rest_high_N[0])
        wrench = 0.5 * (table.wrench_low + table.wrench_high)
        laws = np.stack([table.drag, table.slope, table.coupled_drag, table.coupled_slope], axis=1)
        loads = (rest, table.rest_low_N[0], *table.per_acceleration_kg.T)
        machine: tuple[Any, ...] = (
            table.law,
            table.coupling,
            np.array([*loads, *laws[0], *laws[1], table.drive, table.most_beside]),
            np.array([*table.com_m, *table.mass, *wrench, LIGHTEST * table.mean_load_N, LEAST_LEFT]),
            *(np.array(values) for values in (table.lateral, table.across, table.viscous, table.spread)),
            *(part if table.shares_by_load else part[:0] for part in threes(table.along)),
        )
        self._shares: Callable[[Array, Array, Array], float] = partial(shares, *machine)
        self._last: float | None = None
        self._wheels, self._slow, self._motion = np.zeros((3, n)), np.zeros(4), np.zeros((3, 3))
        self._use = np.zeros((3, n))

    def _names(self) -> tuple[str, ...]:
        names = ["utilisation", "acceleration", "yaw acceleration", "roughness", "speed", "yaw rate"]
        if self.table.count > 3:
            names.append("null-space residual")
        if self.channels.commanded:
            names.append("behind command")
        if self.channels.gyro:
            names.append("gyro against wheels")
        if self.channels.current:
            names += [f"current {w}" for w in self.table.names] + ["current", "power per speed"]
        return tuple(names)

    @property
    def twist(self) -> Array:
        """Body twist (3,) that the last sample's wheel speeds mean without slip."""
        return np.array(self._motion[2])

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
            self._wheels[0], dt = omega, self._tau
        else:
            dt = max(t_s - self._last, 1e-6)
        self._last = t_s
        channels, out = self.channels, np.empty(len(self.names))
        ordered = commanded if channels.commanded else _NONE
        yaw = gyro_rad_s if channels.gyro else math.nan
        current = current_A if channels.current else _NONE
        assert ordered is not None and yaw is not None and current is not None, "announced"
        self._sample(
            1.0 - math.exp(-dt / self._tau),
            self._tau,
            self._rim,
            omega,
            ordered,
            yaw,
            current,
            *self._maps,
            self._wheels,
            self._slow,
            self._motion,
            out,
        )
        twist, rate = self._motion[0], self._motion[1]
        out[0] = math.log(UNUSED + self._shares(twist, rate, self._use))
        return out

    def shares(self) -> Array:
        """Share (N,) of its grip that the model gives each wheel at the filtered motion."""
        return np.array(self._use[0])


_NONE = np.zeros(0)
