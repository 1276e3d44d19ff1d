"""How the robot moves, as samples: what a limit in motion may know of its state."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array, Index, frozen
from slipmargin.model import Model


class Contact(Enum):
    """What material each wheel stands on (eq. 5)."""

    ROLLERS = "all wheels stand on rollers"
    RIGID = "all wheels stand on rigid material"
    UNKNOWN = "each wheel may stand on either: the worst counts"
    ANGLE = "the wheel angles say"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """M samples of a state.  ``None`` means unknown: a limit then takes the whole interval.

    Parameters
    ----------
    velocity : array (M, 3)
        Body-frame velocity of the body's origin (right, forward) [m/s] and yaw rate [rad/s].
    heading : array (M,), optional
        φ [rad].
    position : array (M, 2), optional
        Floor-frame position of the origin [m].
    time_s : array (M,), optional
        Time since the start of the run [s].
    acceleration : array (M, 3), optional
        Body-frame acceleration of the origin [m/s²] and yaw acceleration [rad/s²].
    theta : array (M, N), optional
        Wheel angles [rad].
    saturated : bool
        Take the drag at its full value with the sign of the transverse slip (zero where a wheel does
        not slide sideways), as if k were infinite: the published limit, independent of the speed.
    """

    velocity: Array
    heading: Array | None = None
    position: Array | None = None
    time_s: Array | None = None
    acceleration: Array | None = None
    theta: Array | None = None
    saturated: bool = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "velocity", frozen("velocity", self.velocity, (None, 3)))
        m = len(self.velocity)
        shapes: dict[str, tuple[int | None, ...]] = {
            "heading": (m,), "position": (m, 2), "time_s": (m,), "acceleration": (m, 3), "theta": (m, None)}
        for name, shape in shapes.items():
            if getattr(self, name) is not None:
                put(self, name, frozen(name, getattr(self, name), shape))

    @property
    def count(self) -> int:
        """Number of samples M."""
        return len(self.velocity)

    def take(self, rows: slice | Array | Index) -> Motion:
        """The samples that ``rows`` selects."""
        picked = {name: value[rows] for name in ("velocity", "heading", "position", "time_s", "acceleration",
                                                 "theta")
                  if (value := getattr(self, name)) is not None}
        return replace(self, **picked)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Kinematics:
    """Rows that turn a body twist (v_x, v_y, ω) of the origin into contact speeds, each (N, 3).

    ``spin`` gives ρ θ̇ of rolling without drive slip, ρ θ̇ ŝ·ĝ = −(v + ω×p)·ĝ; ``slide`` the sliding
    u·f̂ that is then left; ``hub`` (N, 2, 3) the velocity of the wheel's centre.
    """

    spin: Array
    slide: Array
    hub: Array

    @staticmethod
    def of(model: Model) -> Kinematics:
        """The rows of a model (theory, section 1)."""
        c = model.contacts
        n = c.count
        hub = np.zeros((n, 2, 3))
        hub[:, 0, 0] = hub[:, 1, 1] = 1.0
        hub[:, 0, 2], hub[:, 1, 2] = -c.position_m[:, 1], c.position_m[:, 0]
        grip = np.einsum("id,idj->ij", c.grip, hub)
        free = np.einsum("id,idj->ij", c.free, hub)
        along = np.sum(c.drive * c.grip, axis=1, keepdims=True)
        across = np.sum(c.drive * c.free, axis=1, keepdims=True)
        spin = -grip / along
        return Kinematics(spin=spin, slide=free + across * spin, hub=hub)


def wheel_speeds(model: Model, velocity: Array) -> Array:
    """Wheel speeds θ̇ (..., N) [rad/s] that roll without drive slip at body twists (..., 3)."""
    return np.asarray(velocity @ Kinematics.of(model).spin.T / model.contacts.radius_m)


def com_acceleration(model: Model, velocity: Array, acceleration: Array) -> Array:
    """Body-frame acceleration (M, 3) of the centre of mass from that of the origin.

    a_com = a + α ẑ×c − ω² c.
    """
    c, wz, out = model.inertia.com_m, velocity[:, 2], np.array(acceleration, dtype=float)
    out[:, 0] += -acceleration[:, 2] * c[1] - wz**2 * c[0]
    out[:, 1] += acceleration[:, 2] * c[0] - wz**2 * c[1]
    return out


def mass_diagonal(model: Model) -> Array:
    """(m, m, I) (3,) [kg, kg, kg m²]."""
    return np.array([model.inertia.mass_kg, model.inertia.mass_kg, model.inertia.inertia_kg_m2])
