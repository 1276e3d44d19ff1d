"""Speeds up to which limits hold: the motors' share of their top speed, curves, and turning."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.effort import Demands, efforts
from slipmargin.limits.motion import along
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import (
    AccelerationRows,
    acceleration_rows,
    at_pace,
    prepare,
    torque_limit,
)
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.spin_up import spin_at_constant
from slipmargin.model import Model
from slipmargin.physics.frames import directions
from slipmargin.physics.kinematics import com_acceleration

#: Rates between two that are tried at once, and rounds: the rate is found to 1e-8 of what grip alone allows.
RATES, RATE_ROUNDS = 40, 5
#: Halvings in which the speed is found that motors hold in a curve: to 1e-6 of what grip alone allows.
CURVE_ROUNDS = 20


def pace(model: Model, velocity: Array, torque_N_m: Array, share: float) -> float | None:
    """Share of the top speed up to which motors have the torques (2, M, N) of motions along ``velocity``."""
    stall, top = model.drives.stall_torque_N_m, model.drives.max_speed_rad_s
    if top is None:
        return None
    if stall is None:
        return share
    speed = at_pace(model, velocity, 1.0) / top
    driving = np.where(speed > 0.0, torque_N_m[0], torque_N_m[1])
    left = 1.0 - np.maximum(driving, 0.0) / (share * stall)
    return float(np.clip(np.min(left / np.maximum(np.abs(speed), 1e-9)), 0.0, share))


def held_speed(model: Model, heading_rad: Array, contact: Contact) -> float:
    """Fastest straight motion [m/s] that the motors hold against full drag in every direction (H,).

    A wheel that drives with the torque T turns at most at θ̇_max (1 − T / T_stall).  Without a stall torque
    nothing is lost to drag; infinite without a top speed.
    """
    stall, top = model.drives.stall_torque_N_m, model.drives.max_speed_rad_s
    if top is None:
        return np.inf
    ahead = np.column_stack([directions(heading_rad), np.zeros(len(heading_rad))])
    speed = model.geometry.wheel_speeds(ahead)  # per 1 m/s
    left = np.ones_like(speed)
    if stall is not None:
        friction, external = prepare(model, Motion.full_drag(ahead), 1.0, contact)[1:]
        torque = efforts(model, friction, external, ahead, np.zeros((1, *ahead.shape))).torque_N_m[:, 0]
        left = 1.0 - np.maximum(np.where(speed > 0.0, torque[0], torque[1]), 0.0) / stall
    return float(max(0.0, np.min(top * left / np.maximum(np.abs(speed), 1e-9))))


def held_in_curves(model: Model, rows: AccelerationRows, per_square: Array, speed: Array) -> Array:
    """The part of ``speed`` (M,) [m/s] up to which motors hold steady curves (the unit twists of ``rows``).

    At the speed v a curve needs the acceleration v² ``per_square`` (M, 3) of the centre of mass and in yaw,
    and motors have λ of what they give at v times the wheel speeds.  0 where drag alone takes more.
    """
    if model.drives.stall_torque_N_m is None:
        return speed
    demands = Demands.of(model, rows.friction, rows.external, np.zeros_like(rows.velocity))

    def holds(tried: Array) -> NDArray[np.bool_]:
        velocity, asked = tried[None, :, None] * rows.velocity, tried[None, :, None] ** 2 * per_square
        return np.asarray(_motors_use(model, demands, velocity, asked, rows.share)[0] <= 1.0)

    finite = np.where(np.isfinite(speed), speed, 1.0)  # where no speed is too fast, none changes anything
    done = holds(finite)
    low, high = np.zeros_like(finite), finite
    for _ in range(0 if np.all(done) else CURVE_ROUNDS):
        middle = 0.5 * (low + high)
        held = holds(middle)
        low, high = np.where(held, middle, low), np.where(held, high, middle)
    return np.asarray(np.where(done, speed, low))


def yaw_rate(model: Model, yaw_rad_s2: float, share: float, contact: Contact) -> float:
    """Fastest turn on the spot [rad/s] at which the centripetal force leaves a yaw acceleration."""
    turn = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    still, motion = np.zeros_like(turn), Motion.full_drag(turn)
    inward = com_acceleration(model.inertia.com_m, turn, still)
    if np.allclose(inward, 0.0, atol=1e-12):
        return np.inf
    rows = acceleration_rows(model, motion, share=share, contact=contact, motor=False)
    ways = np.stack([way * yaw_rad_s2 * turn for way in (1.0, -1.0)])
    starts = np.stack([com_acceleration(model.inertia.com_m, still, way) for way in ways])
    squared = min(float(np.min(along(model, rows, start, inward).value)) for start in starts)
    high = np.sqrt(max(0.0, squared))

    demands = Demands.of(model, rows.friction, rows.external, still)

    def there(rates: Array) -> NDArray[np.bool_]:
        # At such a rate a wheel may slide so slowly that its drag, which helped, is not full.
        each = len(rates)
        turning = rates[:, None, None] * np.tile(turn, (2, 1))
        really = Motion(
            velocity=turning.reshape(-1, 3), acceleration=np.tile(np.vstack(list(ways)), (each, 1))
        )
        use = realised(model, really, contact=contact, share=share).use.reshape(each, -1)
        holds = np.max(use, axis=1) <= share
        if model.drives.stall_torque_N_m is None:
            return np.asarray(holds)
        asked = (starts[:, None] + rates[:, None, None] ** 2 * inward).reshape(-1, 2, 3)
        twist = np.tile(rates[:, None, None] * turn, (2, 1, 1))
        motors = _motors_use(model, demands, twist, asked, share)
        return np.asarray(holds & (motors.reshape(2, each, 2).max(axis=(0, 2)) <= 1.0))

    low = 0.0
    for _ in range(RATE_ROUNDS):
        tried = np.linspace(low, high, RATES + 2)
        holds = there(tried[1:])
        if np.all(holds):
            return float(high)
        first = int(np.argmin(holds))
        low, high = tried[first], tried[first + 1]
    return float(high if low == 0.0 else low)


def _motors_use(
    model: Model, demands: Demands, velocity: Array, acceleration: Array, share: Array | float
) -> Array:
    """Largest part (R, M) of what motors may give, in motions and at accelerations (R, M, 3).

    They may give λ of their torque.  ``demands`` are those of states at rest, so that the torque by which
    wheels gain speed in such a motion is taken off it.
    """
    gained = spin_at_constant(model, velocity)
    may = np.reshape(share, (-1, 1)) * torque_limit(model, model.geometry.wheel_speeds(velocity))
    return demands.each(acceleration).of_motors(may - np.stack([gained, -gained]))
