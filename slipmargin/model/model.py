"""A model: one part of each kind, built from a robot and a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.model.loads import nominal_loads
from slipmargin.model.parts import (
    ActuatorDynamics,
    Drives,
    ExternalWrench,
    Grip,
    Inertia,
    MeasurementModel,
)
from slipmargin.physics.friction_laws import law_number
from slipmargin.physics.kinematics import WheelGeometry
from slipmargin.physics.loads import Loads
from slipmargin.robot import Convention, Motor, Robot


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Model:
    """Everything limits, paths and the simulator may know of a machine.

    They see parts, never the effects that wrote them.
    """

    robot: str
    surface: str
    inertia: Inertia
    geometry: WheelGeometry
    loads: Loads
    grip: Grip
    external: ExternalWrench
    drives: Drives
    actuators: ActuatorDynamics
    measurement: MeasurementModel
    convention: Convention = Convention.PAPER  #: for words and pictures; no equation needs it

    @property
    def count(self) -> int:
        """Number of wheels N."""
        return self.geometry.count

    @property
    def reach_m(self) -> float:
        """Mean distance of the wheels from the centre of mass [m], at which a yaw moment is a force."""
        return float(np.mean(np.hypot(*(self.geometry.position_m - self.inertia.com_m).T)))

    def grip_torques_N_m(self) -> Array:
        """(N,) torque about each wheel's axle with which it slides in both its directions, at rest [N m]."""
        arms = np.abs(self.geometry.torque_arms()).T
        return np.asarray(np.sum(self.grip.roller * arms, axis=1) * self.loads.rest_N)

    def wrench_maps(self) -> tuple[Array, Array]:
        """B_W and B_T of eqs (14)–(15), each (3, N), about the centre of mass, body frame.

        Column i is the wrench of a unit force of wheel i along ĝ_i (or f̂_i).
        """
        return self.geometry.wrench_maps(self.inertia.com_m)


def nominal_model(robot: Robot, surface_name: str) -> Model:
    """The paper's model of a robot on one of its surfaces, before any effect.

    Raises
    ------
    InputError
        If the surface is not described or the loads are not possible.
    """
    surface = robot.surface(surface_name)
    n = len(robot.wheels)
    return Model(
        robot=robot.name,
        surface=surface_name,
        inertia=Inertia(
            mass_kg=robot.body.mass_kg,
            inertia_kg_m2=robot.body.inertia_kg_m2,
            com_m=robot.body.com_m,
            com_height_m=robot.body.com_height_m,
        ),
        geometry=robot.geometry,
        loads=nominal_loads(robot),
        grip=Grip(
            roller=np.tile([surface.roller.drive, surface.roller.transverse], (n, 1)),
            rigid=np.tile([surface.rigid.drive, surface.rigid.transverse], (n, 1)),
            rollers=np.array([w.rollers for w in robot.wheels], dtype=float),
            rigid_fraction=np.array([w.rigid_fraction for w in robot.wheels]),
            law=law_number(robot.friction.name),
            k_s_per_m=robot.friction.k_s_per_m,
            shape=robot.friction.grip,
        ),
        external=ExternalWrench(),
        drives=_drives(robot.motor),
        actuators=ActuatorDynamics.none(n),
        measurement=MeasurementModel.ideal(),
        convention=robot.convention,
    )


def _drives(motor: Motor | None) -> Drives:
    if motor is None:
        return Drives()
    speed, stall, inertia = motor.at_the_wheel()
    return Drives(max_speed_rad_s=speed, stall_torque_N_m=stall, wheel_inertia_kg_m2=inertia)
