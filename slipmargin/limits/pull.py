"""What pulls at the robot: direction, point of application, height, a moment with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.model import Model
from slipmargin.physics.frames import moment, to_body


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pull:
    """An external force on a robot at rest, as in eqs (12)–(18) and beyond them.

    The default is the paper's: along +x of the floor, through the centre of mass, at the floor's
    height.  A robot that pushes along a direction is pulled along the opposite one.

    Parameters
    ----------
    direction_rad : float
        Direction of the force in the floor frame [rad].
    point_m : (2,), optional
        Point of application in the body frame [m]; the centre of mass by default.
    height_m : float
        Height of the point above the floor [m]; the pull then shifts load: Σ N_i p_i moves by height × F.
    moment_m : float
        A moment that comes with the force, per newton [N m / N].
    pure_moment : float
        +1 or −1: a pure moment instead of a force, counter-clockwise or clockwise; limits are then in N m.
        0 (the default): a force.
    """

    direction_rad: float = 0.0
    point_m: Array | None = None
    height_m: float = 0.0
    moment_m: float = 0.0
    pure_moment: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "direction_rad", real("direction_rad", self.direction_rad, cure="give an angle [rad]"))
        put(self, "height_m", real("height_m", self.height_m, low=0.0, cure="give a height ≥ 0 [m]"))
        put(self, "moment_m", real("moment_m", self.moment_m, cure="give a lever arm [m]"))
        if self.point_m is not None:
            put(self, "point_m", frozen("point_m", self.point_m, (2,)))

    def rays(self, model: Model, phi_rad: Array) -> Array:
        """(M, 3) wrench on the body per newton of pull at headings φ (M,), about the centre of mass."""
        if self.pure_moment:
            return np.tile([0.0, 0.0, np.sign(self.pure_moment)], (len(phi_rad), 1))
        x, y = to_body(phi_rad, np.cos(self.direction_rad), np.sin(self.direction_rad))
        arm = np.zeros(2) if self.point_m is None else self.point_m - model.inertia.com_m
        return np.stack([x, y, moment(arm[0], arm[1], x, y) + self.moment_m], axis=-1)

    def load_change(self, model: Model, rays: Array) -> Array:
        """(M, N) change of each wheel's load per newton of pull: S (0, h d) with d the ray's force."""
        if self.height_m == 0.0:
            return np.zeros((len(rays), model.count))
        return np.asarray(self.height_m * rays[:, :2] @ model.loads.per_moment_1_per_m.T)
