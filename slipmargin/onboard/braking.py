"""Stopping on a straight line as fast as the margin allows: deceleration at every speed, time and distance.

    t(v) = ∫₀ᵛ du / d(u),      s(v) = ∫₀ᵛ u du / d(u),

with d(u) the largest deceleration that keeps 1 − margin of every wheel's grip, of its motor's torque and of
the load that keeps it on the floor, at the speed u (docs/theory.md, section 4).  Drag helps to brake, and
fades with the last millimetres a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, rounded_down
from slipmargin.errors import NoSolution
from slipmargin.limits.motion import acceleration_limit
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model

#: Speeds at which the deceleration is asked for; they lie closer where the drag fades.
STEPS = 160
#: A stop that would take longer is none: what brakes then is next to nothing [s].
LONGEST_S = 600.0


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Braking:
    """Stopping in H directions [rad] from S speeds [m/s].

    ``speed`` (K,) ascending from 0 is the grid of ``deceleration``, ``time_s`` and ``distance_m`` (H, K);
    ``wheels`` and ``cause`` (H,) say what limits at the highest speed.
    """

    heading_rad: Array
    speed: Array
    deceleration: Array
    time_s: Array
    distance_m: Array
    wheels: tuple[tuple[str, ...], ...]
    cause: tuple[str, ...]

    def at(self, table: Array, speed_m_s: float) -> Array:
        """One of the tables (H, K) at a speed, (H,)."""
        return np.array([np.interp(speed_m_s, self.speed, row) for row in table])

    def profile(self, direction: int, speed_m_s: float, step_s: float) -> tuple[Array, Array]:
        """Times (T,) [s] from the start of braking and the speed (T,) [m/s], down to rest."""
        whole = float(np.interp(speed_m_s, self.speed, self.time_s[direction]))
        t = np.append(np.arange(0.0, whole, step_s), whole)
        return t, np.interp(whole - t, self.time_s[direction], self.speed)


def braking(model: Model, heading_rad: Array, fastest_m_s: float, margin: float) -> Braking:
    """Stopping in every direction from speeds up to ``fastest_m_s``.

    Raises
    ------
    NoSolution
        Where the robot cannot brake within the margin, or not in ten minutes.
    """
    way = np.column_stack([np.cos(heading_rad), np.sin(heading_rad), np.zeros_like(heading_rad)])
    speed = fastest_m_s * np.linspace(0.0, 1.0, STEPS) ** 3
    velocity = (way[:, None] * speed[:, None]).reshape(-1, 3)
    against = np.repeat(-way, STEPS, axis=0)
    limit = acceleration_limit(model, Motion(velocity=velocity), against, share=1.0 - margin)
    found = limit.value.reshape(len(way), STEPS)
    fails = ~(np.isfinite(found) & (found > 0.0))
    if fails.any():
        k, h = np.unravel_index(int(np.argmax(fails.T)), fails.T.shape)  # the lowest speed of any direction
        raise NoSolution(
            "stop",
            f"at {speed[k]:.3g} m/s towards {np.rad2deg(heading_rad[h]):.0f}° no braking keeps the margin",
            "take a smaller margin"
            if k < 2
            else f"ask for {rounded_down(speed[k - 1]):g} m/s, or a smaller margin",
            limit,
        )
    middle, step = 0.5 * (speed[1:] + speed[:-1]), np.diff(speed)
    slow = 0.5 * (1.0 / found[:, 1:] + 1.0 / found[:, :-1])
    time = _summed(slow * step)
    if np.max(time) > LONGEST_S:
        far = int(np.argmax(time[:, -1]))
        at, most = int(np.argmax(slow[far])), time[far, -1]
        raise NoSolution(
            "stop",
            f"towards {np.rad2deg(heading_rad[far]):.0f}° it takes {most:.3g} s: at {middle[at]:.3g} m/s "
            f"only {1.0 / slow[far, at]:.2g} m/s² keep the margin",
            "ask for a lower speed or a smaller margin",
            limit,
        )
    last = np.arange(len(way)) * STEPS + STEPS - 1
    return Braking(
        heading_rad=heading_rad,
        speed=speed,
        deceleration=found,
        time_s=time,
        distance_m=_summed(slow * middle * step),
        wheels=tuple(limit.wheels[k] for k in last),
        cause=tuple(limit.cause[k] for k in last),
    )


def _summed(parts: Array) -> Array:
    return np.column_stack([np.zeros(len(parts)), np.cumsum(parts, axis=1)])
