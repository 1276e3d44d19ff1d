"""External wrenches (rolling resistance, slope, cable) at a state of motion, and the loads they shift."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import product
from typing import final

import numpy as np

from slipmargin.checks import Array, read_only
from slipmargin.limits.bias import height_m, lift_N
from slipmargin.limits.motion_probes import probes
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.physics.constants import SLOW_M_S, SLOW_RAD_S
from slipmargin.physics.frames import moment, rotate_rows
from slipmargin.physics.loads import Loads
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame

#: No acceleration of the centre of mass [m/s²].
NO_ACCELERATION = read_only(np.zeros(2))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class External:
    """Wrenches on the body about its centre of mass at M states, body frame, as boxes [N, N, N m].

    ``low``, ``high`` (G, M, 3) hold one box for each of the heights ``height_m`` (G,) at which forces act;
    equal where every variable is known.  ``load_change_N`` (2, M, N): the least and the greatest change of
    each wheel's load by the forces' heights; ``lift_N`` acts upwards.
    """

    height_m: tuple[float, ...]
    low: Array
    high: Array
    load_change_N: Array
    lift_N: float
    loads: Loads = field(repr=False)

    def least(self, normals: Array, per_load: Array) -> Array:
        """(M, K) least n·w + p·N at zero acceleration over the boxes, N the loads under the same wrenches.

        Parameters
        ----------
        normals, per_load : (K, 3), (M, K, N)
        """
        each = [
            (per_load @ load if load.ndim == 1 else (per_load @ load[:, :, None])[..., 0])
            + least_product(normals, low, high)
            for low, high, load in self.cases()
        ]
        return np.asarray(np.min(each, axis=0) if len(each) > 1 else each[0])

    def cases(self, acceleration: Array = NO_ACCELERATION) -> Iterator[tuple[Array, Array, Array]]:
        """Boxes (M, 3), (M, 3) of wrenches, each with the loads at an acceleration of the centre of mass.

        A force with a height stands at a corner of its box, so that loads and wrench belong together: what
        is linear in both takes its extremes there.  ``acceleration`` is (2,), and the loads (N,) where no
        force has a height, or (M, 2 or more).  On an uneven floor every corner of the loads' band is a case.
        """
        if not self.tilts and not len(self.loads.uneven_N):  # what most robots are: one case
            yield self.low[0], self.high[0], self._loads(acceleration, [])
            return
        shifts = self.loads.shifts()
        corners: list[list[tuple[Array, Array]]] = []
        for height, low, high in zip(self.height_m, self.low, self.high, strict=True):
            if height == 0.0 or np.array_equal(low[:, :2], high[:, :2]):
                corners.append([(low, high)])
                continue
            corners.append([])
            for right, forward in product((low, high), repeat=2):
                force = [right[:, :1], forward[:, 1:2]]
                corners[-1].append((np.hstack([*force, low[:, 2:]]), np.hstack([*force, high[:, 2:]])))
        for chosen in product(*corners):
            low, high = (sum(boxes[1:], start=boxes[0]) for boxes in zip(*chosen, strict=True))
            load = self._loads(acceleration, [box[0] for box in chosen])
            for shift in shifts:
                yield low, high, load + shift

    def middle(self, acceleration: Array) -> tuple[Array, Array]:
        """The boxes' middle (M, 3) and the loads (M, N) under it at an acceleration, on an even floor."""
        middle = 0.5 * (self.low + self.high)
        return np.asarray(middle.sum(axis=0)), self._loads(acceleration, list(middle))

    def standing_N(self) -> Array:
        """Least loads (M, N) at zero acceleration on an even floor: one wheel in the air is no tipping."""
        return np.asarray(self.loads.at(NO_ACCELERATION, lift_N=self.lift_N) + self.load_change_N[0])

    def corners(self) -> Iterator[tuple[Array, Array]]:
        """Wrenches (M, 3) at the corners of the boxes without acceleration, each with its loads."""
        for low, high, load in self.cases():
            if not np.any(wide := low < high):
                yield low, load
                continue
            unknown = np.flatnonzero(np.any(wide, axis=0))
            for sides in product((low, high), repeat=len(unknown)):
                corner = low.copy()
                for j, side in zip(unknown, sides, strict=True):
                    corner[:, j] = side[:, j]
                yield corner, load

    @property
    def tilts(self) -> bool:
        """Whether a force acts above the floor."""
        return any(self.height_m)

    def _loads(self, acceleration: Array, wrenches: list[Array]) -> Array:
        if not self.tilts:
            return self.loads.at(acceleration, lift_N=self.lift_N)
        tilting = np.sum([h * w[:, :2] for h, w in zip(self.height_m, wrenches, strict=True)], axis=0)
        return self.loads.at(acceleration, tilting, self.lift_N)


def tipping(model: Model, motion: Motion, load_N: Array) -> Array:
    """Share (M, N) of its load at constant speed that a wheel with the load ``load_N`` loses; 1 lifts it."""
    if not model.loads.follow_acceleration:
        return np.zeros_like(load_N)
    standing = external_in_motion(model, motion).middle(np.zeros((motion.count, 2)))[1]
    return np.asarray(
        np.maximum(standing - load_N, 0.0) / np.maximum(standing, 1e-12 * model.inertia.weight_N)
    )


def least_product(normals: Array, low: Array, high: Array) -> Array:
    """(M, K) least n·w over boxes of wrenches (M, 3), normals (K, 3)."""
    return np.asarray(low @ np.maximum(normals, 0.0).T + high @ np.minimum(normals, 0.0).T)


def external_in_motion(model: Model, motion: Motion) -> External:
    """The external wrenches at every state.

    The viscous part of the transverse friction, −c u·f̂ on each wheel, is here too, since no load bounds it.
    """
    none = np.zeros((motion.count, 3))
    groups: dict[float, tuple[Array, Array]] = {0.0: (none, none)}
    change = np.zeros((2, motion.count, model.count))
    for term in model.external.terms:
        each, height = _term(model, motion, term), height_m(model, term)
        low, high = groups.get(height, (none, none))
        groups[height] = low + each.min(axis=0), high + each.max(axis=0)
        if height != 0.0:
            shift = height * each[..., :2] @ model.loads.per_moment_1_per_m.T
            change += np.stack([shift.min(axis=0), shift.max(axis=0)])
    viscous = model.grip.viscous_N_s_per_m[1]
    if viscous:
        slide = motion.velocity @ model.geometry.lateral_rows().T
        drag = -viscous * slide @ model.wrench_maps()[1].T
        groups[0.0] = groups[0.0][0] + drag, groups[0.0][1] + drag
    return External(
        height_m=tuple(groups),
        low=np.stack([low for low, _ in groups.values()]),
        high=np.stack([high for _, high in groups.values()]),
        load_change_N=change,
        lift_N=lift_N(model),
        loads=model.loads,
    )


def _term(model: Model, motion: Motion, term: ForceTerm) -> Array:
    nothing = np.zeros((motion.count, model.count))
    v = probes(model, motion, nothing, nothing, term)[..., 0]
    if term.basis is Basis.ODD:
        term = replace(term, shape=term.shape * [motion.fade, 1.0])
    wrench = np.broadcast_to(term.wrench(v), (len(v), motion.count, 3))
    if term.frame is Frame.BODY:
        return np.asarray(wrench)
    if term.frame is Frame.FLOOR:
        return _from_floor(motion, wrench)
    v, spin = motion.velocity[:, :2], motion.velocity[:, 2]
    x, y = term.place_m
    if term.frame is Frame.AT_PLACE:
        v = v + spin[:, None] * np.array([-y, x])
    ahead = v / np.sqrt(np.sum(v**2, axis=1, keepdims=True) + (motion.fade * SLOW_M_S) ** 2)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    out = np.empty(wrench.shape)
    out[..., :2] = -wrench[..., :1] * ahead + wrench[..., 1:2] * left
    out[..., 2] = -wrench[..., 2] * spin / np.sqrt(spin**2 + (motion.fade * SLOW_RAD_S) ** 2)
    if term.frame is Frame.AT_PLACE:
        arm = term.place_m - model.inertia.com_m
        out[..., 2] += moment(arm[0], arm[1], out[..., 0], out[..., 1])
    return out


def _from_floor(motion: Motion, wrench: Array) -> Array:
    """R(φ)ᵀ of the force; over all headings where φ is unknown."""
    if motion.heading is not None:
        return rotate_rows(motion.heading, wrench, inverse=True)
    phi = np.linspace(-np.pi, np.pi, 73)[:, None, None]
    return rotate_rows(phi, wrench, inverse=True).reshape(-1, *wrench.shape[1:])
