"""Friction that a moving wheel has: its drive grip and its drag, each per unit of load.

In motion the force across the rollers is not free: it is −μ_T N σ(k u·f̂) with the model's friction law
σ (docs/theory.md, section 4); of a coupled grip it is that of a wheel that slips across alone.
Multipliers are evaluated where their variable is known; where it is not they give an interval, of which
a limit takes the worst.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce
from itertools import product
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_probes import load_probes, probes
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.friction_laws import law_inverse
from slipmargin.physics.grips import across_alone, drive_left, most_across, rise_across
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
#: Slips are taken as no slower than this over k, and shares as no larger than this, where a slope follows
#: from both [1]: rounding is far smaller, and the law is straight or full there.
SLOWEST, WHOLLY = 1e-4, 1.0 - 1e-9
#: Rounds after which a slope that falls with the slip is taken as found, and the least k over the file's.
_ROUNDS, _SLACKEST = 30, 1e6


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Friction:
    """Friction per load of M samples and N wheels on the two materials (roller, rigid).

    ``drive`` (2, M, N): |f·ĝ| ≤ drive · N_i.  The force along f̂ is −D N_i with D anywhere in
    [``drag_low``, ``drag_high``].  ``possible`` (2, M, N) says on which material a wheel may stand.
    ``slide`` (M, N) is the transverse slip u [m/s], ``transverse`` (2, M, N) the most that the drag can be,
    of which it is the share σ(k u) with ``stiffness`` k (2, M, N): the law's slope of a box, and of a coupled
    grip the one that gives its drag at this slip.  ``drive_stiffness`` (M, N) is k in the drive direction.
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
        least = _steepness(model.grip, _factor(model, motion, slide, creep, Target.STIFFNESS_DRIVE)[0])
        found = np.maximum(creep, z / least)
        if np.all(found <= creep * (1.0 + 1e-6)):
            break
        creep = found
    return creep


def _steepness(grip: Grip, factor: Array) -> Array:
    """Slope k of the friction law [s/m] with a factor of it, which may be 0 where friction fades: never 0."""
    return grip.k_s_per_m * np.maximum(factor, 1.0 / _SLACKEST)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrictionRange:
    """Least and greatest friction of M samples and N wheels, each (2, ...) with the multipliers' intervals.

    ``drive`` and ``transverse`` (2, 2, M, N): coefficients, the second axis the materials (roller, rigid);
    ``drive_stiffness`` and ``stiffness`` (2, M, N): slopes k of the friction law along and across [s/m].
    ``slide`` (M, N) is the transverse slip [m/s]; where the drag is taken in ``full`` only its sign counts.
    """

    slide: Array
    full: bool
    drive: Array
    transverse: Array
    drive_stiffness: Array
    stiffness: Array

    def beside_drag(self, grip: Grip) -> tuple[Array, Array, Array, Array]:
        """Least and greatest drag per load, the middle of the most it can be, and what it leaves to drive.

        Drags have the sign of the slip.  What is left is that of the combination of ends that leaves least.
        """
        coupling = grip.coupled_part
        most, drags, left = [], [], []
        slopes = _different(np.stack([self.drive_stiffness, self.stiffness], axis=1))
        for drive, across in product(_different(self.drive), _different(self.transverse)):
            most.append(most_across(grip.shape, grip.coupling, drive, across))
            for steep, steep_across in slopes[:1] if self.full else slopes:
                if self.full:
                    drag = most[-1] * np.sign(self.slide)
                else:
                    coupled = rise_across(grip.shape, drive, across, steep)
                    drag = across_alone(grip.law, coupling, self.slide, (across, steep_across), coupled)
                drags.append(drag)
                left.append(drive * _share_left(grip, np.abs(drag), drive, across) if coupling else drive)
        return (
            reduce(np.minimum, drags),
            reduce(np.maximum, drags),
            0.5 * (reduce(np.minimum, most) + reduce(np.maximum, most)),
            reduce(np.minimum, left),
        )


def _share_left(grip: Grip, drag: Array, drive: Array, across: Array) -> Array:
    """Share of the drive grip that a drag leaves [1]."""
    with np.errstate(divide="ignore", invalid="ignore"):
        by_limit, by_radius = (np.where(drag > 0.0, drag / most, 0.0) for most in (across, drive))
    return drive_left(grip.shape, grip.coupling, by_limit, by_radius)


def _different(ends: Array) -> Array:
    """Both ends (2, ...) of intervals, or one where all are known."""
    return ends[:1] if np.array_equal(ends[0], ends[1]) else ends


def friction_range(model: Model, motion: Motion, *, share: float = 1.0) -> FrictionRange:
    """Coefficients and slopes of every wheel; ``share`` bounds the creep that they may vary with."""
    grip, shape = model.grip, (2, 2, motion.count, model.count)
    slide = motion.velocity @ model.geometry.lateral_rows().T
    creep = creep_bound(model, motion, share)
    factor = {target: _factor(model, motion, slide, creep, target) for target in _BOTH}
    alone = np.stack([grip.roller, grip.rigid])[:, None]  # (2, 1, N, 2)
    # A law that surely has no slope has no force at whatever slip.
    along = factor[Target.STIFFNESS_DRIVE][1] > 1.0 / _SLACKEST
    across = factor[Target.STIFFNESS_TRANSVERSE][1] > 1.0 / _SLACKEST
    still = STILL * np.max(np.abs(motion.velocity), axis=1, keepdims=True)
    return FrictionRange(
        slide=np.where(np.abs(slide) <= still, 0.0, slide) if motion.saturated else slide,
        full=motion.saturated,
        drive=np.broadcast_to(alone[..., 0] * (factor[Target.DRIVE] * along)[:, None], shape),
        transverse=np.broadcast_to(alone[..., 1] * (factor[Target.TRANSVERSE] * across)[:, None], shape),
        drive_stiffness=np.broadcast_to(_steepness(grip, factor[Target.STIFFNESS_DRIVE]), shape[1:]),
        stiffness=np.broadcast_to(_steepness(grip, factor[Target.STIFFNESS_TRANSVERSE]), shape[1:]),
    )


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
    grip, known = model.grip, friction_range(model, motion, share=share)
    low, high, transverse, drive = known.beside_drag(grip)
    return Friction(
        drive=np.broadcast_to(drive, low.shape),
        drag_low=low,
        drag_high=high,
        transverse=transverse,
        possible=possible_materials(grip, motion.count, contact),
        slide=known.slide,
        stiffness=_through(grip, known, transverse)
        if grip.coupled_part
        else np.broadcast_to(np.mean(known.stiffness, axis=0), low.shape),
        drive_stiffness=np.mean(known.drive_stiffness, axis=0),
    )


def _through(grip: Grip, known: FrictionRange, transverse: Array) -> Array:
    """Slopes k (2, M, N) with which ``transverse`` · σ(k u) is the drag of a coupled grip at the slip u."""
    steepest = np.maximum(known.drive_stiffness[1], known.stiffness[1])
    slip = np.maximum(np.abs(known.slide), SLOWEST / steepest)
    low, high, _, _ = replace(known, slide=slip, full=False).beside_drag(grip)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(transverse > 0.0, 0.5 * (low + high) / transverse, 0.0)
    return np.asarray(law_inverse(grip.law, np.minimum(share, WHOLLY)) / slip)


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


def possible_materials(grip: Grip, count: int, contact: Contact) -> Mask:
    """On which material (2, M, N) each wheel may stand, for a ``count`` M of samples."""
    shape = (count, len(grip.rollers))
    rigid = np.zeros(shape, dtype=bool)
    roller = np.ones(shape, dtype=bool)
    if contact is Contact.RIGID:
        rigid, roller = roller, rigid
    elif contact is Contact.UNKNOWN:
        rigid |= grip.rigid_fraction > 0.0
        roller &= grip.rigid_fraction < 1.0
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
