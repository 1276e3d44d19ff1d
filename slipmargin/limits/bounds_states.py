"""The motions that safe sets of accelerations must hold in, and the rows that each of them gives.

The drag of a wheel at full slip depends on which way it slides only.  So many motions ask the same of all
wheels and differ by the torque alone that the motors have left at their speeds: they are of one kind, whose
forces are found once.  Those of a kind in which each axis moves the same way are a run, whose rows are found
once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index
from slipmargin.errors import NoSolution
from slipmargin.limits.effort import Demands, Most
from slipmargin.limits.every_motion import all_motions
from slipmargin.limits.margin import sphere, unit
from slipmargin.limits.motion import needed_share
from slipmargin.limits.motion_external import External
from slipmargin.limits.motion_friction import Friction
from slipmargin.limits.motion_rows import (
    MOTOR,
    AccelerationRows,
    Facets,
    TorqueRows,
    acceleration_rows,
    at_pace,
    prepare,
    torque_limit,
    torque_rows,
)
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.physics.kinematics import com_acceleration
from slipmargin.sets.alike import alike

#: Share of the motors' top speed up to which the sets hold at least: there a motor's power is greatest [1].
PACE = 0.5
#: How close to the share that may be used a set ends [1].
CLOSE = 1e-3
#: Ends of a round set that are tried all round, and at most along rows' normals: of more than eight wheels
#: the normals that lie farthest apart; what is between, the way uphill finds.
SPREAD, ALONG_ROWS = 48, 64


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class States:
    """What all the sets ask of the M motions, of G kinds, in P runs.

    ``first`` (P,) is where each run begins and ``run`` (M,) to which a motion belongs, ``kind`` (M,) which
    kind it is of; ``sign`` (P, 3) of the velocity.  ``normals`` (E, G, 3) are directions in which round sets
    may end; ``rows`` the safe rows of the whole share.  ``least`` and ``steady`` (2, M): the shares of grip
    and torque that constant speed needs and really uses.  ``limit_N_m`` (2, M, N): the torque that motors
    have at :data:`PACE`.
    """

    model: Model
    share: float
    contact: Contact
    motion: Motion
    first: Index
    run: Index
    kind: Index
    parts: tuple[Facets, Friction, External]  #: of the runs
    torque: TorqueRows | None  #: of the runs; None where motors have no stall torque
    demands: Demands
    limit_N_m: Array
    sign: Array
    normals: Array
    rows: tuple[Array, Array, Array]
    least: Array
    steady: Array

    @staticmethod
    def of(model: Model, share: float, contact: Contact) -> States:
        """The motions at the share that may be used.

        Raises
        ------
        NoSolution
            If some motion must slip even at constant speed, or needs more torque than the motors have.
        """
        motion, kind, run = _in_runs(model, all_motions(model), share, contact)
        first = np.flatnonzero(np.diff(run, prepend=-1))
        _, friction, external = prepare(model, motion, share, contact)
        demands = Demands.of(model, friction, external, motion.velocity, kind)
        limit = torque_limit(model, at_pace(model, motion.velocity, PACE))
        still = demands.most(np.zeros((1, 1, 3)), np.zeros_like(kind), limit)
        need = needed_share(model, motion, contact=contact)
        use = need if model.count == 3 else np.where(need < 1.0, np.clip(still.use[0], need, 1.0), need)
        _refuse_steady(motion, use, share)
        parts = prepare(model, motion.take(first), share, contact)
        whole = np.full((2, motion.count), share)
        torque = None
        if model.drives.stall_torque_N_m is not None:
            torque = torque_rows(model, *parts[1:], motion.velocity[first])
        rows = _acceleration_rows(model, motion, contact, first, parts, torque, limit, whole)
        _refuse_weak(model, motion, contact, rows, share)
        sign = np.sign(motion.velocity[first])
        first_kinds = np.flatnonzero(np.diff(kind[first], prepend=-1))
        return States(
            model=model,
            share=share,
            contact=contact,
            motion=motion,
            first=first,
            run=run,
            kind=kind,
            parts=parts,
            torque=torque,
            demands=demands,
            limit_N_m=limit,
            sign=sign,
            normals=_normals(rows.A @ _shift(model), run)[:, first[first_kinds]],
            rows=_safe_rows(model, rows, sign),
            least=np.stack([need, still.motors[0]]),
            steady=np.stack([still.use[0], still.motors[0]]),
        )

    def rows_of(self, grip: Array, torque: Array) -> tuple[Array, Array, Array]:
        """Rows A (R, 3) a ≤ b (R,) on the origin's acceleration for every motion, and sign(v) (R, 3).

        ``grip`` and ``torque`` (M,) are the shares that may be used in each motion.

        Raises
        ------
        NoSolution
            If some motion needs more torque than the motors have.
        """
        known = self.first, self.parts, self.torque, self.limit_N_m
        rows = _acceleration_rows(self.model, self.motion, self.contact, *known, np.stack([grip, torque]))
        _refuse_weak(self.model, self.motion, self.contact, rows, self.share)
        return _safe_rows(self.model, rows, self.sign)

    def effort(
        self, acceleration: Array, which: Index, *, near: bool = False, creep: Array | None = None
    ) -> Most:
        """What accelerations (E, G, 3) of the origin ask for: :meth:`Demands.most`."""
        at_com = acceleration @ _shift(self.model).T
        return self.demands.most(at_com, which, self.limit_N_m, near=near, creep=creep)


def _in_runs(model: Model, motion: Motion, share: float, contact: Contact) -> tuple[Motion, Index, Index]:
    """The motions in an order in which kinds and runs stand together, and the kind and run (M,) of each."""
    _, friction, external = prepare(model, motion, share, contact)
    sign = np.sign(motion.velocity)
    kind = _in_order(alike(_tables(friction, external, motion.count)))
    run = _in_order(alike(np.column_stack([kind, sign])))
    order = np.lexsort((run, kind))
    return motion.take(order), kind[order], np.cumsum(np.diff(run[order], prepend=-1) != 0) - 1


def _in_order(found: tuple[Index, Index]) -> Index:
    """Kinds (M,) numbered in the order in which they first come."""
    kind, first = found
    return np.asarray(np.argsort(np.argsort(first))[kind])


def _tables(friction: Friction, external: External, count: int) -> Array:
    """All that is asked of the wheels in each of ``count`` states, a row a state."""
    tables: tuple[NDArray[Any], ...] = (
        friction.drive,
        friction.drag_low,
        friction.drag_high,
        friction.possible,
        friction.drive_stiffness,
        external.low,
        external.high,
        external.load_change_N,
    )
    return np.hstack([np.moveaxis(table, -2, 0).reshape(count, -1) for table in tables])


def _acceleration_rows(
    model: Model,
    motion: Motion,
    contact: Contact,
    first: Index,
    parts: tuple[Facets, Friction, External],
    torque: TorqueRows | None,
    limit_N_m: Array,
    shares: Array,
) -> AccelerationRows:
    """The rows of each run, with the least grip and the least torque of any of its motions."""
    return acceleration_rows(
        model,
        motion.take(first),
        share=np.minimum.reduceat(shares[0], first),
        contact=contact,
        torque_N_m=np.minimum.reduceat(shares[1][:, None] * limit_N_m, first, axis=1),
        parts=parts,
        torque=torque,
    )


def _safe_rows(model: Model, rows: AccelerationRows, sign: Array) -> tuple[Array, Array, Array]:
    """Rows on the origin's acceleration, and the signs of the velocities."""
    A = rows.A @ _shift(model)
    return A.reshape(-1, 3), rows.b.ravel(), np.repeat(sign, A.shape[1], axis=0)


def _shift(model: Model) -> Array:
    """(3, 3): the acceleration of the centre of mass of a robot that stands, from that of the origin."""
    return com_acceleration(model.inertia.com_m, np.zeros((3, 3)), np.eye(3)).T


def _refuse_steady(motion: Motion, need: Array, share: float) -> None:
    if np.all(need < share - CLOSE):
        return
    way, worst = _way(motion.velocity[int(np.argmax(need))]), float(np.max(need))
    if np.isinf(worst):
        raise NoSolution(
            "safe accelerations",
            f"in steady motion {way} drag uses the whole grip of a wheel and leaves none to drive",
            "use the grip disc-strip for rollers that spin freely, or lower the transverse friction",
        )
    cure = (
        f"use a margin below {np.floor(100.0 * (1.0 - worst)) / 100.0:g}"
        if worst < 0.99
        else "plan for rollers only, or lower the transverse friction"
    )
    raise NoSolution("safe accelerations", f"steady motion {way} already needs {worst:.3g} of the grip", cure)


def _refuse_weak(
    model: Model, motion: Motion, contact: Contact, rows: AccelerationRows, share: float
) -> None:
    motor = rows.cause == MOTOR
    if not np.any(motor) or np.min(rows.b[:, motor]) > 0.0:
        return
    each = acceleration_rows(model, motion, share=share, contact=contact, pace=PACE)
    at = int(np.argmin(each.b[:, motor].min(axis=1)))
    raise NoSolution(
        "safe accelerations",
        f"steady motion {_way(motion.velocity[at])} at {PACE:g} of the top speed needs all the torque "
        "that the margin leaves of a motor",
        "use stronger motors or a smaller margin",
    )


def _way(velocity: Array) -> str:
    angle = np.rad2deg(np.arctan2(velocity[1], velocity[0])) % 360.0
    return f"along {angle:.0f}°" + (" while turning" if velocity[2] else "")


def _normals(rows: Array, run: Index) -> Array:
    """Normals (E, M, 3) of each motion's rows in accelerations of the origin, and all round."""
    rows = rows[run]
    size = np.sqrt(np.mean(rows**2, axis=(0, 1)))
    round_ = np.broadcast_to((sphere(SPREAD) * size)[:, None], (SPREAD, len(run), 3))
    apart = _farthest_apart(unit(rows.mean(axis=0) / np.where(size > 0.0, size, 1.0)), ALONG_ROWS)
    return np.concatenate([np.swapaxes(rows[:, apart], 0, 1), round_])


def _farthest_apart(directions: Array, most: int) -> Index:
    """Indices of at most so many of the directions (R, 3): each the farthest from those before it."""
    if len(directions) <= most:
        return np.arange(len(directions))
    chosen = [0]
    nearest = directions @ directions[0]
    for _ in range(most - 1):
        chosen.append(int(np.argmin(nearest)))
        nearest = np.maximum(nearest, directions @ directions[chosen[-1]])
    return np.sort(np.array(chosen))
