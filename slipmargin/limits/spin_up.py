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


def spin_by_acceleration(model: Model) -> Array:
    """(N, 3) torque J θ̈ [N m] per acceleration of the centre of mass [m/s²] and in yaw [rad/s²]."""
    x, y = model.inertia.com_m
    of_origin = np.array([[1.0, 0.0, y], [0.0, 1.0, -x], [0.0, 0.0, 1.0]])
    return np.asarray(_inertia(model) * model.geometry.wheel_speeds(np.eye(3)).T @ of_origin)


def spin_at_constant(model: Model, velocity: Array) -> Array:
    """(..., N) torque J θ̈ [N m] of motions ``velocity`` (..., 3) without acceleration of the centre of mass.

    Who turns while driving on in one direction drives wheels faster and slower in turn.
    """
    vx, vy, turn = np.moveaxis(np.asarray(velocity, dtype=float), -1, 0)
    x, y = model.inertia.com_m
    rate = np.stack([turn**2 * x + turn * vy, turn**2 * y - turn * vx, np.zeros_like(turn)], axis=-1)
    return np.asarray(_inertia(model) * model.geometry.wheel_speeds(rate))


def _inertia(model: Model) -> float:
    return model.drives.wheel_inertia_kg_m2 or 0.0
