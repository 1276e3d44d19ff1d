"""The machine as mathematics: frozen parts, arrays only.

Wrenches are (Fx, Fy, Mz) in the body frame about the centre of mass [N, N, N m].
Wheel i grips along ĝ_i and rolls freely along f̂_i (docs/theory.md, section 1):
omni ĝ = ŝ, f̂ = r̂ (the axle); mecanum: both turned by the roller angle.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, read_only, shaped
from slipmargin.errors import InputError
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.physics.friction_laws import ATAN
from slipmargin.physics.grips import GripShape, polyhedral
from slipmargin.physics.relief import Relief
from slipmargin.physics.terms import ForceTerm, Multiplier, PoseShift

#: Inertia of a wheel whose inertia is not stated, as a share of m ρ²/N [1].
LIGHT_WHEEL = 0.001


def _freeze(part: object, **shapes: tuple[int | None, ...]) -> None:
    for name, shape in shapes.items():
        object.__setattr__(part, name, frozen(name, getattr(part, name), shape))


def _upper(bound: Array, shape: tuple[int | None, ...], place: str) -> Array:
    """A read-only copy of upper bounds of each wheel, infinite where there is none."""
    array = shaped(place, bound, shape)
    if not np.all(array > 0.0):
        raise InputError(place, "holds a bound that is not above 0", "give positive numbers, or infinity")
    return read_only(array)


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

    @property
    def diagonal(self) -> Array:
        """(m, m, I) (3,) [kg, kg, kg m²]."""
        return np.array([self.mass_kg, self.mass_kg, self.inertia_kg_m2])


def on_rollers(roller: Array, rigid: Array, rigid_fraction: Array) -> Array:
    """Coefficients (..., N, 2) of wheels on their rollers: those on rigid where a wheel has no rollers."""
    return np.where(np.asarray(rigid_fraction)[..., None] >= 1.0, rigid, roller)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grip:
    """Friction of each wheel: coefficients (N, 2) [drive, transverse] on rollers and on rigid.

    Angle θ stands on rigid material where θ mod 2π/n ≥ (1 − rigid_fraction)·2π/n, with n ``rollers``
    (both (N,)).  Friction follows ``law`` (:mod:`~slipmargin.physics.friction_laws`) with slope
    ``k_s_per_m``; ``multipliers`` multiply; the force lies in
    the Minkowski sum (1 − ``coupling``)·box ⊕ ``coupling``·``shape`` (docs/theory.md, section 2);
    ``viscous_N_s_per_m`` (2,) adds −c u along ĝ and f̂ on every wheel.

    A wheel that is rigid all round (``rigid_fraction`` 1) has no rollers to stand on: its ``roller``
    coefficients are the rigid ones, whatever was given.
    """

    roller: Array
    rigid: Array
    rollers: Array
    rigid_fraction: Array
    k_s_per_m: float
    law: int = ATAN
    shape: GripShape = GripShape.BOX
    coupling: float = 1.0
    multipliers: tuple[Multiplier, ...] = ()
    viscous_N_s_per_m: Array = field(default_factory=lambda: np.zeros(2))

    def __post_init__(self) -> None:
        n = len(np.asarray(self.roller))
        object.__setattr__(self, "roller", on_rollers(self.roller, self.rigid, self.rigid_fraction))
        _freeze(self, roller=(n, 2), rigid=(n, 2), rollers=(n,), rigid_fraction=(n,), viscous_N_s_per_m=(2,))

    @property
    def coupled_part(self) -> float:
        """Part in which the forces along and across take from one another and follow one law [1]."""
        return 0.0 if polyhedral(self.shape, self.coupling) else self.coupling


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalWrench:
    """Forces that are not wheel friction: ``terms`` on the body, those of a floor's ``reliefs`` at wheels."""

    terms: tuple[ForceTerm, ...] = ()
    reliefs: tuple[Relief, ...] = ()


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drives:
    """Motor limits and the inertia of a wheel with its rotor, at the wheel; ``None`` where not known.

    A commanded wheel's torque keeps to ± stall (1 ∓ ω/max_speed).  ``stall_torque_N_m`` is that of every
    wheel, or (N,) where they differ, infinite for a wheel of which it is not known.  Where no
    ``wheel_inertia_kg_m2`` is given, a simulation takes :data:`LIGHT_WHEEL` of m ρ²/N, a robot's mass as each
    of its wheels feels it: so little that the motion does not depend on it, and enough to keep the equations
    solvable.
    """

    max_speed_rad_s: float | None = None
    stall_torque_N_m: float | Array | None = None
    wheel_inertia_kg_m2: float | None = None

    def __post_init__(self) -> None:
        inertia = self.wheel_inertia_kg_m2
        if inertia is not None and not 0.0 < inertia < np.inf:
            raise InputError("wheel_inertia_kg_m2", f"is {inertia:g}", "give a positive inertia [kg m²]")
        if isinstance(self.stall_torque_N_m, np.ndarray):
            stall = _upper(self.stall_torque_N_m, (None,), "stall_torque_N_m")
            object.__setattr__(self, "stall_torque_N_m", stall)

    def stall_torques(self, count: int) -> Array:
        """(N,) torque of each wheel's motor at standstill [N m]; infinite where it is not known."""
        stall = np.inf if self.stall_torque_N_m is None else self.stall_torque_N_m
        return np.broadcast_to(np.asarray(stall, dtype=float), (count,))

    @property
    def weakest_N_m(self) -> float | None:
        """Torque of the weakest motor at standstill [N m]; None where none is known."""
        return None if self.stall_torque_N_m is None else float(np.min(self.stall_torque_N_m))

    def wheel_inertias(self, mass_kg: float, radius_m: Array) -> Array:
        """(N,) inertia of each wheel [kg m²], stated or light."""
        if self.wheel_inertia_kg_m2 is not None:
            return np.full(len(radius_m), self.wheel_inertia_kg_m2)
        return np.asarray(LIGHT_WHEEL * mass_kg * radius_m**2 / len(radius_m))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ActuatorDynamics:
    """From commanded to real wheel speed: τ ω̇_i = min(gain_i ω_cmd,i(t − delay), top_i) − droop_i T_i − ω_i.

    ``lag_s`` (N,) τ [s], ``gain`` (N,) [1], ``top_rad_s`` (N,) what a wheel reaches either way, infinite by
    default [rad/s], ``droop_rad_s_per_N_m`` (N,) speed lost per torque T_i that the wheel delivers
    [rad/(s N m)], ``delay_s`` [s].  ``ramp_s2_per_rad`` is the time that ω_cmd,i
    takes for a change of 1 rad/s, whatever is asked [s²/rad].  ``multipliers`` multiply it over
    COMMAND_SPEED or TIME.  They act only where wheel speeds are commanded, not where measured.  Where a
    droop or a motor's torque line makes a wheel answer to its load, one without lag follows ω̇_cmd too.

    ``play_rad`` (N,), zero by default, is the whole play between motor and wheel [rad].  It acts on
    measured wheel motions too: their encoder sits on the motor.  Where a wheel answers to its load, the
    play is taken up by what it is asked for.
    """

    lag_s: Array
    gain: Array
    droop_rad_s_per_N_m: Array
    delay_s: float = 0.0
    ramp_s2_per_rad: float = 0.0
    multipliers: tuple[Multiplier, ...] = ()
    play_rad: Array = field(default_factory=lambda: np.zeros(0))
    top_rad_s: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        n = len(np.asarray(self.lag_s))
        for name, none in (("play_rad", 0.0), ("top_rad_s", np.inf)):
            if not len(getattr(self, name)):
                object.__setattr__(self, name, np.full(n, none))
        _freeze(self, lag_s=(n,), gain=(n,), droop_rad_s_per_N_m=(n,), play_rad=(n,))
        object.__setattr__(self, "top_rad_s", _upper(self.top_rad_s, (n,), "top_rad_s"))

    @staticmethod
    def none(count: int) -> ActuatorDynamics:
        """Wheels that do at once what they are told."""
        none = np.zeros(count)
        return ActuatorDynamics(lag_s=none, gain=np.ones(count), droop_rad_s_per_N_m=none)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Lens:
    """A picture that is stretched by 1 + ``bend_per_m2`` d² at the distance d from ``centre_m`` (2,)."""

    bend_per_m2: float
    centre_m: tuple[float, float]

    def shift(self, position: Array) -> Array:
        """How far off positions (..., 2) [m] are seen [m]."""
        off = position - np.array(self.centre_m)
        return np.asarray(self.bend_per_m2 * np.sum(off**2, axis=-1, keepdims=True) * off)

    def slope(self, position: Array) -> Array:
        """How that changes with the position (..., 2, 2) [1]."""
        off = position - np.array(self.centre_m)
        square = np.sum(off**2, axis=-1)[..., None, None]
        return np.asarray(self.bend_per_m2 * (square * np.eye(2) + 2.0 * off[..., None] * off[..., None, :]))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeasurementModel:
    """From the true pose to the measured one.

    Measured position = ``scale`` ∘ R(``rotation_rad``) (p + R(φ) ``marker_m``), measured heading =
    ``heading_gain`` φ, both read ``delay_s`` late; a stated time is in truth ``clock`` times as long;
    ``warps`` add (Δx, Δy, Δφ) [m, m, rad] over a variable of the pose or time, ``lenses`` shift positions.
    """

    scale: Array
    rotation_rad: float
    heading_gain: float
    delay_s: float
    marker_m: Array
    warps: tuple[PoseShift, ...] = ()
    lenses: tuple[Lens, ...] = ()
    clock: float = 1.0

    def __post_init__(self) -> None:
        _freeze(self, scale=(2,), marker_m=(2,))

    @staticmethod
    def ideal() -> MeasurementModel:
        """A camera and encoders without fault."""
        return MeasurementModel(
            scale=np.ones(2), rotation_rad=0.0, heading_gain=1.0, delay_s=0.0, marker_m=np.zeros(2)
        )
