"""A run: a motion that was simulated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index, frozen
from slipmargin.errors import InputError


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Run:
    """T samples of a simulated motion.

    Parameters
    ----------
    t_s : array (T,)
        Time [s], ascending.
    pose : array (T, 3)
        x [m], y [m], φ [rad] of the body frame's origin in the floor frame.
    velocity : array (T, 3)
        Its derivative, in the floor frame [m/s, m/s, rad/s].
    theta : array (T, N)
        Wheel angles [rad].
    slip : array (T, N, 2)
        Sliding velocity along ĝ (drive) and f̂ (transverse) [m/s].
    force : array (T, N, 2)
        Force of the floor on the wheel along ĝ and f̂ [N].
    load : array (T, N)
        Load on each wheel [N].
    utilisation : array (T, N)
        Share of each wheel's drive grip in use [1]: |friction along ĝ| over what the coefficient at that
        instant and the transverse force leave; it slips where it nears 1.
    wheels : tuple of str
        Names of the wheels.
    in_air_s : array (N,)
        For how long each wheel hung in the air while three others or more carried the robot [s].
    lifts_s : float or None
        When the first of them lifted [s]; None where all wheels pressed all the time.
    """

    t_s: Array
    pose: Array
    velocity: Array
    theta: Array
    slip: Array
    force: Array
    load: Array
    utilisation: Array
    wheels: tuple[str, ...]
    in_air_s: Array
    lifts_s: float | None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "t_s", frozen("t_s", self.t_s, (None,)))
        t, n = len(self.t_s), len(self.wheels)
        shapes: dict[str, tuple[int | None, ...]] = {
            "pose": (t, 3),
            "velocity": (t, 3),
            "theta": (t, n),
            "slip": (t, n, 2),
            "force": (t, n, 2),
            "load": (t, n),
            "utilisation": (t, n),
            "in_air_s": (n,),
        }
        for name, shape in shapes.items():
            put(self, name, frozen(name, getattr(self, name), shape))
        if t == 0 or (t > 1 and float(np.min(np.diff(self.t_s))) < 0.0):
            raise InputError("t_s", "is empty or goes back in time", "give ascending times")

    def take(self, rows: Index) -> Run:
        """The same motion at some of its samples."""
        sampled = ("t_s", "pose", "velocity", "theta", "slip", "force", "load", "utilisation")
        return replace(self, **{name: getattr(self, name)[rows] for name in sampled})

    @property
    def duration_s(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.t_s[-1] - self.t_s[0])

    @property
    def friction_power_W(self) -> Array:
        """(T,) power that sliding takes from the motion, Σ F_i·u_i [W]; never positive."""
        return np.asarray(np.einsum("tnk,tnk->t", self.force, self.slip))

    def columns(self) -> dict[str, Array]:
        """Columns of the run file, in its order (contract: ``simulate``)."""
        out = {"t_s": self.t_s}
        for block, names in (
            (self.pose, ("x_m", "y_m", "phi_rad")),
            (self.velocity, ("vx_m_s", "vy_m_s", "wz_rad_s")),
        ):
            out.update({name: block[:, k] for k, name in enumerate(names)})
        wheel = (
            ("theta{}_rad", self.theta),
            ("slip_drive{}_m_s", self.slip[..., 0]),
            ("slip_transverse{}_m_s", self.slip[..., 1]),
            ("force_drive{}_N", self.force[..., 0]),
            ("force_transverse{}_N", self.force[..., 1]),
        )
        for name, block in wheel:
            out.update({name.format(i + 1): block[:, i] for i in range(block.shape[1])})
        return out
