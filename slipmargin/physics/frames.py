"""Frames: floor {0}, body {M} (angles counter-clockwise), and points of the body.

Which axis is the robot's front no function needs to know (:mod:`slipmargin.physics.convention`).
Every function takes numbers or arrays that broadcast.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from slipmargin.checks import Array


def wrapped(angle: Any) -> Any:
    """The same direction within −π to below π [rad]."""
    return np.mod(angle + np.pi, 2.0 * np.pi) - np.pi


def to_floor(phi: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Floor components of a vector in the body frame of a robot at heading ``phi`` [rad] (eq. 1's R(φ)).

    It is the vector turned counter-clockwise by ``phi``.
    """
    c, s = np.cos(phi), np.sin(phi)
    return c * x - s * y, s * x + c * y


def to_body(phi: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """Body components of a vector given in the floor frame, robot at heading ``phi`` [rad]."""
    c, s = np.cos(phi), np.sin(phi)
    return c * x + s * y, c * y - s * x


def velocity_at(vx: Any, vy: Any, wz: Any, px: Any, py: Any) -> tuple[Any, Any]:
    """Velocity of the body's point (px, py) where the origin moves with (vx, vy) and the body turns with wz.

    v + ω ẑ×p; the same map takes a velocity from one reference point to another.
    """
    return vx - wz * py, vy + wz * px


def moment(px: Any, py: Any, fx: Any, fy: Any) -> Any:
    """Moment about the origin of the force (fx, fy) at (px, py): positive counter-clockwise [N m]."""
    return px * fy - py * fx


def directions(angle: Any) -> Array:
    """Unit vectors (..., 2) at angles (...) [rad].

    Rounded to a part in 10¹⁵, so that right angles are exact and parallel wheels stay parallel.
    """
    return np.round(np.stack([np.cos(angle), np.sin(angle)], axis=-1), 15)


def rotate_rows(phi: Any, vectors: Array, *, inverse: bool = False) -> Array:
    """Vectors (..., 2) or twists and wrenches (..., 3) turned from body to floor axes, or back.

    The third component (yaw rate, moment) stays as it is.
    """
    turn = to_body if inverse else to_floor
    x, y = turn(phi, vectors[..., 0], vectors[..., 1])
    rest = [np.broadcast_to(vectors[..., k], np.shape(x)) for k in range(2, vectors.shape[-1])]
    return np.stack([x, y, *rest], axis=-1)
