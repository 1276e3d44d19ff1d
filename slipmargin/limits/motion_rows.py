"""The wrench set in motion as linear rows over the acceleration (docs/theory.md, section 4).

Drive forces are free within λ μ_W N, the transverse forces are drag.  For a facet normal n of the
zonotope of B_W's columns b_i (with t_i the columns of B_T):

    n·M a − n·w ≤ Σ_i κ_i N_i(a),   κ_i = λ μ_W |n·b_i| − max_D (n·t_i) D_i,
    N_i(a) = rest_i + P_i·a + S_i·Σ h F ≥ (1 − λ) N_i(0)          (tipping: λ of what lifts the wheel)
    ±(T_i(a) + J θ̈_i(a)) ≤ λ of what the motor gives at its speed (torque–speed line)

a = (a_x, a_y, α): body-frame acceleration of the centre of mass and yaw acceleration; w: the external
wrench, the worst of what is unknown, with the loads that the same forces make by their heights h.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, read_only
from slipmargin.limits.bias import refuse_lifting
from slipmargin.limits.motion_compiled import facet_worth, fill_rows, own, torque_by_drag
from slipmargin.limits.motion_external import External, external_in_motion
from slipmargin.limits.motion_friction import Friction, friction_in_motion
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.spin_up import spin_at_constant, spin_by_acceleration
from slipmargin.model import Model
from slipmargin.physics.kinematics import KEPT, WheelGeometry
from slipmargin.sets.facets import facet_normals

#: Singular values below this share of the largest one are rounding [1].
_ROUNDING = 1e-12


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Facets:
    """Half-spaces of the drive zonotope: ``normals`` (K, 3), ``drive`` |n·b_i| and ``across`` n·t_i (K, N).

    ``pushing`` (K, N) is sign(n·b_i): which wheels a facet saturates.
    """

    normals: Array
    drive: Array
    across: Array
    pushing: Array

    @staticmethod
    def of(model: Model) -> Facets:
        """The facets of a model."""
        return Facets.of_wheels(model.geometry, *(float(c) for c in model.inertia.com_m))

    @staticmethod
    @lru_cache(maxsize=KEPT)
    def of_wheels(geometry: WheelGeometry, com_x_m: float, com_y_m: float) -> Facets:
        """Facets depend on the wheels' places, their directions and the centre of mass only."""
        along, across = geometry.wrench_maps(np.array([com_x_m, com_y_m]))
        half = facet_normals(along)
        normals = np.vstack([half, -half])
        lever = normals @ along
        lever = np.where(np.abs(lever) < 1e-12 * np.max(np.abs(lever), axis=1, keepdims=True), 0.0, lever)
        return Facets(
            normals=read_only(normals),
            drive=read_only(np.abs(lever)),
            across=read_only(normals @ across),
            pushing=read_only(np.sign(lever)),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AccelerationRows:
    """Rows ``A`` (M, R, 3) a ≤ ``b`` (M, R) and what each row means.

    ``wheels`` (R, N) are the wheels a row is about (a facet saturates several); ``cause`` (R,) indexes
    :data:`CAUSES`.  ``spent`` (M, N): wheels whose drag uses the whole of a coupled grip, so that none is
    left to drive; ``coasting`` (M, 3): the acceleration without any drive force (zero where none is spent).
    ``share`` is λ, ``facets``, ``friction`` and ``external`` what the rows are made of, ``torque_N_m``
    (2, M, N) the torque that may be used along and against each wheel's axle, None where motors do not count,
    ``velocity`` (M, 3) how the body moves.
    """

    A: Array
    b: Array
    wheels: NDArray[np.bool_]
    cause: NDArray[np.int64]
    spent: NDArray[np.bool_]
    coasting: Array
    share: Array | float = field(repr=False)
    facets: Facets = field(repr=False)
    friction: Friction = field(repr=False)
    external: External = field(repr=False)
    torque_N_m: Array | None = field(repr=False)
    velocity: Array = field(repr=False)


#: What a row stands for, and what is said where there is no grip left to drive.
CAUSES = ("grip", "tips", "motor torque")
GRIP, TIPS, MOTOR = range(3)
SPENT = "drag uses the whole grip"
#: A torque below this share of the stall torque is none: rounding at the top speed, where no torque is left
#: [1].
NO_TORQUE = 1e-9


def acceleration_rows(
    model: Model,
    motion: Motion,
    *,
    share: Array | float = 1.0,
    contact: Contact = Contact.ROLLERS,
    motor: bool = True,
    pace: float = 0.0,
    torque_N_m: Array | None = None,
    parts: tuple[Facets, Friction, External] | None = None,
    torque: TorqueRows | None = None,
) -> AccelerationRows:
    """Rows on the acceleration of the centre of mass at each sample.

    Parameters
    ----------
    share : float or (M,)
        λ: the share of each wheel's drive grip that may be used, and of the acceleration that lifts a wheel:
        every wheel keeps 1 − λ of the load that it has without acceleration.
    motor : bool
        Whether the motor's torque–speed line counts.
    pace : float
        Where above 0, torques are those of motions in which the fastest wheel turns at this share of the
        motors' top speed.
    torque_N_m : (2, M, N), optional
        Torque that may be used along and against each wheel's axle, by default λ of what the motors have.
    parts : optional
        What :func:`prepare` gave for these samples.
    torque : optional
        What :func:`torque_rows` gave for them.
    """
    facets, friction, external = parts or prepare(model, motion, share, contact)
    refuse_lifting(model, external.standing_N(), "loads", external)
    kappa = facet_coefficients(facets, friction, share)
    A, b = facet_rows(model, facets, kappa, external)
    n, rows, bounds = model.count, [A], [b]
    may: Array | None = None
    causes, wheels = [0] * len(facets.normals), [facets.pushing != 0.0]
    if model.loads.follow_acceleration:
        tip = np.zeros((motion.count, n, 3))
        tip[..., :2] = -model.loads.per_acceleration_kg
        rows.append(tip)
        bounds.append(np.reshape(share, (-1, 1)) * external.standing_N())
        causes += [1] * n
        wheels.append(np.eye(n, dtype=bool))
    if motor and model.drives.stall_torque_N_m is not None:
        torque = torque or torque_rows(model, friction, external, motion.velocity)
        may = torque_N_m
        if may is None:
            may = np.reshape(share, (-1, 1)) * torque_limit(model, at_pace(model, motion.velocity, pace))
        known = np.isfinite(model.drives.stall_torques(n))
        rows += list(torque.A[:, :, known])
        bounds += list((may + torque.b)[:, :, known])
        causes += [2] * (2 * int(known.sum()))
        wheels += [np.eye(n, dtype=bool)[known]] * 2
    spent = np.any(friction.possible & (friction.drive <= 0.0), axis=0)
    return AccelerationRows(
        A=np.concatenate(rows, axis=1),
        b=np.concatenate(bounds, axis=1),
        wheels=np.concatenate(wheels),
        cause=np.array(causes),
        spent=spent,
        coasting=_coasting(model, friction, external) if np.any(spent) else np.zeros((motion.count, 3)),
        share=share,
        facets=facets,
        friction=friction,
        external=external,
        torque_N_m=may,
        velocity=motion.velocity,
    )


def at_pace(model: Model, velocity: Array, pace: float) -> Array:
    """Wheel speeds (M, N) [rad/s]; for ``pace`` > 0 of motions as fast as :func:`acceleration_rows` says."""
    speed = model.geometry.wheel_speeds(velocity)
    if not pace or model.drives.max_speed_rad_s is None:
        return np.asarray(speed)
    fastest = np.max(np.abs(speed), axis=1, keepdims=True)
    return np.asarray(speed / np.where(fastest > 0.0, fastest, 1.0) * pace * model.drives.max_speed_rad_s)


def _coasting(model: Model, friction: Friction, external: External) -> Array:
    """Acceleration (M, 3) of the centre of mass by drag and external wrench alone, of the heavier drag."""
    wrench, load = external.middle(np.zeros(2))
    middle = np.where(friction.possible, 0.5 * (friction.drag_low + friction.drag_high), 0.0)
    drag = np.where(np.abs(middle[1]) > np.abs(middle[0]), middle[1], middle[0])
    return np.asarray((wrench - (drag * load) @ model.wrench_maps()[1].T) / model.inertia.diagonal)


def prepare(
    model: Model, motion: Motion, share: Array | float, contact: Contact
) -> tuple[Facets, Friction, External]:
    """Facets, friction and external wrenches: everything the rows are made of."""
    friction = friction_in_motion(model, motion, share=float(np.max(share)), contact=contact)
    return Facets.of(model), friction, external_in_motion(model, motion)


def facet_coefficients(facets: Facets, friction: Friction, share: Array | float) -> Array:
    """κ (M, K, N): how much each newton of load is worth to each facet, worst over what is unknown."""
    grip = own(np.reshape(share, (-1, 1)) * friction.drive)
    worth = np.empty((friction.drive.shape[1], *facets.drive.shape))
    low, high = own(friction.drag_low), own(friction.drag_high)
    facet_worth(own(facets.drive), own(facets.across), own(friction.possible), grip, low, high, worth)
    return worth


def facet_rows(model: Model, facets: Facets, kappa: Array, external: External) -> tuple[Array, Array]:
    """A (M, K, 3) and b (M, K) of the facets."""
    A = np.empty((*kappa.shape[:2], 3))
    fill_rows(facets.normals * model.inertia.diagonal, kappa, own(model.loads.per_acceleration_kg), A)
    return A, external.least(facets.normals, kappa)


def even_distribution(model: Model) -> Array:
    """(N, 3): drive forces of a wrench while all wheels creep little.

    f_i = c_i b_i·ε with Σ b_i f_i = w, c_i ∝ μ_W N_i at rest: the realised distribution of
    docs/theory.md, section 4 to first order; exact and independent of c for three wheels.
    """
    along = model.wrench_maps()[0]
    weight = model.grip.roller[:, 0] * np.maximum(model.loads.rest_N, 1e-9 * model.inertia.weight_N)
    root = np.sqrt(weight)
    return np.asarray(root[:, None] * np.linalg.pinv(along * root, rcond=_ROUNDING))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TorqueRows:
    """Motor torques, both signs: T (2, M, N) ≤ limit, where T = ``A`` (2, M, N, 3) a − ``b`` (2, M, N)."""

    A: Array
    b: Array


def torque_rows(model: Model, friction: Friction, external: External, velocity: Array) -> TorqueRows:
    """±T as affine functions of the acceleration, worst over what is unknown.

    T = −ρ F·ŝ + J θ̈ is the motor's torque against the floor's force F on the wheel and its own inertia, in
    motions ``velocity`` (M, 3).  For more than three wheels the drive forces are the even distribution (a
    first estimate of the realised one).
    """
    across, (on_grip, on_free) = model.wrench_maps()[1], model.geometry.torque_arms()
    # f = L (M a − w + B_T N D), T = −ρ (ŝ·ĝ) f + ρ (ŝ·f̂) N D
    on_wrench = -on_grip[:, None] * even_distribution(model)
    on_drag = on_wrench @ across + np.diag(on_free)
    shape = friction.drive.shape[1:]
    most, least = np.empty((*shape, model.count)), np.empty((*shape, model.count))
    low, high = own(friction.drag_low), own(friction.drag_high)
    torque_by_drag(own(on_drag), own(friction.possible), low, high, most, least)
    A, b = np.empty((2, *shape, 3)), np.empty((2, *shape))
    per = own(model.loads.per_acceleration_kg)
    for s, (wrench, per_load) in enumerate(((on_wrench, -most), (-on_wrench, least))):
        fill_rows(wrench * model.inertia.diagonal, per_load, per, A[s])
        b[s] = external.least(wrench, per_load)
    sign = np.array([1.0, -1.0])[:, None, None]
    A += sign[..., None] * spin_by_acceleration(model)
    b -= sign * spin_at_constant(model, velocity)
    return TorqueRows(A=A, b=b)


def torque_limit(model: Model, speed: Array) -> Array:
    """Torque (2, M, N) that the motors give at wheel speeds (M, N), for T > 0 and T < 0 [N m].

    T_stall (1 − |θ̇|/θ̇_max) along θ̇ (driving), T_stall against it (braking).
    """
    stall, top = model.drives.stall_torque_N_m, model.drives.max_speed_rad_s
    if stall is None:
        return np.full((2, *speed.shape), np.inf)
    left = np.ones_like(speed) if top is None else np.clip(1.0 - np.abs(speed) / top, 0.0, 1.0)
    shares = np.stack([np.where(speed > 0.0, left, 1.0), np.where(speed < 0.0, left, 1.0)])
    return np.asarray(np.multiply(stall, shares, out=np.zeros_like(shares), where=shares > 0.0))


def torque_use(model: Model, torque_N_m: Array, speed: Array) -> Array:
    """Share (M, N) of what the motors give at wheel speeds (M, N) that torques (M, N) need.

    Infinite where a torque is asked for at the top speed, at which a motor has none; 0 where what is asked
    for is no torque (NO_TORQUE): close to the top speed both are rounding, and so is their ratio.
    """
    forwards, backwards = torque_limit(model, speed)
    limit = np.where(torque_N_m >= 0.0, forwards, backwards)
    asked = np.abs(torque_N_m)
    some = asked > NO_TORQUE * model.drives.stall_torques(model.count)
    share = np.where(some, np.inf, 0.0)
    np.divide(asked, limit, out=share, where=some & (limit > 0.0))
    return share
