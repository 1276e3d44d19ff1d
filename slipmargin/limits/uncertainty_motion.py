"""The chance of slip in motion, by sampling the rows of docs/theory.md, section 4.

With all of the grip the realised and the best distribution end at the same wrench, so whether a draw slips is
decided by the facets of the drive zonotope alone, for any number of wheels: n·M a − n·w ≤ Σ κ_i N_i(a).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bounds import ahead_of
from slipmargin.limits.motion_external import external_in_motion, least_product
from slipmargin.limits.motion_friction import (
    FrictionRange,
    friction_range,
    material_states,
    possible_materials,
)
from slipmargin.limits.motion_rows import Facets
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.uncertainty import Draws
from slipmargin.model import Model
from slipmargin.physics.frames import moment
from slipmargin.physics.kinematics import com_acceleration
from slipmargin.work import DRAWN_FACETS, allow

#: Draws at once, for the cache.
_BLOCK = 250
#: Directions of motion over which a recommended acceleration is sampled.
DIRECTIONS = 72
#: Draws that look at every sample of a motion, to find those where any draw needs most.
_SCOUTS = 64


def lowest_starts(model: Model, drawn: Draws, contact: Contact = Contact.ROLLERS) -> Array:
    """The acceleration (D,) at which a draw slips or tips, the lowest over directions of motion [m/s²].

    As :func:`~slipmargin.limits.bounds.directions` with all of the grip, full drag and no motor.  0 where the
    draw slips at constant speed or falls over.
    """
    ahead = ahead_of(2.0 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS)
    sampled = _Sampled(model, Motion.full_drag(ahead), contact)
    out = np.empty(len(drawn))
    for start in range(0, len(drawn), _BLOCK):
        rows = slice(start, start + _BLOCK)
        out[rows] = _starts(sampled, drawn.take(rows), ahead)
    return np.asarray(np.maximum(out, 0.0))


def needed_shares(model: Model, drawn: Draws, motion: Motion, contact: Contact = Contact.ROLLERS) -> Array:
    """The largest share (D,) of the grip that a draw needs anywhere in a motion; above 1 it slips.

    Infinite where a wheel lifts.  Samples at which none of a few draws needs most are left out.
    """
    scouts = _needed(_Sampled(model, motion, contact), drawn.take(slice(0, _SCOUTS)), motion)
    some = motion.take(np.unique(np.argmax(scouts, axis=0)))
    sampled, out = _Sampled(model, some, contact), np.empty(len(drawn))
    for start in range(0, len(drawn), _BLOCK):
        rows = slice(start, start + _BLOCK)
        out[rows] = np.max(_needed(sampled, drawn.take(rows), some), axis=0)
    return out


class _Sampled:
    """What all draws of a motion share; arrays are states M × draws b × wheels N or facets K."""

    def __init__(self, model: Model, motion: Motion, contact: Contact) -> None:
        self.model = model
        self.facets, self.external = Facets.of(model), external_in_motion(model, motion)
        self.known = friction_range(model, motion)
        self.materials = material_states(possible_materials(model.grip, motion.count, contact))
        size = len(self.materials) * len(self.facets.normals) * model.count
        cure = "leave out --robust, or the ± of the robot's numbers"
        allow("wheel", size, DRAWN_FACETS, "facets times wheels for each drawn robot", cure)

    def grips(self, drawn: Draws) -> Iterator[tuple[Array, Array, Array]]:
        """Drive grip, middle and half the width of the drag per load, each (M, b, N), for each material."""
        grip, known = self.model.grip, self.known
        slopes = known.drive_stiffness[:, :, None], known.stiffness[:, :, None]
        for pick in self.materials:
            rigid = pick | (grip.rigid_fraction >= 1.0)  # all round: its coefficients are those
            ways = np.where(rigid[:, None, :, None], drawn.rigid[:, None], drawn.roller[:, None])
            drive, transverse = (
                np.where(pick, both[:, 1], both[:, 0])[:, :, None] * ways[..., k]
                for k, both in enumerate((known.drive, known.transverse))
            )
            own = FrictionRange(
                slide=known.slide[:, None],
                full=known.full,
                drive=drive,
                transverse=transverse,
                drive_stiffness=slopes[0],
                stiffness=slopes[1],
            )
            low, high, _, left = own.beside_drag(grip)
            yield left, 0.5 * (low + high), 0.5 * (high - low)

    def cases(self, drawn: Draws) -> Iterator[tuple[Array, Array, Array]]:
        """Boxes of wrenches (M, 3), and the loads (M, b, N) without acceleration under them."""
        rest = self.model.loads.rest_N
        for low, high, load in self.external.cases():
            change = np.broadcast_to(load - rest, (len(low), len(rest)))
            yield low, high, drawn.rest_N + change[:, None]

    def standing(self, drawn: Draws) -> Array:
        """Loads (M, b, N) without acceleration on an even floor, the least over what is unknown."""
        change = self.external.standing_N() - self.model.loads.rest_N  # (M, N)
        return np.asarray(drawn.rest_N + change[:, None])

    def given(self, low: Array, high: Array, shift: Array) -> Array:
        """n·w (M, b or 1, K), the least over a box of wrenches that act at the drawn centre of mass."""
        normals = self.facets.normals
        push = least_product(normals, low, high)[:, None]
        if not (np.any(low) or np.any(high)) or not np.any(shift):
            return push
        right, forward = (0.5 * (low + high)[:, None, :2]).transpose(2, 0, 1)
        turn = moment(shift[:, 0], shift[:, 1], right, forward)
        return np.asarray(push + turn[..., None] * normals[:, 2])

    def asked(self, drawn: Draws, acceleration: Array) -> Array:
        """n·M a (M, b, K) of accelerations (M, b or 1, 3) of the drawn centre of mass."""
        inertia, normals = self.model.inertia, self.facets.normals
        force = inertia.mass_kg * drawn.mass[:, None] * acceleration[..., :2]
        turn = inertia.inertia_kg_m2 * drawn.inertia * acceleration[..., 2]
        aside, ahead = drawn.com_shift_m.T
        turn = turn + moment(aside, ahead, force[..., 0], force[..., 1])
        return np.asarray(np.concatenate([force, turn[..., None]], axis=-1) @ normals.T)


def _worth(facets: Facets, grip: tuple[Array, Array, Array], load: Array) -> tuple[Array, Array]:
    """What loads (M, b, N) are worth to each facet and what they lose to drag, both (M, b, K)."""
    drive, middle, half = grip
    lost = (middle * load) @ facets.across.T
    if np.any(half):
        lost += (half * load) @ np.abs(facets.across).T
    return (drive * load) @ facets.drive.T, lost


def _starts(s: _Sampled, drawn: Draws, ahead: Array) -> Array:
    """(b,) lowest multiple of any of the directions that a draw holds."""
    asked = s.asked(drawn, ahead[:, None, :])
    shift = np.einsum("bnc,mc->mbn", drawn.per_acceleration_kg, ahead[:, :2])
    best = np.full(len(drawn), np.inf)
    for grip in s.grips(drawn):
        held, lost = _worth(s.facets, grip, shift)
        slope = asked - held + lost
        for low, high, load in s.cases(drawn):
            held, lost = _worth(s.facets, grip, np.maximum(load, 0.0))
            room = held - lost + s.given(low, high, drawn.com_shift_m)
            limit = np.full(slope.shape, np.inf)
            np.divide(room, slope, out=limit, where=slope > 1e-12 * np.max(np.abs(slope)))
            best = np.minimum(best, limit.min(axis=(0, 2)))
    standing = s.standing(drawn)
    lifts = np.full(standing.shape, np.inf)
    np.divide(standing, -shift, out=lifts, where=shift < 0.0)
    best = np.minimum(best, lifts.min(axis=(0, 2)))
    return np.where(standing.min(axis=(0, 2)) < 0.0, 0.0, best)


def _needed(s: _Sampled, drawn: Draws, motion: Motion) -> Array:
    """(M, b) share of the grip that each draw needs at each sample."""
    assert motion.acceleration is not None
    turn, spin = motion.acceleration[:, None, 2:], motion.velocity[:, None, 2:]
    c = drawn.com_shift_m
    a = com_acceleration(s.model.inertia.com_m, motion.velocity, motion.acceleration)[:, None]
    off = turn * np.column_stack([-c[:, 1], c[:, 0]]) - spin**2 * c
    a = np.concatenate([a[..., :2] + off, np.broadcast_to(turn, (*off.shape[:2], 1))], axis=-1)
    asked, shift = s.asked(drawn, a), np.einsum("bnc,mbc->mbn", drawn.per_acceleration_kg, a[..., :2])
    need = np.zeros(asked.shape[:2])
    for grip in s.grips(drawn):
        for low, high, load in s.cases(drawn):
            held, lost = _worth(s.facets, grip, np.maximum(load + shift, 0.0))
            top = asked - s.given(low, high, c) + lost
            share = np.where(top > 1e-12 * np.max(np.abs(asked)), np.inf, 0.0)
            np.divide(top, held, out=share, where=held > 1e-12 * np.max(held))
            need = np.maximum(need, share.max(axis=-1))
    return np.where((s.standing(drawn) + shift).min(axis=-1) < 0.0, np.inf, need)
