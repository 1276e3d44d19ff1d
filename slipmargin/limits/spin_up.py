"""Torque that wheels and rotors themselves take when the robot accelerates (docs/theory.md, section 4).

A wheel that rolls turns at θ̇ = W u, u the twist of the body's origin, so that it gains speed by

    θ̈ = W u̇,   u̇ = a_o − ω ẑ×v_o,   a_o = a − α ẑ×c + ω² c,

with a the acceleration of the centre of mass c in body axes.  Its motor gives J θ̈ beside what the floor
asks for.  J is what the robot file states; without it nothing is added.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.model import Model
from slipmargin.physics.kinematics import at_centre, com_acceleration, rate_as_axes_turn


def spin_torque(model: Model, velocity: Array, acceleration: Array) -> Array:
    """(..., M, N) torque J θ̈ [N m] of motions ``velocity`` (M, 3), by ``acceleration`` (..., M, 3) of the
    centre of mass [m/s²] and in yaw [rad/s²].
    """
    return np.asarray(acceleration @ spin_by_acceleration(model).T + spin_at_constant(model, velocity))


def spin_by_acceleration(model: Model) -> Array:
    """(N, 3) torque J θ̈ [N m] per acceleration of the centre of mass [m/s²] and in yaw [rad/s²]."""
    of_origin = com_acceleration(-np.asarray(model.inertia.com_m), np.zeros((3, 3)), np.eye(3))
    return np.asarray(_inertia(model) * model.geometry.wheel_speeds(of_origin).T)


def spin_at_constant(model: Model, velocity: Array) -> Array:
    """(..., N) torque J θ̈ [N m] of motions ``velocity`` (..., 3) without acceleration of the centre of mass.

    Who turns while driving on in one direction drives wheels faster and slower in turn.
    """
    x, y = model.inertia.com_m
    ax, ay, none = np.moveaxis(rate_as_axes_turn(velocity), -1, 0)
    rate = np.stack([*at_centre(-x, -y, np.asarray(velocity)[..., 2], ax, ay, 0.0), none], axis=-1)
    return np.asarray(_inertia(model) * model.geometry.wheel_speeds(rate))


def _inertia(model: Model) -> float:
    return model.drives.wheel_inertia_kg_m2 or 0.0
