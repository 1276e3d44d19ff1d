"""What the path asks of the body per unit of speed, at places inside every interval of the grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.paths.grid import Grid
from slipmargin.paths.path import Path
from slipmargin.physics.frames import rotate_rows
from slipmargin.physics.kinematics import com_acceleration

#: A robot turns on the spot where its origin moves less than this share of what its wheels do [1].
_ON_THE_SPOT = 0.1


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Profile:
    """(n + 1,) at the grid points: way [m], speed [m/s] and the highest from which the rest can be driven.

    Turning counts as the way of the wheels.
    """

    way_m: Array
    speed_m_s: Array
    highest_m_s: Array


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Geometry:
    """Samples (n, F) along a path: n intervals, F fractions of each.

    ``pose``, ``first`` q' and ``second`` q'' (n, F, 3) in the floor frame; ``twist`` (n, F, 3) is the
    body-frame velocity per ṡ; ``push`` and ``bend`` (n, F, 3) give the body-frame acceleration of the
    centre of mass as push · s̈ + bend · ṡ².
    """

    s: Array
    fractions: Array
    pose: Array
    first: Array
    second: Array
    twist: Array
    push: Array
    bend: Array

    @staticmethod
    def of(model: Model, path: Path, grid: Grid, fractions: Array, *, turned_rad: float = 0.0) -> Geometry:
        """The samples of a grid, of a robot that looks ``turned_rad`` to the left of the path's heading."""
        s, piece = grid.inside(fractions)
        pose, first, second = (a.reshape(*s.shape, 3) for a in path.at(s.ravel(), piece.ravel()))
        pose[..., 2] += turned_rad
        com, phi = model.inertia.com_m, pose[..., 2]
        twist = rotate_rows(phi, first, inverse=True)
        rate, turning = twist.reshape(-1, 3), rotate_rows(phi, second, inverse=True).reshape(-1, 3)
        push = com_acceleration(com, 0.0 * rate, rate).reshape(first.shape)
        bend = com_acceleration(com, rate, turning).reshape(first.shape)
        return Geometry(
            s=s, fractions=fractions, pose=pose, first=first, second=second, twist=twist, push=push, bend=bend
        )

    def floor_rates(self, reach_m: float) -> Array:
        """(2,) way over the floor per s at start and end; the wheels' where the robot turns on the spot."""
        ends = self.first[[0, -1], [0, -1]]
        floor = np.hypot(*ends[:, :2].T)
        wheels = np.hypot(floor, reach_m * ends[:, 2])
        return np.where(floor > _ON_THE_SPOT * wheels, floor, wheels)

    def profile(self, reach_m: float, x: Array, highest: Array) -> Profile:
        """What ṡ² (n + 1,) are as speeds, for fractions 0, ½ and 1; wheels stand ``reach_m`` away."""
        rates = np.sqrt(np.sum(self.first[..., :2] ** 2, axis=2) + (reach_m * self.first[..., 2]) ** 2)
        steps = (self.s[:, -1] - self.s[:, 0]) * (rates @ np.array([1.0, 4.0, 1.0])) / 6.0
        each = np.append(rates[:, 0], rates[-1, -1])
        speed, most = (each * np.sqrt(np.maximum(squared, 0.0)) for squared in (x, highest))
        return Profile(way_m=np.append(0.0, np.cumsum(steps)), speed_m_s=speed, highest_m_s=most)

    def squared_speed(self, x: Array) -> Array:
        """ṡ² (n, F) inside every interval: linear between the grid points."""
        return np.maximum(x[:-1, None] + self.fractions * (x[1:] - x[:-1])[:, None], 0.0)

    def motion(self, x: Array, u: Array | None, time: Array | None = None, scale: float = 1.0) -> Motion:
        """The samples (n F) as states, at ``scale`` times the speeds of a profile."""
        sq = self.squared_speed(x)
        speed = np.sqrt(sq)[..., None]
        acceleration = None
        if u is not None:
            floor = self.first * u[:, None, None] + self.second * sq[..., None]
            acceleration = rotate_rows(self.pose[..., 2], floor, inverse=True).reshape(-1, 3)
        return Motion(
            velocity=(self.twist * speed * scale).reshape(-1, 3),
            heading=self.pose[..., 2].ravel(),
            position=self.pose[..., :2].reshape(-1, 2),
            time_s=None if time is None else time.ravel(),
            acceleration=acceleration,
        )

    def saturated(self) -> Motion:
        """The samples as states at a speed at which the drag is full."""
        return Motion(
            velocity=self.twist.reshape(-1, 3),
            heading=self.pose[..., 2].ravel(),
            position=self.pose[..., :2].reshape(-1, 2),
            saturated=True,
        )

    def times(self, x: Array, u: Array) -> Array:
        """Time (n, F) [s] at which the profile passes each sample."""
        root = np.sqrt(np.maximum(x, 0.0))
        step = (self.s[:, -1] - self.s[:, 0]) / (self.fractions[-1] - self.fractions[0])
        start = np.concatenate([[0.0], np.cumsum(2.0 * step / np.maximum(root[1:] + root[:-1], 1e-12))])[:-1]
        here = np.sqrt(self.squared_speed(x))
        return np.asarray(
            start[:, None]
            + 2.0 * (self.fractions * step[:, None]) / np.maximum(here + root[:-1, None], 1e-12)
        )
