"""Friction that a moving wheel has: its drive grip and its drag, each per unit of load.

In motion the force across the rollers is not free: it is −μ_T N σ(k u·f̂) with the model's friction law
σ (docs/theory.md, section 4).  Multipliers are evaluated where their variable is known; where it is not
they give an interval, of which a limit takes the worst.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_probes import load_probes, probes
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.friction_laws import law_inverse, law_share
from slipmargin.physics.grips import drive_left, most_across, polyhedral
from slipmargin.physics.sectors import on_rigid, pitch
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Target, Variable
from slipmargin.work import MOVING_STATES, allow_states

Mask = NDArray[np.bool_]

#: Transverse slips below this share of the fastest wheel's speed count as none when ``saturated`` [1].
STILL = 1e-9
#: Largest share for which a creep is bounded [1].
MOST = 0.98
#: By how much a share may be exceeded while a robot nobody corrects is turned by its own creep [1]: simulated
#: ramps exceeded the share they were asked for by 0.006 at most (benchmarks/creep_bound.py).
ROOM = 0.01
#: Rounds after which a slope that falls with the slip is taken as found, and the least k over the file's.
_ROUNDS, _SLACKEST = 30, 1e6


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Friction:
    """Friction per load of M samples and N wheels on the two materials (roller, rigid).

    ``drive`` (2, M, N): |f·ĝ| ≤ drive · N_i.  The force along f̂ is −D N_i with D anywhere in
    [``drag_low``, ``drag_high``].  ``possible`` (2, M, N) says on which material a wheel may stand.
    ``slide`` (M, N) is the transverse slip [m/s], ``stiffness`` (M, N) k in the transverse direction and
    ``drive_stiffness`` in the drive direction [s/m]; ``transverse`` (2, M, N) the coefficient itself.
    """

    drive: Array
    drag_low: Array
    drag_high: Array
    transverse: Array
    possible: Mask
    slide: Array
    stiffness: Array
    drive_stiffness: Array


def creep_bound(model: Model, motion: Motion, share: float) -> Array:
    """Fastest drive slip (M, N) [m/s] of wheels that are asked for ``share`` of their grip.

    It is σ⁻¹(λ + ROOM)/k: a wheel that really uses λ creeps by σ⁻¹(λ)/k.  k is the model's slope with every
    multiplier of it, the least over what is unknown.  Shares above :data:`MOST` count as that: at 1 the slip
    has no bound.
    """
    z, k = law_inverse(model.grip.law, min(share + ROOM, MOST)), model.grip.k_s_per_m
    if not any(t.target in (Target.STIFFNESS, Target.STIFFNESS_DRIVE) for t in model.grip.multipliers):
        return np.full((motion.count, model.count), z / k)
    slide = motion.velocity @ model.geometry.lateral_rows().T
    creep = np.zeros_like(slide)
    for _ in range(_ROUNDS):  # a slope that depends on the slip is asked again at the slip found
        least = k * _factor(model, motion, slide, creep, Target.STIFFNESS_DRIVE)[0]
        found = np.maximum(creep, z / np.maximum(least, k / _SLACKEST))
        if np.all(found <= creep * (1.0 + 1e-6)):
            break
        creep = found
    return creep


def friction_in_motion(
    model: Model, motion: Motion, *, share: float = 1.0, contact: Contact = Contact.ROLLERS
) -> Friction:
    """Friction of every wheel at each sample.

    Parameters
    ----------
    share : float
        The largest share of the drive grip that will be used: bounds the creep where friction varies
        with slip.
    contact : Contact
        What the wheels stand on.
    """
    grip = model.grip
    slide = motion.velocity @ model.geometry.lateral_rows().T
    creep = creep_bound(model, motion, share)
    drive = _factor(model, motion, slide, creep, Target.DRIVE)
    across = _factor(model, motion, slide, creep, Target.TRANSVERSE)
    steep = _factor(model, motion, slide, creep, Target.STIFFNESS_DRIVE)
    stiffness = grip.k_s_per_m * _factor(model, motion, slide, creep, Target.STIFFNESS_TRANSVERSE)
    bounds = _drag_shares(grip.law, motion, slide, stiffness)
    coefficients = np.stack([grip.roller, grip.rigid])[:, None]  # (2, 1, N, 2)
    full = [
        most_across(grip.shape, grip.coupling, coefficients[..., 0] * d, coefficients[..., 1] * a)
        for d in drive
        for a in across
    ]
    ends = [f * s for f in full for s in bounds]
    drag_low, drag_high = reduce(np.minimum, ends), reduce(np.maximum, ends)
    available = coefficients[..., 0] * drive[0]
    left: Array | float = 1.0
    if not polyhedral(grip.shape, grip.coupling):
        worst = np.maximum(np.abs(drag_low), np.abs(drag_high))
        with np.errstate(divide="ignore", invalid="ignore"):
            used = np.where(worst > 0.0, worst / (coefficients[..., 1] * across[0]), 0.0)
            by_radius = np.where(worst > 0.0, worst / available, 0.0)
        left = drive_left(grip.shape, grip.coupling, used, by_radius)
    return Friction(
        drive=np.broadcast_to(available * left, drag_low.shape),
        drag_low=drag_low,
        drag_high=drag_high,
        transverse=np.broadcast_to(
            0.5 * (reduce(np.minimum, full) + reduce(np.maximum, full)), drag_low.shape
        ),
        possible=_possible(grip, motion, contact),
        slide=slide,
        stiffness=np.broadcast_to(0.5 * (stiffness[0] + stiffness[1]), slide.shape),
        drive_stiffness=np.broadcast_to(0.5 * grip.k_s_per_m * (steep[0] + steep[1]), slide.shape),
    )


def _drag_shares(law: int, motion: Motion, slide: Array, stiffness: Array) -> tuple[Array, Array]:
    if motion.saturated:
        still = STILL * np.max(np.abs(motion.velocity), axis=1, keepdims=True)
        sign = np.where(np.abs(slide) <= still, 0.0, np.sign(slide))
        return sign, sign
    one, two = (np.asarray(law_share(law, k * slide)) for k in stiffness)
    return np.minimum(one, two), np.maximum(one, two)


#: The target that acts on both sides of what a target names.
_BOTH = {
    Target.DRIVE: Target.BOTH,
    Target.TRANSVERSE: Target.BOTH,
    Target.STIFFNESS_DRIVE: Target.STIFFNESS,
    Target.STIFFNESS_TRANSVERSE: Target.STIFFNESS,
}


def _factor(model: Model, motion: Motion, slide: Array, creep: Array, target: Target) -> Array:
    """Lowest and highest product (2, M, N) of the multipliers on ``target``; ones (2, 1, 1) without any."""
    terms = [t for t in model.grip.multipliers if t.target is target or t.target is _BOTH[target]]
    out = np.ones((2, motion.count, model.count) if terms else (2, 1, 1))
    for term in terms:
        v = _values(model, motion, slide, creep, term, target)
        factor = term.factor(v, term.wheels)
        out[0] *= factor.min(axis=0)
        out[1] *= factor.max(axis=0)
    return out


def _values(
    model: Model, motion: Motion, slide: Array, creep: Array, term: Multiplier, target: Target
) -> Array:
    if term.variable is Variable.WHEEL_LOAD:
        external = external_in_motion(model, motion)
        least, most = external.load_change_N
        return load_probes(model, external.standing_N(), most - least)
    across = target in (Target.TRANSVERSE, Target.STIFFNESS_TRANSVERSE)
    return probes(model, motion, slide, creep, term, transverse=across)


def _possible(grip: Grip, motion: Motion, contact: Contact) -> Mask:
    shape = (motion.count, len(grip.rollers))
    rigid = np.zeros(shape, dtype=bool)
    roller = np.ones(shape, dtype=bool)
    if contact is Contact.RIGID:
        rigid, roller = roller, rigid
    elif contact is Contact.UNKNOWN or (contact is Contact.ANGLE and motion.theta is None):
        rigid |= grip.rigid_fraction > 0.0
        roller &= grip.rigid_fraction < 1.0
    elif contact is Contact.ANGLE and motion.theta is not None:
        rigid = on_rigid(motion.theta, pitch(grip.rollers), grip.rigid_fraction)
        roller = ~rigid
    return np.stack([roller, rigid])


def material_states(possible: Mask) -> list[Mask]:
    """The combinations (M, N) of materials to try; one where every wheel's is known."""
    roller, rigid = possible
    if not np.any(either := roller & rigid):
        return [rigid]
    free = np.flatnonzero(np.any(either, axis=0))
    allow_states("wheel", len(free), MOVING_STATES)
    states = []
    for code in range(2 ** len(free)):
        on_rigid = rigid & ~roller
        for bit, i in enumerate(free):
            on_rigid[:, i] |= rigid[:, i] & bool(code >> bit & 1)
        states.append(on_rigid)
    return states
