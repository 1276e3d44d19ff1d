"""The forces that wheels really have in a motion, and on the way from one acceleration to the next.

Which distribution of forces more than three wheels take is decided by their common creep
(:mod:`~slipmargin.limits.creep`).  At 1 m/s a creep of 10 mm/s on a small robot that nothing corrects
costs a tenth of its grip, so a plan counts both cases, pose held and open loop; an audit of somebody's
trajectory takes the poses as driven.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import cycle, islice, product
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.creep import FAITHFUL, continued_share
from slipmargin.limits.creep_states import Balance
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_friction import friction_in_motion, material_states
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.spin_up import spin_torque
from slipmargin.model import Model
from slipmargin.physics.frames import velocity_at
from slipmargin.physics.friction_laws import law_inverse, law_share, law_slope
from slipmargin.physics.kinematics import com_acceleration
from slipmargin.physics.variables import Target
from slipmargin.work import WHEEL_STATES, allow

#: A wheel that lifts off is taken to carry this share of m g / N, so that its use tells [1].
LIGHTEST = 0.01
#: Friction is asked again at the speed that the creep leaves until no share moves by more, or so often [1].
UNMOVED, ROUNDS = 1e-4, 12

#: What to know of limits of motion where :func:`settles_slowly` is true.
SLOW_CREEP = (
    "these are accelerations of the robot: its friction law flattens with speed, so wheels braking without a "
    "look at the pose brake their slip too, and use more (plan counts that)"
)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Realised:
    """Creeping equilibrium of M states.

    ``use`` (M, N): share of each wheel's drive grip; ``twist`` (M, 3): creep of the body [m/s, m/s, rad/s];
    ``torque_N_m`` (M, N): motor torque T = −ρ F·ŝ + J θ̈; ``load_N`` (M, N).  Where the contact is unknown,
    the worst over its states.
    """

    use: Array
    twist: Array
    torque_N_m: Array
    load_N: Array


def realised(
    model: Model,
    motion: Motion,
    *,
    contact: Contact = Contact.ROLLERS,
    share: float = 1.0,
    open_loop: bool = False,
) -> Realised:
    """The creeping equilibrium of states whose acceleration is known.

    Parameters
    ----------
    motion : Motion
        States with their accelerations.  With ``contact`` UNKNOWN every combination of rollers and
        rigid sectors is tried (2^N of them).
    share : float
        Largest share expected: bounds the creep where friction varies with slip.
    open_loop : bool
        Nothing corrects the pose: the creep turns the robot (:mod:`~slipmargin.limits.creep`).
    """
    shape = (motion.count, model.count)
    out = Realised(
        use=np.full(shape, -1.0),
        twist=np.zeros((motion.count, 3)),
        torque_N_m=np.zeros(shape),
        load_N=external_in_motion(model, motion).middle(_at_com(model, motion))[1],
    )
    spin = spin_torque(model, motion.velocity, _at_com(model, motion))
    for balance in _balances(model, motion, contact, share, open_loop):
        twist, use = balance.rest()
        worse = use.max(axis=1) > out.use.max(axis=1)
        out.twist[worse] = twist[worse]
        torque = _torque(model, balance, twist) + spin
        np.maximum(out.use, use, out=out.use)
        np.copyto(out.torque_N_m, torque, where=np.abs(torque) > np.abs(out.torque_N_m))
    return out


def settling(
    model: Model, before: Motion, after: Motion, *, contact: Contact = Contact.ROLLERS, share: float = 1.0
) -> Array:
    """Largest use (M, N) while the creep changes from that of one acceleration to that of the next.

    Parameters
    ----------
    before, after : Motion
        The same M states with the accelerations on either side of a jump, open loop.
    """
    peak = np.zeros((after.count, model.count))
    mass = model.inertia.diagonal
    pairs = zip(
        _balances(model, before, contact, share, True),
        _balances(model, after, contact, share, True),
        strict=True,
    )
    for old, new in pairs:
        peak = np.maximum(peak, new.settling(old, mass))
    return peak


def followed(
    model: Model, motion: Motion, *, contact: Contact = Contact.ROLLERS, share: float = 1.0
) -> Array:
    """Largest use (M, N) of wheels that drive a whole motion open loop, its creep followed from the start.

    Parameters
    ----------
    motion : Motion
        M states that follow each other at ``motion.time_s``, the first without creep.

    Notes
    -----
    Friction that varies with speed and slip is asked again at the speed and the slip that the creep leaves.
    """
    assert motion.time_s is not None
    mass, use = model.inertia.diagonal, np.zeros((motion.count, model.count))
    for number, asked in enumerate(_balances(model, motion, contact, share, True)):
        balance, found = asked, np.full_like(use, np.inf)
        for _ in range(ROUNDS):
            before = found
            twist, found = balance.followed(motion.time_s, mass)
            if np.max(np.abs(found - before)) <= UNMOVED:
                break
            x, y = velocity_at(*twist.T, *(-model.inertia.com_m))
            crept = replace(
                motion,
                velocity=motion.velocity + np.column_stack([x, y, twist[:, 2]]),
                drive_slip=twist @ asked.along,
            )
            there = next(islice(_balances(model, crept, contact, share, True), number, None))
            balance = replace(
                asked, grip=there.grip, drag=there.drag, steep=there.steep, steep_across=there.steep_across
            )
        use = np.maximum(use, found)
    return use


def open_loop_use(
    model: Model, motion: Motion, *, contact: Contact = Contact.ROLLERS, share: float = 1.0
) -> Array:
    """Use (M, N) of wheels whose pose nothing corrects: at rest in each state, or, where the creep settles
    slowly, followed along states that come one after the other."""
    if settles_slowly(model):
        return followed(model, motion, contact=contact, share=share)
    return realised(model, motion, contact=contact, share=share, open_loop=True).use


def settles_slowly(model: Model) -> bool:
    """Whether the stiffness of friction varies, mostly with the speed: creep may last as long as a motion."""
    return any(m.target >= Target.STIFFNESS for m in model.grip.multipliers)


def creep_lasts_s(model: Model, motion: Motion, *, contact: Contact, share: float) -> Array:
    """How long (M,) [s] a creep lasts that is off its rest while wheels use ``share`` of their grip.

    Linearised M dε/dt = −H ε, with the mass for M and, for H, the sum of the wheels' grips times the slope of
    the law at that share.
    """
    found = friction_in_motion(model, motion, contact=contact, share=share)
    slope = law_slope(model.grip.law, law_inverse(model.grip.law, min(share, FAITHFUL)))
    grip = found.drive[0] * model.loads.rest_N
    return np.asarray(model.inertia.mass_kg / (slope * grip * found.drive_stiffness).sum(axis=1))


def growth_per_s(
    model: Model, motion: Motion, *, contact: Contact = Contact.ROLLERS, share: float = 1.0
) -> Array:
    """How fast (M,) [1/s] a small creep grows where loads follow the acceleration; at most 0, it dies out.

    A creep that accelerates the robot shifts the loads, and with them the forces that resist it: linearised
    A dε/dt = −H ε with A = M + Σ_i w_i n_iᵀ, where w_i is the wrench of wheel i against its creep for each
    newton of its load and n_i its load for each m/s².  A is not symmetric, and where the centre of mass
    stands several reaches high a mode grows: the wheels' speeds are held, and a wheel lifts all the same.
    """
    if not model.loads.follow_acceleration:
        return np.zeros(motion.count)
    load = external_in_motion(model, motion).middle(_at_com(model, motion))[1]
    shifts = cycle(model.loads.shifts())  # which vary faster than the materials
    states = zip(shifts, _balances(model, motion, contact, share, False), strict=False)
    return np.asarray(np.max([_growth_per_s(model, load + shift, asked) for shift, asked in states], axis=0))


def _growth_per_s(model: Model, load: Array, balance: Balance) -> Array:
    """:func:`growth_per_s` of wheels under one ``load`` (M, N), on known material."""
    load = np.maximum(load, LIGHTEST * model.inertia.weight_N / model.count)
    twist, _ = balance.rest()
    law, along, across = balance.law, balance.along, balance.across
    slip = balance.steep * (twist @ along)
    side = balance.steep_across * (balance.slide + twist @ across)
    used = law_inverse(law, np.clip(law_share(law, slip), -FAITHFUL, FAITHFUL))
    drive, drag = balance.grip / load * law_share(law, slip), balance.drag / load * law_share(law, side)
    against = np.einsum("ki,mi->mki", along, drive) + np.einsum("ki,mi->mki", across, drag)
    shifts = np.column_stack([model.loads.per_acceleration_kg, np.zeros(model.count)])
    inertia = np.diag(model.inertia.diagonal) + against @ shifts
    stiff = balance.grip * balance.steep * law_slope(law, used)
    stiff_across = balance.drag * balance.steep_across * law_slope(law, side)
    resists = np.einsum("mi,ki,li->mkl", stiff, along, along)
    resists += np.einsum("mi,ki,li->mkl", stiff_across, across, across)
    return np.asarray(np.max(np.linalg.eigvals(-np.linalg.pinv(inertia) @ resists).real, axis=1))


def _at_com(model: Model, motion: Motion) -> Array:
    assert motion.acceleration is not None
    return com_acceleration(model.inertia.com_m, motion.velocity, motion.acceleration)


def _balances(
    model: Model, motion: Motion, contact: Contact, share: float, open_loop: bool
) -> Iterator[Balance]:
    """What the states ask of the wheels, for every material they may stand on and corner of their loads."""
    friction = friction_in_motion(model, motion, contact=contact, share=share)
    at_com = _at_com(model, motion)
    wrench, load = external_in_motion(model, motion).middle(at_com)
    lightest = LIGHTEST * model.inertia.weight_N / model.count
    carried = np.zeros((motion.count, 4))
    if open_loop:
        carried[:, 0], carried[:, 3] = model.inertia.mass_kg, motion.velocity[:, 2]
        carried[:, 1], carried[:, 2] = velocity_at(*motion.velocity.T, *model.inertia.com_m)
    along, across = model.wrench_maps()
    cases = list(product(material_states(friction.possible), model.loads.shifts()))
    allow(
        "wheel",
        model.count * motion.count * len(cases),
        WHEEL_STATES,
        "wheels over all samples and contact states",
        "give a shorter motion or fewer samples of it, or leave --robust away",
    )
    for on_rigid, shift in cases:
        pressed = np.maximum(load + shift, lightest)
        yield Balance(
            law=model.grip.law,
            along=along,
            across=across,
            grip=np.where(on_rigid, friction.drive[1], friction.drive[0]) * pressed,
            drag=np.where(on_rigid, friction.transverse[1], friction.transverse[0]) * pressed,
            steep=friction.drive_stiffness,
            steep_across=np.where(on_rigid, friction.stiffness[1], friction.stiffness[0]),
            slide=friction.slide,
            need=at_com * model.inertia.diagonal - wrench,
            carried=carried,
            scale=comparable(model),
        )


def comparable(model: Model) -> Array:
    """A wrench (3,) to compare others with: weight times the largest coefficient, at the longest lever."""
    lever = float(np.max(np.abs(model.wrench_maps()[0][2]))) or 1.0
    most = float(max(np.max(model.grip.roller[:, 0]), np.max(model.grip.rigid[:, 0]))) or 1.0
    return model.inertia.weight_N * most * np.array([1.0, 1.0, lever])


def _torque(model: Model, balance: Balance, twist: Array) -> Array:
    drive = -balance.grip * continued_share(balance.law, balance.steep * (twist @ balance.along))
    side = -balance.drag * law_share(
        balance.law, balance.steep_across * (balance.slide + twist @ balance.across)
    )
    on_grip, on_free = model.geometry.torque_arms()
    return np.asarray(-(drive * on_grip + side * on_free))
