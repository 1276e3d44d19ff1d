"""A model: one part of each kind, built from a robot and a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.model.loads import nominal_loads
from slipmargin.model.parts import (
    Contacts,
    Drives,
    Grip,
    Inertia,
    Loads,
    Losses,
    Sensing,
    Transients,
)
from slipmargin.robot import Robot


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Model:
    """Everything limits, paths and the simulator may know of a machine.

    They see parts, never the effects that wrote them.
    """

    robot: str
    surface: str
    inertia: Inertia
    contacts: Contacts
    loads: Loads
    grip: Grip
    losses: Losses
    drives: Drives
    transients: Transients
    sensing: Sensing

    @property
    def count(self) -> int:
        """Number of wheels N."""
        return self.contacts.count

    def wrench_maps(self) -> tuple[Array, Array]:
        """B_W and B_T of eqs (14)–(15), each (3, N), about the centre of mass, body frame.

        Column i is the wrench of a unit force of wheel i along ĝ_i (or f̂_i).
        """
        arm = self.contacts.position_m - self.inertia.com_m
        return _columns(arm, self.contacts.grip), _columns(arm, self.contacts.free)


def _columns(arm: Array, direction: Array) -> Array:
    moment = arm[:, 0] * direction[:, 1] - arm[:, 1] * direction[:, 0]
    return np.vstack([direction.T, moment])


def nominal_model(robot: Robot, surface_name: str) -> Model:
    """The paper's model of a robot on one of its surfaces, before any effect.

    Raises
    ------
    InputError
        If the surface is not described or the loads are not possible.
    """
    surface = robot.surface(surface_name)
    n = len(robot.wheels)
    drive = np.deg2rad([w.drive_direction_deg for w in robot.wheels])
    grip = drive + np.deg2rad([w.roller_angle_deg for w in robot.wheels])
    contacts = Contacts(
        names=tuple(w.name for w in robot.wheels),
        position_m=np.array([w.position_m for w in robot.wheels]),
        drive=_unit(drive),
        grip=_unit(grip),
        free=_unit(grip - np.pi / 2),  # ŝ = ẑ × r̂
        radius_m=np.array([w.radius_m for w in robot.wheels]),
    )
    motor = robot.motor
    return Model(
        robot=robot.name,
        surface=surface_name,
        inertia=Inertia(
            mass_kg=robot.body.mass_kg,
            inertia_kg_m2=robot.body.inertia_kg_m2,
            com_m=robot.body.com_m,
            com_height_m=robot.body.com_height_m,
        ),
        contacts=contacts,
        loads=nominal_loads(robot),
        grip=Grip(
            roller=np.tile([surface.roller.drive, surface.roller.transverse], (n, 1)),
            rigid=np.tile([surface.rigid.drive, surface.rigid.transverse], (n, 1)),
            rollers=np.array([w.rollers for w in robot.wheels], dtype=float),
            rigid_fraction=np.array([w.rigid_fraction for w in robot.wheels]),
            k_s_per_m=robot.friction.k_s_per_m,
            shape=robot.friction.grip,
        ),
        losses=Losses(),
        drives=Drives()
        if motor is None
        else Drives(max_speed_rad_s=motor.max_speed_rad_s, stall_torque_N_m=motor.stall_torque_N_m),
        transients=Transients.none(n),
        sensing=Sensing.ideal(),
    )


def _unit(angle: Array) -> Array:
    # Rounded to a part in 10¹⁵ so that right angles are exact and parallel wheels stay parallel.
    return np.round(np.stack([np.cos(angle), np.sin(angle)], axis=1), 15)
