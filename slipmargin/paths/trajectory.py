"""A trajectory: a motion that was planned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError

#: Fewest samples by which a motion can be judged: fewer have too few accelerations.
LEAST_SAMPLES = 6
#: A wheel limits the pace where it uses more than this share of what it may [1].
NEAR = 0.98
#: Wheels whose use differs by less than this part limit it together [1].
TIED = 1e-4


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """T samples of a planned motion.

    Parameters
    ----------
    t_s : array (T,)
        Time [s], strictly increasing.
    pose : array (T, 3)
        x [m], y [m], φ [rad] of the body frame's origin in the floor frame.
    velocity, acceleration : array (T, 3)
        Their derivatives, in the floor frame [m/s, m/s, rad/s] and [m/s², m/s², rad/s²].
    omega : array (T, N)
        Wheel speeds θ̇ that roll without drive slip [rad/s].
    use : array (T, N)
        Share of each wheel's drive grip, 0 … 1.
    wheels : tuple of str
        Names of the wheels.
    """

    t_s: Array
    pose: Array
    velocity: Array
    acceleration: Array
    omega: Array
    use: Array
    wheels: tuple[str, ...]

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t_s", frozen("t_s", self.t_s, (None,)))
        t, n = len(self.t_s), len(self.wheels)
        shapes: dict[str, tuple[int | None, ...]] = {
            "pose": (t, 3),
            "velocity": (t, 3),
            "acceleration": (t, 3),
            "omega": (t, n),
            "use": (t, n),
        }
        for name, shape in shapes.items():
            put(self, name, frozen(name, getattr(self, name), shape))
        if t < 2 or float(np.min(np.diff(self.t_s))) <= 0.0:
            raise InputError(
                "t_s", "does not increase from sample to sample", "give at least two increasing times"
            )

    @property
    def duration_s(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.t_s[-1] - self.t_s[0])

    def columns(self) -> dict[str, Array]:
        """Columns of the trajectory file, in its order (contract: ``plan``)."""
        out = {"t_s": self.t_s}
        groups = (
            (self.pose, ("x_m", "y_m", "phi_rad")),
            (self.velocity, ("vx_m_s", "vy_m_s", "wz_rad_s")),
            (self.acceleration, ("ax_m_s2", "ay_m_s2", "alpha_rad_s2")),
        )
        for block, names in groups:
            out.update({name: block[:, k] for k, name in enumerate(names)})
        out.update({f"omega{i + 1}_rad_s": self.omega[:, i] for i in range(self.omega.shape[1])})
        out.update({f"use{i + 1}": self.use[:, i] for i in range(self.use.shape[1])})
        return out
