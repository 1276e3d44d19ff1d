"""A robot as a data sheet: body, wheels, motor, surfaces.

Body frame {M}: +Y is the front, +X points right, +Z up; angles are counter-clockwise positive.
Every value is SI; keys in the robot file carry the unit (see the README's glossary).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.errors import InputError
from slipmargin.physics.friction_laws import LAWS
from slipmargin.physics.grips import GripShape
from slipmargin.physics.loads import LoadRule

_POSITIVE = "give a positive number"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """Rigid body: mass [kg], yaw inertia about the centre of mass [kg m²], centre of mass [m]."""

    mass_kg: float
    inertia_kg_m2: float
    com_m: Array = field(default_factory=lambda: np.zeros(2))
    com_height_m: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "mass_kg", real("mass_kg", self.mass_kg, low=1e-3, high=1e6, cure="give 0.001 to 1e6 kg"))
        put(
            self,
            "inertia_kg_m2",
            real("inertia_kg_m2", self.inertia_kg_m2, low=1e-9, high=1e9, cure="give 1e-9 to 1e9 kg m²"),
        )
        put(self, "com_m", _place("com_m", self.com_m))
        put(
            self,
            "com_height_m",
            real(
                "com_height_m",
                self.com_height_m,
                low=0.0,
                high=1e3,
                cure="give a height above the floor, 0 to 1000 m",
            ),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wheel:
    """One omni (roller angle 0) or mecanum (±45°) wheel.

    ``drive_direction_deg`` is the direction of ŝ in the body frame; the axle is perpendicular.
    A positive ``theta`` rate moves the contact point of the wheel along +ŝ (eq. 3).
    """

    name: str
    position_m: Array
    drive_direction_deg: float
    radius_m: float
    roller_angle_deg: float = 0.0
    rollers: int = 8
    rigid_fraction: float = 0.0

    def __post_init__(self) -> None:
        put = object.__setattr__
        if not isinstance(self.name, str) or not self.name.strip():
            raise InputError("name", f"is {self.name!r}", "give the wheel a name")
        put(self, "position_m", _place("position_m", self.position_m))
        put(
            self,
            "drive_direction_deg",
            real(
                "drive_direction_deg",
                self.drive_direction_deg,
                low=-3600.0,
                high=3600.0,
                cure="give an angle in degrees, within ±3600",
            ),
        )
        put(self, "radius_m", _radius(self.radius_m))
        put(
            self,
            "roller_angle_deg",
            real(
                "roller_angle_deg",
                self.roller_angle_deg,
                low=-80.0,
                high=80.0,
                cure="give 0 (omni) or ±45 (mecanum), within ±80",
            ),
        )
        if (
            isinstance(self.rollers, bool)
            or not isinstance(self.rollers, int)
            or not 1 <= self.rollers <= 1000
        ):
            raise InputError("rollers", f"is {self.rollers!r}", "give a whole number of rollers, 1 to 1000")
        put(
            self,
            "rigid_fraction",
            real(
                "rigid_fraction",
                self.rigid_fraction,
                low=0.0,
                high=1.0,
                cure="give the rigid share of the circumference, 0 to 1",
            ),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """Optional drive limits on the wheel side; a straight torque–speed line if both are given."""

    max_speed_rad_s: float
    stall_torque_N_m: float | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(
            self,
            "max_speed_rad_s",
            real("max_speed_rad_s", self.max_speed_rad_s, above=0.0, high=1e6, cure=_POSITIVE + " [rad/s]"),
        )
        if self.stall_torque_N_m is not None:
            put(
                self,
                "stall_torque_N_m",
                real(
                    "stall_torque_N_m", self.stall_torque_N_m, above=0.0, high=1e6, cure=_POSITIVE + " [N m]"
                ),
            )


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Coefficients:
    """Friction coefficients along the grip (``drive``) and the free (``transverse``) direction."""

    drive: float
    transverse: float

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(
            self,
            "drive",
            real(
                "drive", self.drive, above=0.0, high=10.0, cure="give a friction coefficient between 0 and 10"
            ),
        )
        put(
            self,
            "transverse",
            real(
                "transverse",
                self.transverse,
                low=0.0,
                high=10.0,
                cure="give a friction coefficient between 0 and 10",
            ),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """A floor: coefficients of a wheel standing on a roller and on rigid material (Table I)."""

    name: str
    roller: Coefficients
    rigid: Coefficients


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionLaw:
    """μ(v) = μ_max σ(k v) by the law ``name`` (eq. 11: atan), and the set the force lies in."""

    name: str = "atan"
    k_s_per_m: float = 1000.0
    grip: GripShape = GripShape.BOX

    def __post_init__(self) -> None:
        if self.name not in LAWS:
            raise InputError("law", f"is {self.name!r}", f"use one of: {', '.join(LAWS)}")
        object.__setattr__(
            self,
            "k_s_per_m",
            real(
                "k_s_per_m",
                self.k_s_per_m,
                above=0.0,
                high=1e6,
                cure="give a steepness between 0 and 1e6 [s/m]",
            ),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robot:
    """The whole data sheet.  ``load_fractions`` is given exactly when ``load_rule`` is FIXED."""

    name: str
    body: Body
    wheels: tuple[Wheel, ...]
    surfaces: tuple[Surface, ...]
    load_rule: LoadRule = LoadRule.EQUAL
    load_fractions: Array | None = None
    friction: FrictionLaw = FrictionLaw()
    motor: Motor | None = None

    def __post_init__(self) -> None:
        if len(self.wheels) < 3:
            raise InputError(
                "wheel", f"there are {len(self.wheels)} wheels", "describe at least three [[wheel]] tables"
            )
        _unique("wheel", [w.name for w in self.wheels])
        if not self.surfaces:
            raise InputError("surface", "no surface is described", "add a [surface.NAME] table")
        _unique("surface", [s.name for s in self.surfaces])
        self._check_rank()
        self._check_fractions()

    def _check_rank(self) -> None:
        grip = np.deg2rad([w.drive_direction_deg + w.roller_angle_deg for w in self.wheels])
        place = np.array([w.position_m for w in self.wheels])
        reach = float(np.max(np.hypot(*(place - place.mean(axis=0)).T)))
        if reach <= 0.0:
            raise InputError("wheel", "all wheels stand on one point", "give each wheel its own position_m")
        lever = (place[:, 0] * np.sin(grip) - place[:, 1] * np.cos(grip)) / reach
        rows = np.stack([np.cos(grip), np.sin(grip), lever])
        singular = np.linalg.svd(rows, compute_uv=False)
        if singular[-1] < 1e-6 * singular[0]:
            raise InputError(
                "wheel",
                "the grip directions cannot make all of Fx, Fy and Mz",
                "turn or move a wheel so that the three are independent",
            )
        corner = np.stack([np.ones(len(place)), place[:, 0] / reach, place[:, 1] / reach])
        if np.linalg.svd(corner, compute_uv=False)[-1] < 1e-6:
            raise InputError(
                "wheel", "all wheels stand on one line", "move a wheel: a robot on a line falls over"
            )

    def _check_fractions(self) -> None:
        fixed = self.load_rule is LoadRule.FIXED
        if fixed != (self.load_fractions is not None):
            raise InputError(
                "loads.fractions",
                "is missing" if fixed else "is given but the load model is not fixed",
                'give fractions exactly with model = "fixed"',
            )
        if self.load_fractions is None:
            return
        fractions = frozen("loads.fractions", self.load_fractions, (len(self.wheels),))
        if fractions.min() < 0.0 or not math.isclose(fractions.sum(), 1.0, abs_tol=1e-6):
            raise InputError(
                "loads.fractions",
                f"is {fractions.tolist()}",
                "give one share ≥ 0 for each wheel, adding up to 1",
            )
        object.__setattr__(self, "load_fractions", fractions)

    def surface(self, name: str) -> Surface:
        """The surface called ``name``; the error lists the names that exist."""
        for surface in self.surfaces:
            if surface.name == name:
                return surface
        known = ", ".join(s.name for s in self.surfaces)
        raise InputError(
            "surface", f"{name!r} is not described for robot {self.name!r}", f"use one of: {known}"
        )


def _place(name: str, value: Array) -> Array:
    """A point (2,) of the body within a kilometre."""
    point = frozen(name, value, (2,))
    if float(np.max(np.abs(point))) > 1e3:
        raise InputError(name, f"is {point.tolist()}", "give a place within 1000 m [m]")
    return point


def _radius(value: float) -> float:
    return real("radius_m", value, low=1e-4, high=1e3, cure="a radius is positive, 0.0001 to 1000 m")


def _unique(place: str, names: list[str]) -> None:
    for name in names:
        if names.count(name) > 1:
            raise InputError(place, f"the name {name!r} is given twice", "give each its own name")
