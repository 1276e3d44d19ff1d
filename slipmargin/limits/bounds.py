"""Limits of motion by direction: starting, braking, turning, cornering, spinning.

"Starting" is the speeding up along the motion against full drag, "braking" the slowing down with its
help, "turning" the acceleration across the motion at constant speed (the weaker side).  Directions
are in the body frame, counter-clockwise from its +X.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.limits.bounds_pace import held_in_curves
from slipmargin.limits.motion import (
    AccelerationLimit,
    along,
    along_each,
    steady_share,
    steady_share_of,
)
from slipmargin.limits.motion_rows import MOTOR, acceleration_rows
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.ray_ends import NO_SLOPE
from slipmargin.model import Model
from slipmargin.physics.frames import directions as unit_directions
from slipmargin.physics.kinematics import com_acceleration

#: Directions whose limits differ by less than this share are equal [1].
ALIKE = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Directions:
    """Acceleration limits (H,) [m/s²] by direction of motion ``heading_rad`` (H,).

    ``steady_use`` is the share of the grip that the most loaded wheel uses at constant speed; where it
    exceeds the share that
    may be used, ``starting`` is negative: the robot slips without accelerating.  It is infinite where the
    drag of a coupled grip leaves nothing to drive; the limits are then those of coasting.
    """

    heading_rad: Array
    starting_m_s2: Array
    turning_m_s2: Array
    braking_m_s2: Array
    steady_use: Array
    starting: AccelerationLimit

    @property
    def weakest(self) -> int:
        """Index of the least speeding up; of mirrored directions, which rounding tells apart, the first."""
        return _first(-self.starting_m_s2)

    @property
    def strongest(self) -> int:
        """Index of the greatest speeding up; of mirrored directions the first."""
        return _first(self.starting_m_s2)


def starting(
    model: Model,
    heading_rad: Array,
    *,
    share: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    pace: float = 0.0,
    speed_m_s: Array | None = None,
) -> AccelerationLimit:
    """Speeding up (H,) [m/s²] alone, as :func:`directions` has it, in a quarter of the time.

    ``speed_m_s`` (H,) are speeds at which losses and friction are taken, with full drag.
    """
    ahead = ahead_of(heading_rad)
    motion = Motion.full_drag(ahead) if speed_m_s is None else Motion.full_drag(ahead, speed_m_s)
    rows = acceleration_rows(model, motion, share=share, contact=contact, pace=pace)
    return along(model, rows, np.zeros_like(ahead), ahead)  # straight ahead nothing is centripetal


def _first(values: Array) -> int:
    most = float(np.max(values))
    return int(np.argmax(values >= most - ALIKE * max(abs(most), 1e-300)))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spin:
    """Limits of turning on the spot [rad/s²], both senses alike or the weaker one; steady use [1]."""

    starting_rad_s2: float
    braking_rad_s2: float
    steady_use: float
    top_rad_s: float

    @property
    def weaker_rad_s2(self) -> float:
        """What turning on the spot holds, speeding up and slowing down [rad/s²]; 0 where it holds neither."""
        return max(0.0, min(self.starting_rad_s2, self.braking_rad_s2))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cornering:
    """Fastest steady cornering [m/s] by curvature and direction of motion, (K, H).

    ``held`` with the heading φ held, ``tangent`` with the body turning with the path; left and right turns:
    the slower.  0 where constant speed must slip; infinite only on a straight line without a motor limit.
    """

    curvature_per_m: Array
    heading_rad: Array
    held_m_s: Array
    tangent_m_s: Array


def directions(
    model: Model,
    heading_rad: Array,
    *,
    share: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    motor: bool = True,
    speed_m_s: float | None = None,
    pace: float = 0.0,
) -> Directions:
    """Limits by direction of motion.

    Parameters
    ----------
    heading_rad : (H,)
        Direction of motion in the body frame.
    speed_m_s : float, optional
        Speed at which drag, losses and motors are taken.  Without it the drag is full and nothing else
        depends on the speed (the published limit; motors at their stall torque, or at ``pace`` of their top
        speed).
    """
    ahead = ahead_of(heading_rad)
    motion = _moving(ahead, speed_m_s)
    rows = acceleration_rows(model, motion, share=share, contact=contact, motor=motor, pace=pace)
    none = com_acceleration(model.inertia.com_m, motion.velocity, np.zeros_like(ahead))
    left = np.stack([-ahead[:, 1], ahead[:, 0], ahead[:, 2]], axis=1)
    ways = np.stack([ahead, -ahead, left, -left])
    up, down, one, two = along_each(model, rows, np.broadcast_to(none, ways.shape), ways)
    if share == 1.0 or not model.grip.multipliers:
        steady = steady_share_of(model, motion, rows.facets, rows.friction, rows.external)
    else:  # the friction that may be met depends on the share
        steady = steady_share(model, motion, contact=contact)
    return Directions(
        heading_rad=np.asarray(heading_rad),
        starting_m_s2=up.value,
        braking_m_s2=down.value,
        turning_m_s2=np.minimum(one.value, two.value),
        steady_use=steady,
        starting=up,
    )


def spin(model: Model, *, share: float = 1.0, contact: Contact = Contact.ROLLERS, motor: bool = True) -> Spin:
    """Limits of turning on the spot, about the body's origin."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    motion = Motion.full_drag(turn)
    rows = acceleration_rows(model, motion, share=share, contact=contact, motor=motor)
    com, still = model.inertia.com_m, np.zeros_like(turn)
    start = com_acceleration(com, motion.velocity, still)
    ways = np.stack([com_acceleration(com, still, way) for way in (turn, -turn)])
    limits = along_each(model, rows, np.broadcast_to(start, ways.shape), ways)
    top = model.drives.max_speed_rad_s
    rate = np.abs(model.geometry.rolling_rows()[:, 2]) / model.geometry.radius_m
    return Spin(
        starting_rad_s2=float(np.min(limits[0].value)),
        braking_rad_s2=float(np.min(limits[1].value)),
        steady_use=float(np.max(steady_share(model, motion, contact=contact))),
        top_rad_s=np.inf if top is None else float(top / np.max(rate)),
    )


def cornering(
    model: Model,
    curvature_per_m: Array,
    heading_rad: Array,
    *,
    share: float = 1.0,
    contact: Contact = Contact.ROLLERS,
) -> Cornering:
    """Fastest steady cornering by curvature (K,) [1/m] and direction of motion (H,).

    At speed v the origin needs the acceleration κ v² across the motion, linear in v²; the drag is full.
    The motors' top speed caps it, and their torque at the speed that is reached.
    """
    curvature, heading = np.asarray(curvature_per_m, dtype=float), np.asarray(heading_rad, dtype=float)
    k, h = (a.ravel() for a in np.meshgrid(curvature, heading, indexing="ij"))
    out = []
    for turning in (0.0, 1.0):
        sides = [_corner(model, side * k, h, turning, share, contact) for side in (1.0, -1.0)]
        out.append(np.minimum(*sides).reshape(len(curvature), len(heading)))
    return Cornering(curvature_per_m=curvature, heading_rad=heading, held_m_s=out[0], tangent_m_s=out[1])


def _corner(
    model: Model, curvature: Array, heading: Array, turning: float, share: float, contact: Contact
) -> Array:
    ahead = ahead_of(heading)
    twist = ahead.copy()
    twist[:, 2] = turning * curvature
    motion = Motion(velocity=twist, saturated=True)
    rows = acceleration_rows(model, motion, share=share, contact=contact, motor=False)
    across = np.stack([-ahead[:, 1] * curvature, ahead[:, 0] * curvature, np.zeros_like(curvature)], axis=1)
    per_square = com_acceleration(model.inertia.com_m, twist, across)  # per v², centripetal part included
    limit = along(model, rows, np.zeros_like(per_square), per_square)
    speed = np.sqrt(np.maximum(limit.value, 0.0))
    crawl = Motion.full_drag(twist)  # without the centripetal force, which the limit counts
    speed[steady_share(model, crawl, contact=contact) > share] = 0.0
    top = model.drives.max_speed_rad_s
    if top is not None:
        rate = np.max(np.abs(model.geometry.wheel_speeds(twist)), axis=1)
        speed = np.minimum(speed, top / rate)
    return held_in_curves(model, rows, per_square, speed)


def top_speed(model: Model, heading_rad: Array) -> Array:
    """Fastest straight motion (H,) [m/s] that the motors' top speed allows; infinite without one."""
    top = model.drives.max_speed_rad_s
    if top is None:
        return np.full(len(heading_rad), np.inf)
    rate = np.max(np.abs(model.geometry.wheel_speeds(ahead_of(heading_rad))), axis=1)
    return np.asarray(top / rate)


def starting_by_motor(model: Model, heading_rad: Array, *, contact: Contact = Contact.ROLLERS) -> Array:
    """Acceleration (H,) [m/s²] at which the first motor reaches its stall torque; infinite without one.

    0 where drag alone takes more than that.
    """
    motion = _moving(ahead_of(heading_rad), None)
    rows = acceleration_rows(model, motion, contact=contact, motor=True)
    keep = rows.cause == MOTOR
    if not np.any(keep):
        return np.full(len(heading_rad), np.inf)
    slope = np.einsum("mrc,mc->mr", rows.A[:, keep], ahead_of(heading_rad))
    room, least = rows.b[:, keep], NO_SLOPE * np.max(np.abs(slope), axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(slope > least, room / slope, np.where((slope >= -least) & (room < 0.0), 0.0, np.inf))
    return np.asarray(np.maximum(np.min(most, axis=1), 0.0))


def headings(step_deg: float = 1.0) -> Array:
    """Directions of motion all round [rad].

    Raises
    ------
    InputError
        If the step is not between 0 and 90 degrees.
    """
    step_deg = real("step", step_deg, above=0.0, high=90.0, cure="give a step up to 90 [deg]")
    return np.asarray(np.deg2rad(np.arange(0.0, 360.0 - 1e-9, step_deg)))


def ahead_of(heading: Array) -> Array:
    """Unit velocities (H, 3) along headings (H,), without yaw."""
    heading = np.asarray(heading, dtype=float)
    return np.column_stack([unit_directions(heading), np.zeros_like(heading)])


def _moving(ahead: Array, speed_m_s: float | None) -> Motion:
    if speed_m_s is None:
        return Motion.full_drag(ahead)
    return Motion(velocity=ahead * real("speed", speed_m_s, above=0.0, cure="give a positive speed [m/s]"))


__all__ = [
    "AccelerationLimit",
    "Cornering",
    "Directions",
    "Spin",
    "cornering",
    "directions",
    "headings",
    "spin",
    "starting",
    "starting_by_motor",
    "top_speed",
]
