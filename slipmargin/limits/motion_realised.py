"""The forces that wheels really have while they creep together (theory section 4, four wheels and more).

With prescribed wheel speeds all wheels share one creep twist ε (velocity of the centre of mass, yaw
rate): the slips are u_W = b_i·ε and u_T = u_T0 + t_i·ε, and ε solves

    Σ_i b_i c_i σ(k b_i·ε) + Σ_i t_i d_i σ(k (u_T0 + t_i·ε)) + (M a − w_loss) = 0,

the gradient of a convex potential, with c_i = μ_W N_i and d_i = μ_T N_i.  A wheel's *use* is
|σ(k b_i·ε)|.

**Open loop.** Where nothing corrects the pose, the creep itself turns the robot: it moves with v + ε_v
and ω + ε_ω, and must be accelerated by m [(ω + ε_ω) ẑ×(v + ε_v) − ω ẑ×v] more (the wheels prescribe the
velocity in the body frame).  At 1 m/s a creep of 10 mm/s on a small robot makes this a tenth of its grip,
so a plan counts both cases; an audit of somebody's trajectory takes the poses as driven.

**Beyond the limit.** σ stops at 1, so no ε exists outside the wrench set.  Above the share 0.98 σ is
continued by a straight line of slope 0.02 per unit of k u: `use` then exceeds 1 and says by how much,
and below 0.98 nothing is changed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np
from numba import njit

from slipmargin.checks import Array
from slipmargin.limits.motion_friction import Friction, friction_in_motion, material_states, sigma
from slipmargin.limits.motion_losses import losses_in_motion
from slipmargin.limits.motion_state import Contact, Motion, com_acceleration, mass_diagonal
from slipmargin.model import Model

#: Share up to which eq. (11) is used as it stands [1].
FAITHFUL = 0.98
#: Slope of the continuation above it, per unit of k·u [1].
BEYOND = 0.02
#: A wheel that lifts off is taken to carry this share of m g / N, so that its use tells [1].
LIGHTEST = 0.01
#: Use of a wheel where no steady creep is found: far outside the wrench set, or the creep runs away [1].
RUNAWAY = 1.5
_KNEE = math.tan(0.5 * math.pi * FAITHFUL)


@njit(cache=True)
def _share(z: float) -> tuple[float, float]:
    """Continued σ(z) and its slope."""
    if abs(z) <= _KNEE:
        return 2.0 / math.pi * math.atan(z), 2.0 / math.pi / (1.0 + z * z)
    return math.copysign(FAITHFUL + BEYOND * (abs(z) - _KNEE), z), BEYOND


@njit(cache=True)
def _residual(eps: Array, W: Array, T: Array, c: Array, kw: Array, d: Array, kt: Array, slide: Array,
              need: Array, carried: Array, scale: Array, out: Array, H: Array) -> float:
    """Residual and its Jacobian; ``carried`` is (m, v_x, v_y, ω), m = 0 where the pose is held."""
    n = W.shape[1]
    m, vx, vy, w = carried[0], carried[1] + eps[0], carried[2] + eps[1], carried[3] + eps[2]
    out[0] = need[0] - m * (w * vy - carried[3] * carried[2])
    out[1] = need[1] + m * (w * vx - carried[3] * carried[1])
    out[2] = need[2]
    H[:, :] = 0.0
    H[0, 1], H[0, 2], H[1, 0], H[1, 2] = -m * w, -m * vy, m * w, m * vx
    for i in range(n):
        g = W[0, i] * eps[0] + W[1, i] * eps[1] + W[2, i] * eps[2]
        f = slide[i] + T[0, i] * eps[0] + T[1, i] * eps[1] + T[2, i] * eps[2]
        sw, hw = _share(kw[i] * g)
        z = kt[i] * f
        st, ht = 2.0 / math.pi * math.atan(z), 2.0 / math.pi / (1.0 + z * z)
        for r in range(3):
            out[r] += W[r, i] * c[i] * sw + T[r, i] * d[i] * st
            for q in range(3):
                H[r, q] += W[r, i] * W[q, i] * c[i] * kw[i] * hw + T[r, i] * T[q, i] * d[i] * kt[i] * ht
    return math.sqrt((out[0] / scale[0])**2 + (out[1] / scale[1])**2 + (out[2] / scale[2])**2)


@njit(cache=True)
def _solve3(H: Array, b: Array, x: Array) -> None:
    """x = H⁻¹ b by elimination; H is positive definite but for the turning of the frame."""
    p, q = H[1, 0] / H[0, 0], H[2, 0] / H[0, 0]
    h11, h12, b1 = H[1, 1] - p * H[0, 1], H[1, 2] - p * H[0, 2], b[1] - p * b[0]
    h21, h22, b2 = H[2, 1] - q * H[0, 1], H[2, 2] - q * H[0, 2], b[2] - q * b[0]
    r = h21 / h11
    x[2] = (b2 - r * b1) / (h22 - r * h12)
    x[1] = (b1 - h12 * x[2]) / h11
    x[0] = (b[0] - H[0, 1] * x[1] - H[0, 2] * x[2]) / H[0, 0]


@njit(cache=True)
def _creep(W: Array, T: Array, c: Array, kw: Array, d: Array, kt: Array, slide: Array, need: Array,
           carried: Array, scale: Array, twist: Array, use: Array) -> None:
    """Damped Newton over all samples, each from its neighbour and else from rest.

    Samples not found get the use ``RUNAWAY`` on the wheel that was worst.
    """
    samples, n = c.shape
    eps, step, trial = np.zeros(3), np.zeros(3), np.zeros(3)
    out, new, H, other = np.zeros(3), np.zeros(3), np.zeros((3, 3)), np.zeros((3, 3))
    for m in range(samples):
        for attempt in range(2):
            if attempt == 1 or not math.isfinite(eps[0] + eps[1] + eps[2]):
                eps[:] = 0.0
            miss = _residual(
                eps, W, T, c[m], kw[m], d[m], kt[m], slide[m], need[m], carried[m], scale, out, H
            )
            for _ in range(100):
                if miss <= 1e-11:
                    break
                _solve3(H, out, step)
                size = 1.0
                while size > 1e-9:
                    for r in range(3):
                        trial[r] = eps[r] - size * step[r]
                    less = _residual(trial, W, T, c[m], kw[m], d[m], kt[m], slide[m], need[m], carried[m],
                                     scale, new, other)
                    if less < (1.0 - 1e-4 * size) * miss:
                        break
                    size *= 0.5
                if size <= 1e-9:
                    break
                eps[:], out[:], H[:, :], miss = trial, new, other, less
            if miss <= 1e-8:
                break
        twist[m] = eps
        worst = 0
        for i in range(n):
            use[m, i] = abs(_share(kw[m, i] * (W[0, i] * eps[0] + W[1, i] * eps[1] + W[2, i] * eps[2]))[0])
            if use[m, i] > use[m, worst]:
                worst = i
        if not miss <= 1e-8:
            use[m, worst] = max(use[m, worst], RUNAWAY)
            eps[:] = 0.0


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Realised:
    """Creeping equilibrium of M states.

    ``use`` (M, N): share of each wheel's drive grip; ``twist`` (M, 3): creep of the body [m/s, m/s, rad/s];
    ``torque_N_m`` (M, N): motor torque T = −ρ F·ŝ; ``load_N`` (M, N).  Where the contact is unknown,
    the worst over its states.
    """

    use: Array
    twist: Array
    torque_N_m: Array
    load_N: Array


def realised(model: Model, motion: Motion, *, contact: Contact = Contact.ROLLERS, share: float = 1.0,
             open_loop: bool = False) -> Realised:
    """The creeping equilibrium of states whose acceleration is known.

    Parameters
    ----------
    motion : Motion
        States with their accelerations.  With ``contact`` UNKNOWN every combination of rollers and
        rigid sectors is tried (2^N of them).
    share : float
        Largest share expected: bounds the creep where friction varies with slip.
    open_loop : bool
        Nothing corrects the pose: the creep turns the robot (see the module).
    """
    friction = friction_in_motion(model, motion, contact=contact, share=share)
    low, high = losses_in_motion(model, motion)
    assert motion.acceleration is not None
    at_com = com_acceleration(model, motion.velocity, motion.acceleration)
    need = at_com * mass_diagonal(model) - 0.5 * (low + high)
    load = model.loads.rest_N + at_com[:, :2] @ model.loads.per_acceleration_kg.T
    pressed = np.maximum(load, LIGHTEST * model.inertia.weight_N / model.count)
    shape = (motion.count, model.count)
    out = Realised(use=np.full(shape, -1.0), twist=np.zeros((motion.count, 3)), torque_N_m=np.zeros(shape),
                   load_N=load)
    carried = np.zeros((motion.count, 4))
    if open_loop:
        com, w = model.inertia.com_m, motion.velocity[:, 2]
        carried[:, 0], carried[:, 3] = model.inertia.mass_kg, w
        carried[:, 1], carried[:, 2] = motion.velocity[:, 0] - w * com[1], motion.velocity[:, 1] + w * com[0]
    for on_rigid in material_states(friction.possible):
        grip = np.where(on_rigid, friction.drive[1], friction.drive[0]) * pressed
        drag = np.where(on_rigid, friction.transverse[1], friction.transverse[0]) * pressed
        twist, use = _equilibrium(model, grip, drag, friction, need, carried)
        worse = use.max(axis=1) > out.use.max(axis=1)
        out.twist[worse] = twist[worse]
        torque = _torque(model, grip, drag, friction, twist)
        np.maximum(out.use, use, out=out.use)
        np.copyto(out.torque_N_m, torque, where=np.abs(torque) > np.abs(out.torque_N_m))
    return out


def _equilibrium(model: Model, grip: Array, drag: Array, friction: Friction, need: Array,
                 carried: Array) -> tuple[Array, Array]:
    along, across = (np.ascontiguousarray(b) for b in model.wrench_maps())
    lever = float(np.max(np.abs(along[2]))) or 1.0
    scale = model.inertia.weight_N * float(np.max(model.grip.roller[:, 0])) * np.array([1.0, 1.0, lever])
    twist, use = np.empty((len(grip), 3)), np.empty(grip.shape)
    args = [np.ascontiguousarray(x) for x in (grip, friction.drive_stiffness, drag, friction.stiffness,
                                              friction.slide, need)]
    grips, kw, drags, kt, slides, needs = args
    _creep(along, across, grips, kw, drags, kt, slides, needs, carried, scale, twist, use)
    return twist, use


def _torque(model: Model, grip: Array, drag: Array, friction: Friction, twist: Array) -> Array:
    c = model.contacts
    along, across = model.wrench_maps()
    drive = -grip * continued_share(friction.drive_stiffness * (twist @ along))
    side = -drag * sigma(friction.stiffness * (friction.slide + twist @ across))
    return np.asarray(-c.radius_m * (drive * np.sum(c.drive * c.grip, axis=1)
                                     + side * np.sum(c.drive * c.free, axis=1)))


def continued_share(z: Array) -> Array:
    """σ(z), above the share 0.98 continued by a straight line."""
    beyond = np.copysign(FAITHFUL + BEYOND * (np.abs(z) - _KNEE), z)
    return np.where(np.abs(z) <= _KNEE, sigma(z), beyond)
