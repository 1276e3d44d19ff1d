"""What simulators need of a robot, in the axes of REP 103: where wheels are, which way they grip, and how
hard."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.effects import Recipe
from slipmargin.effects.turned import recipe_in
from slipmargin.model import Model
from slipmargin.physics.convention import Convention
from slipmargin.physics.friction_laws import law_slope

#: Share of the mass that the wheels are given: a robot file does not say it, and light wheels change nothing.
LIGHT = 0.02
#: Inertias about level axes as a share of the yaw inertia: a robot file does not say them.
LEVEL_INERTIA = 0.6


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimWheel:
    """A wheel: x forward, y left, z up from the floor below the origin [m]; directions are unit vectors
    (2,)."""

    name: str
    place_m: tuple[float, float, float]
    drive: tuple[float, float]  #: where a positive speed drives
    drive_rad: float
    roller_rad: float
    grip: tuple[float, float]  #: the roller's axle on the floor: friction ``mu`` along it, ``mu2`` across
    radius_m: float
    mu: float
    mu2: float
    slip1: float  #: slip speed a newton of friction along the grip [m/(N s)]
    slip2: float
    load_N: float  #: at rest
    mass_kg: float
    stall_torque_N_m: float | None

    @property
    def axle(self) -> tuple[float, float]:
        """The axis about which a positive speed turns it: left of the drive direction."""
        return -self.drive[1] + 0.0, self.drive[0]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SimRobot:
    """A robot as its simulator has it: a chassis without the wheels, and the wheels; SI, REP 103."""

    name: str
    surface: str
    wheels: tuple[SimWheel, ...]
    chassis_kg: float
    com_m: tuple[float, float, float]  #: of the chassis
    yaw_inertia_kg_m2: float  #: of the chassis about its own centre of mass
    max_speed_rad_s: float | None
    left_out: tuple[str, ...]


def sim_robot(recipe: Recipe, surface: str) -> SimRobot:
    """The robot with its effects on a surface, and what a simulator's file does not hold.

    The slip compliance is the slope of the friction law at rest: 1/(μ N k s) with the law's slope s.
    """
    turned = recipe_in(recipe, Convention.ROS)
    model = turned.build(surface)
    g, body = model.geometry, model.inertia
    each = LIGHT * body.mass_kg / model.count
    slope = float(law_slope(model.grip.law, np.zeros(1))[0]) * model.grip.k_s_per_m
    wheels, stall = [], model.drives.stall_torques(model.count)
    for i, wheel in enumerate(turned.robot.wheels):
        mu, mu2 = (float(v) for v in model.grip.roller[i])
        load = float(model.loads.rest_N[i])
        drive = -g.drive[i]
        wheels.append(
            SimWheel(
                name=wheel.name,
                place_m=(float(g.position_m[i, 0]), float(g.position_m[i, 1]), float(g.radius_m[i])),
                drive=(float(drive[0]), float(drive[1])),
                drive_rad=math.atan2(drive[1], drive[0]),
                roller_rad=math.radians(wheel.roller_angle_deg),
                grip=(float(g.grip[i, 0]), float(g.grip[i, 1])),
                radius_m=float(g.radius_m[i]),
                mu=mu,
                mu2=mu2,
                slip1=_compliance(mu * load * slope),
                slip2=_compliance(mu2 * load * slope),
                load_N=load,
                mass_kg=each,
                stall_torque_N_m=float(stall[i]) if math.isfinite(stall[i]) else None,
            )
        )
    chassis, com, inertia = _chassis(model, wheels, each)
    return SimRobot(
        name=turned.robot.name,
        surface=surface,
        wheels=tuple(wheels),
        chassis_kg=chassis,
        com_m=com,
        yaw_inertia_kg_m2=inertia,
        max_speed_rad_s=model.drives.max_speed_rad_s,
        left_out=tuple(_left_out(model)),
    )


def _compliance(slope_N_s_per_m: float) -> float:
    return 1.0 / slope_N_s_per_m if slope_N_s_per_m > 0.0 else 0.0


def _chassis(
    model: Model, wheels: list[SimWheel], each: float
) -> tuple[float, tuple[float, float, float], float]:
    """Mass, centre of mass and yaw inertia of what is left of the robot without its wheels."""
    body = model.inertia
    rest = body.mass_kg - each * len(wheels)
    place: Array = np.array([w.place_m for w in wheels])
    whole = body.mass_kg * np.array([*body.com_m, body.com_height_m])
    centre = (whole - each * place.sum(axis=0)) / rest
    arms = float(np.sum((place[:, :2] - body.com_m) ** 2))
    own = sum(0.25 * w.radius_m**2 for w in wheels)
    offset = float(np.sum((centre[:2] - body.com_m) ** 2))
    yaw = body.inertia_kg_m2 - each * (arms + own) - rest * offset
    x, y, z = (float(v) + 0.0 for v in centre)
    return rest, (x, y, z), max(yaw, 0.01 * body.inertia_kg_m2)


def _left_out(model: Model) -> list[str]:
    """What limits depend on and the file cannot say."""
    out = []
    if np.any(model.grip.rigid_fraction > 0.0):
        out.append("the rigid material between rollers: every wheel always stands on rollers")
    if model.grip.multipliers:
        out.append("friction that depends on place, speed, load or time")
    if model.external.terms:
        out.append("forces on the body that are not wheel friction")
    if model.external.reliefs:
        out.append("ramps, ridges and bumps of the floor")
    if model.grip.viscous_N_s_per_m.any():
        out.append("viscous friction of the wheels")
    return out


def number(value: float) -> str:
    """A number in a simulator's file."""
    return f"{value + 0.0:.9g}"


def numbers(*values: float) -> str:
    """Numbers in a simulator's file, with blanks between."""
    return " ".join(number(v) for v in values)
