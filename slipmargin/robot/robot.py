"""A robot as a data sheet: body, wheels, motor, surfaces.

Body frame {M}: +Z up, angles counter-clockwise positive; which axis is the front says the robot's
``convention`` (:mod:`slipmargin.physics.convention`; by default +Y is the front and +X points right).
Every value is SI; a key's name ends in its unit.  What each field means, which values it takes and how
the robot file spells it stands in its metadata (:mod:`slipmargin.robot.fields`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import directions, moment
from slipmargin.physics.kinematics import WheelGeometry
from slipmargin.physics.loads import LoadRule
from slipmargin.robot.fields import check, number, numbers, text, whole, word
from slipmargin.robot.floor import FrictionLaw, Surface
from slipmargin.robot.motor import Motor

#: A roller angle above 0 and below this is radians [deg]: a quarter turn has 1.571.
_RADIANS = 1.6


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """Rigid body: mass, yaw inertia, place of the centre of mass."""

    mass_kg: float = field(
        metadata=number(
            "kg", "mass of the robot with everything on it", 1e-3, 1e6, uncertain=True, vary=("mass_kg",)
        )
    )
    inertia_kg_m2: float = field(
        metadata=number(
            "kg m²",
            "yaw inertia about the centre of mass",
            1e-9,
            1e9,
            uncertain=True,
            vary=("inertia_kg_m2",),
        )
    )
    com_m: Array = field(
        default_factory=lambda: np.zeros(2),
        metadata=numbers(
            "m",
            "centre of mass from the body frame's origin, along the body's x and y",
            2,
            -1e3,
            1e3,
            reason="between the wheels, else the robot falls over",
            uncertain=True,
            vary=("com_x_m", "com_y_m"),
        ),
    )
    com_height_m: float = field(
        default=0.0,
        metadata=number(
            "m",
            "height of the centre of mass above the floor",
            0.0,
            1e3,
            uncertain=True,
            vary=("com_height_m",),
        ),
    )

    def __post_init__(self) -> None:
        check(self)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wheel:
    """One omni (roller angle 0) or mecanum (±45°) wheel.

    ``drive_direction_deg`` is the direction of ŝ in the body frame; the axle is perpendicular.
    In the paper's convention a positive ``theta`` rate moves the contact point along it (eq. 3), in that of
    ROS it drives the robot along it.
    """

    name: str = field(metadata=text("name of the wheel, another for each"))
    position_m: Array = field(
        metadata=numbers(
            "m", "wheel centre from the body frame's origin, along the body's x and y", 2, -1e3, 1e3
        )
    )
    drive_direction_deg: float = field(
        metadata=number(
            "deg",
            "direction in which the wheel drives, counter-clockwise from +x; the axle is perpendicular",
            -3600.0,
            3600.0,
        )
    )
    radius_m: float = field(
        metadata=number("m", "radius", 1e-4, 1e3, reason="a radius is positive", vary=("wheel_radius_m",))
    )
    roller_angle_deg: float = field(
        default=0.0,
        metadata=number(
            "deg",
            "from the drive direction to the grip direction, counter-clockwise",
            -80.0,
            80.0,
            reason="0 is an omni wheel, 45 or -45 a mecanum wheel; at 90 a wheel could not drive",
            vary=("roller_angle_deg",),
        ),
    )
    rollers: int = field(default=8, metadata=whole("1", "rollers round the wheel", 1, 1000))
    rigid_fraction: float = field(
        default=0.0,
        metadata=number(
            "1",
            "share of the circumference that is rigid material between the rollers",
            0.0,
            1.0,
            vary=("rigid_fraction",),
        ),
    )

    def __post_init__(self) -> None:
        check(self)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Robot:
    """The whole data sheet.

    ``load_fractions`` is given exactly when ``load_rule`` is FIXED.  ``geometry`` follows from the wheels:
    where they stand and which way they grip.
    """

    name: str = field(metadata=text("name of the robot"))
    convention: Convention = field(
        default=Convention.PAPER,
        metadata=word(
            Convention,
            "axes and signs of this file and of everything that is read and written with it",
            (
                "+y is the robot's front, +x its right, φ = 0 faces the floor's +y; a positive wheel speed "
                "moves the contact point along the drive direction, so the robot goes the other way (Fig. 3 "
                "and eq. 3 of the paper)",
                "+x is the robot's front, +y its left, φ = 0 faces the floor's +x (REP 103); a positive "
                "wheel speed drives the robot along the wheel's drive direction",
            ),
        ),
    )
    body: Body
    wheels: tuple[Wheel, ...]
    surfaces: tuple[Surface, ...]
    load_rule: LoadRule = field(
        default=LoadRule.EQUAL,
        metadata=word(
            LoadRule,
            "how the weight is shared between the wheels; left out of a file with `com_height_m` above 0 it "
            'is "quasi-static"',
            (
                "m g / N each, eq. (8) of the paper",
                "by statics from the centre of mass, the same at rest and in motion",
                "by statics from the centre of mass, its height and the acceleration",
                "by the stated fractions of m g",
            ),
            table="loads",
            name="model",
            vary=("load_model",),
        ),
    )
    load_fractions: Array | None = field(
        default=None,
        metadata=numbers(
            "1",
            "each wheel's share of the weight",
            None,
            0.0,
            1.0,
            reason="one for each wheel, together 1",
            uncertain=True,
            table="loads",
            name="fractions",
            needs=(("load_rule", "fixed"),),
        ),
    )
    suspension_N_per_mm: float | None = field(
        default=None,
        metadata=number(
            "N/mm",
            "stiffness between each wheel's contact and the body: suspension, frame and tread in series",
            0.0,
            1e6,
            above=True,
            reason="four wheels and more",
            table="loads",
            needs=(("unevenness_mm", ""),),
        ),
    )
    unevenness_mm: float | None = field(
        default=None,
        metadata=number(
            "mm",
            "how far a wheel's contact may lie above or below the plane of the others, of floor and frame",
            0.0,
            100.0,
            above=True,
            reason="what a feeler gauge shows under the wheel that hangs",
            table="loads",
            needs=(("suspension_N_per_mm", ""),),
        ),
    )
    friction: FrictionLaw = field(default_factory=FrictionLaw)
    motor: Motor | None = None
    geometry: WheelGeometry = field(init=False, repr=False)

    def __post_init__(self) -> None:
        check(self)
        if len(self.wheels) < 3:
            raise InputError(
                "wheel", f"there are {len(self.wheels)} wheels", "describe at least three [[wheel]] tables"
            )
        _unique("wheel", [w.name for w in self.wheels])
        if not self.surfaces:
            raise InputError("surface", "no surface is described", "add a [surface.NAME] table")
        _unique("surface", [s.name for s in self.surfaces])
        object.__setattr__(self, "geometry", _geometry(self.wheels, self.convention))
        self._check_rank()
        self._check_fractions()
        if len(self.wheels) == 3 and self.suspension_N_per_mm is not None:
            raise InputError(
                "loads.suspension_N_per_mm",
                "has no effect on three wheels: statics alone decides their loads, whatever the floor",
                "leave suspension_N_per_mm and unevenness_mm out",
            )

    def _check_rank(self) -> None:
        geometry = self.geometry
        middle = geometry.position_m.mean(axis=0)
        arm = geometry.position_m - middle
        reach = float(np.max(np.hypot(*arm.T)))
        if reach <= 0.0:
            raise InputError("wheel", "all wheels stand on one point", "give each wheel its own position_m")
        wrenches = geometry.wrench_maps(middle)[0] / [[1.0], [1.0], [reach]]
        if _flat(wrenches):
            own, mirrored = (np.abs(lever) / reach for lever in roller_levers(self.wheels))
            if np.max(own) < 1e-6 < np.max(mirrored):
                raise InputError(
                    "wheel",
                    "the rollers' grip lines meet in one point, so the wheels cannot make Mz: "
                    "rollers mounted the wrong way round?",
                    "change the sign of every roller_angle_deg",
                )
            if any(w.roller_angle_deg for w in self.wheels):
                read = ", ".join(f"{w.name} {w.roller_angle_deg:g}" for w in self.wheels)
                raise InputError(
                    "wheel",
                    f"with roller_angle_deg of {read} the rollers cannot make all of Fx, Fy and Mz",
                    radians_cure(self.wheels)
                    or "give mecanum wheels about 45 or -45 degrees, the same across each diagonal and the "
                    "other sign beside it (from above, the upper rollers make an X)",
                )
            raise InputError(
                "wheel",
                "the grip directions cannot make all of Fx, Fy and Mz",
                "turn or move a wheel so that the three are independent",
            )
        if _flat(np.column_stack([np.ones(len(arm)), arm / reach])):
            raise InputError(
                "wheel", "all wheels stand on one line", "move a wheel: a robot on a line falls over"
            )

    def _check_fractions(self) -> None:
        if self.load_rule is not LoadRule.FIXED:
            return
        if self.load_fractions is None:
            raise InputError(
                "loads.fractions", "is missing", 'model = "fixed" needs one share for each wheel'
            )
        if len(self.load_fractions) != len(self.wheels) or not math.isclose(
            self.load_fractions.sum(), 1.0, abs_tol=1e-6
        ):
            raise InputError(
                "loads.fractions",
                f"is {self.load_fractions.tolist()}",
                f"give {len(self.wheels)} shares, one for each wheel, that add up to 1",
            )

    def surface(self, name: str) -> Surface:
        """The surface called ``name``; the error lists the names that exist."""
        for surface in self.surfaces:
            if surface.name == name:
                return surface
        known = ", ".join(s.name for s in self.surfaces)
        raise InputError(
            "surface", f"{name!r} is not described for robot {self.name!r}", f"use one of: {known}"
        )


def radians_cure(wheels: tuple[Wheel, ...]) -> str:
    """What to write where a roller angle looks like radians; empty where none does."""
    small = next((a for w in wheels if 0.0 < (a := abs(w.roller_angle_deg)) < _RADIANS), None)
    if small is None:
        return ""
    return (
        f"give degrees, not radians: {small:g} rad is {math.degrees(small):.3g} degrees, and mecanum wheels "
        "have about 45 or -45 (from above, the upper rollers make an X)"
    )


def roller_levers(wheels: tuple[Wheel, ...]) -> tuple[Array, Array]:
    """Yaw levers (N,) of the grip lines about the wheels' mean position: as mounted, and mirrored [m].

    Mirrored is every roller angle with the other sign.
    """
    place = np.array([w.position_m for w in wheels])
    arm = place - place.mean(axis=0)
    drive, roller = (
        np.deg2rad([getattr(w, f) for w in wheels]) for f in ("drive_direction_deg", "roller_angle_deg")
    )
    one, two = (moment(*arm.T, *directions(drive + sign * roller).T) for sign in (1.0, -1.0))
    return one, two


def _geometry(wheels: tuple[Wheel, ...], convention: Convention) -> WheelGeometry:
    drive = np.deg2rad([w.drive_direction_deg for w in wheels])
    grip = drive + np.deg2rad([w.roller_angle_deg for w in wheels])
    return WheelGeometry(
        names=tuple(w.name for w in wheels),
        position_m=np.array([w.position_m for w in wheels]),
        drive=convention.contact_sign * directions(drive),  # the contact's way where θ̇ > 0
        grip=directions(grip),
        free=directions(grip - np.pi / 2),  # ŝ = ẑ × r̂
        radius_m=np.array([w.radius_m for w in wheels]),
    )


def _unique(place: str, names: list[str]) -> None:
    for i, one in enumerate(names):
        if one in names[:i]:
            first = names.index(one)
            raise InputError(
                f"{place}[{i + 1}].name",
                f"is {one!r}, the name of {place}[{first + 1}]",
                f"give each {place} its own name",
            )


def _flat(rows: Array) -> bool:
    """Whether a matrix has not full rank, to a millionth of its largest singular value."""
    singular = np.linalg.svd(rows, compute_uv=False)
    return bool(singular[-1] < 1e-6 * singular[0])
