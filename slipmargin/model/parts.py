"""The machine as mathematics: frozen parts, arrays only.

Wrenches are (Fx, Fy, Mz) in the body frame about the centre of mass [N, N, N m].
Wheel i grips along ĝ_i and rolls freely along f̂_i (theory, section 1):
omni ĝ = ŝ, f̂ = r̂ (the axle); mecanum: both turned by the roller angle.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np

from slipmargin.checks import GRAVITY_M_S2, Array, frozen
from slipmargin.errors import InputError
from slipmargin.model.terms import ForceTerm, Modulation, PoseShift
from slipmargin.robot import GripShape


def _freeze(part: object, **shapes: tuple[int | None, ...]) -> None:
    for name, shape in shapes.items():
        object.__setattr__(part, name, frozen(name, getattr(part, name), shape))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inertia:
    """Mass [kg], yaw inertia about the centre of mass [kg m²], its place (2,) and height [m]."""

    mass_kg: float
    inertia_kg_m2: float
    com_m: Array
    com_height_m: float

    def __post_init__(self) -> None:
        _freeze(self, com_m=(2,))

    @property
    def weight_N(self) -> float:
        """m g [N]."""
        return self.mass_kg * GRAVITY_M_S2


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contacts:
    """Where the wheels stand and which way they grip; every vector array is (N, 2)."""

    names: tuple[str, ...]
    position_m: Array
    drive: Array
    grip: Array
    free: Array
    radius_m: Array

    def __post_init__(self) -> None:
        n = len(self.names)
        _freeze(self, position_m=(n, 2), drive=(n, 2), grip=(n, 2), free=(n, 2), radius_m=(n,))

    @property
    def count(self) -> int:
        """Number of wheels N."""
        return len(self.names)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Loads:
    """Wheel loads N_i = rest_i + per_acceleration_i · a, with a the body-frame acceleration.

    ``rest_N`` (N,), ``per_acceleration_kg`` (N, 2).  ``rule`` says in words where they come from
    (for N > 3 wheels: equal suspension stiffness).  ``centred`` is the share of the way that the
    centre of mass goes from where the file puts it to where these loads' resultant acts: on a level
    floor the two are one point.
    """

    rest_N: Array
    per_acceleration_kg: Array
    rule: str
    centred: float = 0.0

    def __post_init__(self) -> None:
        n = len(np.asarray(self.rest_N))
        _freeze(self, rest_N=(n,), per_acceleration_kg=(n, 2))
        if float(np.min(self.rest_N)) < -1e-12:
            worst = int(np.argmin(self.rest_N))
            raise InputError(
                "loads",
                f"wheel {worst + 1} would carry {self.rest_N[worst]:.3g} N at rest",
                "move the centre of mass inside the wheels' contact polygon",
            )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grip:
    """Friction of each wheel: coefficients (N, 2) [drive, transverse] on rollers and on rigid.

    Angle θ stands on rigid material where θ mod 2π/n ≥ (1 − rigid_fraction)·2π/n, with n ``rollers``
    (both (N,)).  Eq. (11) has steepness ``k_s_per_m``; ``modulations`` multiply; the force lies in
    the Minkowski sum (1 − ``coupling``)·box ⊕ ``coupling``·``shape`` (theory, three grip sets);
    ``viscous_N_s_per_m`` (2,) adds −c u along ĝ and f̂ on every wheel.
    """

    roller: Array
    rigid: Array
    rollers: Array
    rigid_fraction: Array
    k_s_per_m: float
    shape: GripShape = GripShape.BOX
    coupling: float = 1.0
    modulations: tuple[Modulation, ...] = ()
    viscous_N_s_per_m: Array = field(default_factory=lambda: np.zeros(2))

    def __post_init__(self) -> None:
        n = len(np.asarray(self.roller))
        _freeze(self, roller=(n, 2), rigid=(n, 2), rollers=(n,), rigid_fraction=(n,), viscous_N_s_per_m=(2,))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Losses:
    """Forces on the body that are not wheel friction."""

    terms: tuple[ForceTerm, ...] = ()


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Drives:
    """Motor limits on the wheel side; ``None`` where no limit is known."""

    max_speed_rad_s: float | None = None
    stall_torque_N_m: float | None = None


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Transients:
    """From commanded to real wheel speed: τ ω̇_i = gain_i ω_cmd,i(t − delay) − droop_i T_i − ω_i.

    ``lag_s`` (N,) τ [s], ``gain`` (N,) [1], ``droop_rad_s_per_N_m`` (N,) speed lost per torque T_i
    that the wheel delivers [rad/(s N m)], ``delay_s`` [s].  ``modulations`` multiply ω_cmd,i over
    COMMAND_SPEED or TIME.  They act only where wheel speeds are commanded, not where measured.
    """

    lag_s: Array
    gain: Array
    droop_rad_s_per_N_m: Array
    delay_s: float = 0.0
    modulations: tuple[Modulation, ...] = ()

    def __post_init__(self) -> None:
        n = len(np.asarray(self.lag_s))
        _freeze(self, lag_s=(n,), gain=(n,), droop_rad_s_per_N_m=(n,))

    @staticmethod
    def none(count: int) -> Transients:
        """Wheels that do at once what they are told."""
        return Transients(lag_s=np.zeros(count), gain=np.ones(count), droop_rad_s_per_N_m=np.zeros(count))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensing:
    """From the true pose to the measured one.

    Measured position = ``scale`` ∘ R(``rotation_rad``) (p + R(φ) ``marker_m``), measured heading =
    ``heading_gain`` φ, both read ``delay_s`` late;
    ``warps`` add (Δx, Δy, Δφ) [m, m, rad] over a variable of the pose or time.
    """

    scale: Array
    rotation_rad: float
    heading_gain: float
    delay_s: float
    marker_m: Array
    warps: tuple[PoseShift, ...] = ()

    def __post_init__(self) -> None:
        _freeze(self, scale=(2,), marker_m=(2,))

    @staticmethod
    def ideal() -> Sensing:
        """A camera and encoders without fault."""
        return Sensing(
            scale=np.ones(2), rotation_rad=0.0, heading_gain=1.0, delay_s=0.0, marker_m=np.zeros(2)
        )
