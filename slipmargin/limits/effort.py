"""What accelerations at full drag ask of wheels and motors: realised shares of the grip, and torques."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.limits.creep import (
    ASKED,
    EXACT,
    GRIP,
    NEED,
    SCALE,
    SLIDE,
    STEEP,
    TABLES,
    WHEEL,
    at_rest,
    continued,
    knee,
    slip,
)
from slipmargin.limits.motion_external import External
from slipmargin.limits.motion_friction import Friction, material_states
from slipmargin.limits.motion_realised import LIGHTEST, comparable
from slipmargin.limits.spin_up import spin_at_constant, spin_by_acceleration, spin_torque
from slipmargin.model import Model
from slipmargin.physics.compiled import kernel

#: Share of its grip that no wheel exceeds; above 1 because the friction law is continued there [1].
WHOLE = 1.1
#: Size of the residual, as a share of a wrench to compare with, at which a creep is known well enough for
#: sets that keep a share to a thousandth [1].
NEARLY = 1e-7


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Most:
    """The most that accelerations of M states ask of any wheel: shares of its grip and of its motor's torque.

    ``use`` and ``motors`` (R, M) at each acceleration; ``torque_N_m`` (2, M, N) over all of them.
    """

    use: Array
    motors: Array
    torque_N_m: Array

    @property
    def first(self) -> Most:
        """What the first of the accelerations asks for, as one (1, M)."""
        return replace(self, use=self.use[:1], motors=self.motors[:1])

    @staticmethod
    def of(parts: Sequence[Most]) -> Most:
        """The most that any of several sets of accelerations of the same M states asks, as one (1, M)."""
        return Most(
            use=np.max([part.use.max(axis=0) for part in parts], axis=0)[None],
            motors=np.max([part.motors.max(axis=0) for part in parts], axis=0)[None],
            torque_N_m=reduce(np.maximum, [part.torque_N_m for part in parts]),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Effort:
    """Largest realised share ``use`` (R, M) of any wheel's grip, and its torques.

    ``torque_N_m`` (2, R, M, N): the greatest motor torque T = −ρ F·ŝ + J θ̈ of each wheel and the
    greatest −T.
    """

    use: Array
    torque_N_m: Array

    def of_motors(self, limit_N_m: Array) -> Array:
        """Largest share (R, M) of a motor's torque, where motors give ``limit_N_m`` (2, M or R and M, N)."""
        limit = limit_N_m if limit_N_m.ndim == 4 else limit_N_m[:, None]
        share = np.full(self.torque_N_m.shape, np.inf)
        np.divide(self.torque_N_m, limit, out=share, where=limit > 0.0)
        return np.asarray(np.where(self.torque_N_m > 0.0, share, 0.0).max(axis=(0, 3)))


def efforts(
    model: Model, friction: Friction, external: External, velocity: Array, acceleration: Array
) -> Effort:
    """What accelerations (R, M, 3) of the centre of mass and in yaw ask for in states ``velocity`` (M, 3).

    The worst over the materials that the wheels may stand on and over external wrenches that are not known.
    """
    return Demands.of(model, friction, external, velocity).each(acceleration)


def coasting_use(model: Model, friction: Friction, external: External, count: int) -> Array:
    """Largest realised share (M,) of any wheel's grip at constant speed in each of ``count`` states M."""
    still = np.zeros((1, count, 3))
    return np.asarray(efforts(model, friction, external, still[0], still).use[0])


def greatest_torque(
    model: Model, friction: Friction, external: External, velocity: Array, acceleration: Array
) -> Array:
    """Torques (R, M, N) [N m] no motor exceeds at accelerations (R, M, 3), with each wheel's whole grip."""
    on_drive, on_side = np.abs(model.geometry.torque_arms())
    drag = np.maximum(np.abs(friction.drag_low), np.abs(friction.drag_high))
    each = on_drive * WHOLE * friction.drive + on_side * drag
    worst = np.where(friction.possible, each, 0.0).max(axis=0)
    load = np.max([load for *_, load in external.cases()], axis=0)
    moved = acceleration[..., :2] @ model.loads.per_acceleration_kg.T
    lightest = LIGHTEST * model.inertia.weight_N / model.count
    spin = spin_torque(model, velocity, acceleration)
    return np.asarray(worst * np.maximum(load + moved, lightest) + np.abs(spin))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Demands:
    """M states of a model, ready to be asked what accelerations take; every combination that may be met.

    ``kind`` (M,) is equal for neighbours that are alike in all but the torque that their motors have: what
    one acceleration asks of their wheels is found once.  ``fixed`` and each of ``cases`` are the arguments of
    :func:`_raise`.
    """

    states: int
    count: int
    kind: Index
    fixed: tuple[Any, ...]
    cases: tuple[tuple[Array, ...], ...]

    @staticmethod
    def of(
        model: Model, friction: Friction, external: External, velocity: Array, kind: Index | None = None
    ) -> Demands:
        """States of ``friction``, ``external``, ``velocity`` (M, 3); each its own ``kind`` by default."""
        states = friction.drive.shape[1]
        along, across = model.wrench_maps()
        middle = 0.5 * (friction.drag_low + friction.drag_high)
        cases = []
        for pick in material_states(friction.possible):
            mu = _full(np.where(pick, friction.drive[1], friction.drive[0]), states, model.count)
            drag = _full(np.where(pick, middle[1], middle[0]), states, model.count)
            for wrench, load in external.corners():
                cases.append((mu, drag, _full(load, states, model.count), _full(wrench, states, 3)))
        fixed = (
            model.grip.law,
            knee(model.grip.law),
            np.concatenate([along, across]),
            np.array(model.loads.per_acceleration_kg, dtype=float),
            np.array(model.inertia.diagonal, dtype=float),
            -model.geometry.torque_arms(),
            comparable(model),
            LIGHTEST * model.inertia.weight_N / model.count,
            _full(friction.drive_stiffness, states, model.count),
            spin_by_acceleration(model),
            _full(spin_at_constant(model, velocity), states, model.count),
        )
        alone = np.arange(states) if kind is None else kind
        return Demands(states=states, count=model.count, kind=alone, fixed=fixed, cases=tuple(cases))

    def most(
        self,
        acceleration: Array,
        which: Index,
        limit_N_m: Array,
        *,
        near: bool = False,
        creep: Array | None = None,
    ) -> Most:
        """What accelerations (R, G, 3) ask for at most, where motors give ``limit_N_m`` (2, M, N).

        ``which`` (M,) of the G columns is for each state.  ``near`` says that all but the first are close to
        it, for a slope: their torques do not count.  ``creep`` of :meth:`unknown` keeps what was found, for
        like accelerations that are asked for next.
        """
        use, motors, torque = self._asked(acceleration, which, limit_N_m, 1, NEARLY, near, creep)
        return Most(use=use, motors=motors, torque_N_m=torque[:, 0])

    def unknown(self, rows: int, columns: int) -> Array:
        """The creep of accelerations (rows, columns, 3) of which none has been found."""
        return np.full((len(self.cases), rows, columns, 3), np.nan)

    def each(self, acceleration: Array) -> Effort:
        """What each of the accelerations (R, M, 3) asks for."""
        none, each = np.full((2, self.states, self.count), np.inf), np.arange(self.states)
        use, _, torque = self._asked(acceleration, each, none, len(acceleration), EXACT)
        return Effort(use=use, torque_N_m=torque)

    def _asked(
        self,
        acceleration: Array,
        which: Index,
        limit_N_m: Array,
        rows: int,
        exact: float,
        near: bool = False,
        creep: Array | None = None,
    ) -> tuple[Array, Array, Array]:
        """Shares of grip and torque (R, M) and torques (2, rows, M, N): the worst over all combinations.

        ``rows`` is R, or 1 for the greatest torques over all accelerations; ``creep`` (cases, R, G, 3) is
        where to start, and becomes what is found.
        """
        use, motors = np.zeros((2, self.states, len(acceleration)))
        torque = np.zeros((2, rows, self.states, self.count))
        each = np.zeros((len(acceleration), 2, self.count))  # a wheel's share of its grip, and its torque
        if creep is None:
            creep = self.unknown(*acceleration.shape[:2])
        asked = np.ascontiguousarray(acceleration, dtype=float), np.ascontiguousarray(limit_N_m, dtype=float)
        for case, start in zip(self.cases, creep, strict=True):
            tables = np.zeros((self.count, WHEEL)), np.zeros(ASKED), each, start, np.zeros(TABLES)
            more: tuple[Any, ...] = (self.kind, which, *asked, exact, near, *tables, use, motors, torque)
            _raise(*self.fixed, *case, *more)
        return use.T, motors.T, torque


def _full(values: Array, states: int, count: int) -> Array:
    return np.array(np.broadcast_to(values, (states, count)), dtype=float)


@kernel
def _raise(
    law: int,
    top: float,
    forces: Array,
    per_acceleration: Array,
    inertia: Array,
    on_wheel: Array,
    scale: Array,
    lightest: float,
    steep: Array,
    spin: Array,
    steady: Array,
    mu: Array,
    drag: Array,
    load: Array,
    wrench: Array,
    kind: Index,
    which: Index,
    acceleration: Array,
    limit: Array,
    exact: float,
    near: bool,
    wheels: Array,
    ask: Array,
    each: Array,
    creep: Array,
    tables: Array,
    use: Array,
    motors: Array,
    torque: Array,
) -> None:
    """Raise ``use``, ``motors`` (M, R) and ``torque`` (2, R or 1, M, N) to what one combination asks for.

    M a = w + Σ b_i f_i − Σ t_i D_i N_i with one creep of all wheels (:mod:`slipmargin.limits.creep`).
    ``forces`` (6, N) are the wrenches of unit forces along ĝ and f̂, ``on_wheel`` (2, N) their torques T;
    ``spin`` (N, 3) and ``steady`` (M, N) the torque of the wheels' own inertia, by acceleration and without.
    The k-th acceleration of state m is that of column ``which[m]``.  What is asked again of a state's
    neighbour of its ``kind`` (M,) has the same answer.  ``creep`` (R, G, 3) is where to start, from the
    neighbour's where it is not a number, and becomes what is found.  Where the accelerations are ``near`` the
    first one, they start from its creep, and their torques do not count.
    """
    for r in range(3):
        ask[SCALE + r] = scale[r]
    for m in range(len(which)):
        for k in range(len(acceleration)):
            share, turn, eps = each[k, 0], each[k, 1], creep[k, which[m]]
            a, last = acceleration[k, which[m]], acceleration[k, which[max(m - 1, 0)]]
            known = m > 0 and kind[m] == kind[m - 1]
            if not (known and a[0] == last[0] and a[1] == last[1] and a[2] == last[2]):
                for r in range(3):
                    ask[NEED + r] = a[r] * inertia[r] - wrench[m, r]
                    if near and k > 0:
                        eps[r] = creep[0, which[m], r]
                    elif m > 0 and math.isnan(eps[r]):
                        eps[r] = creep[k, which[m - 1], r]
                for i in range(len(wheels)):
                    carried = load[m, i] + a[0] * per_acceleration[i, 0] + a[1] * per_acceleration[i, 1]
                    wheels[i, GRIP] = mu[m, i] * max(carried, lightest)
                    wheels[i, STEEP] = steep[m, i]
                    wheels[i, SLIDE] = -drag[m, i] * carried  # the force across the rollers: it is known
                    for r in range(3):
                        ask[NEED + r] -= forces[3 + r, i] * wheels[i, SLIDE]
                found = at_rest(law, top, forces, wheels, ask, eps, exact, tables, share)
                for i in range(len(wheels)):
                    along = -wheels[i, GRIP] * continued(law, top, slip(forces, steep[m, i], eps, i))[0]
                    turn[i] = on_wheel[0, i] * along + on_wheel[1, i] * wheels[i, SLIDE]
                if not found:
                    for r in range(3):
                        eps[r] = 0.0
            row = min(k, torque.shape[1] - 1)
            for i in range(len(wheels)):
                use[m, k] = max(use[m, k], share[i])
                given = turn[i] + steady[m, i]
                for r in range(3):
                    given += spin[i, r] * a[r]
                side = 0 if given > 0.0 else 1
                if given != 0.0:
                    motors[m, k] = max(motors[m, k], abs(given) / max(limit[side, m, i], 0.0))
                if k == 0 or not near:
                    torque[side, row, m, i] = max(torque[side, row, m, i], abs(given))
