"""What accelerations at full drag ask of wheels and motors: realised shares of the grip, and torques."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.creep import Balance, continued_share
from slipmargin.limits.motion_external import External
from slipmargin.limits.motion_friction import Friction, material_states
from slipmargin.limits.motion_realised import LIGHTEST
from slipmargin.limits.motion_rows import BLOCK
from slipmargin.model import Model

#: Share of its grip that no wheel exceeds; above 1 because the friction law is continued there [1].
WHOLE = 1.1


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Most:
    """The most that accelerations of M states ask of any wheel: shares of its grip and of its motor's torque.

    ``use`` and ``motors`` (R, M) at each acceleration; ``torque_N_m`` (2, M, N) over all of them.
    """

    use: Array
    motors: Array
    torque_N_m: Array

    def and_(self, other: Most) -> Most:
        """These accelerations and more of the same M states."""
        return Most(
            use=np.concatenate([self.use, other.use]),
            motors=np.concatenate([self.motors, other.motors]),
            torque_N_m=np.maximum(self.torque_N_m, other.torque_N_m),
        )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Effort:
    """Largest realised share ``use`` (R, M) of any wheel's grip, and its torques.

    ``torque_N_m`` (2, R, M, N): the greatest motor torque T = −ρ F·ŝ of each wheel and the greatest −T.
    """

    use: Array
    torque_N_m: Array

    def of_motors(self, limit_N_m: Array) -> Array:
        """Largest share (R, M) of a motor's torque, where motors give ``limit_N_m`` (2, M, N)."""
        limit = limit_N_m[:, None]
        share = np.full(self.torque_N_m.shape, np.inf)
        np.divide(self.torque_N_m, limit, out=share, where=limit > 0.0)
        return np.asarray(np.where(self.torque_N_m > 0.0, share, 0.0).max(axis=(0, 3)))


def most_asked(
    model: Model, friction: Friction, external: External, acceleration: Array, limit_N_m: Array
) -> Most:
    """What accelerations (R, M, 3) ask for at most, where motors give ``limit_N_m`` (2, M, N).

    In blocks: the torques of every wheel at every acceleration of 24 wheels would take half a gigabyte.
    """
    rows = max(1, BLOCK // (acceleration.shape[1] * model.count))
    found: Most | None = None
    for first in range(0, len(acceleration), rows):
        each = efforts(model, friction, external, acceleration[first : first + rows])
        block = Most(use=each.use, motors=each.of_motors(limit_N_m), torque_N_m=each.torque_N_m.max(axis=1))
        found = block if found is None else found.and_(block)
    assert found is not None
    return found


def greatest_torque(model: Model, friction: Friction, external: External, acceleration: Array) -> Array:
    """Torques (R, M, N) [N m] no motor exceeds at accelerations (R, M, 3), with each wheel's whole grip."""
    c = model.geometry
    on_drive, on_side = (np.abs(c.radius_m * np.sum(c.drive * axis, axis=1)) for axis in (c.grip, c.free))
    drag = np.maximum(np.abs(friction.drag_low), np.abs(friction.drag_high))
    each = on_drive * WHOLE * friction.drive + on_side * drag
    worst = np.where(friction.possible, each, 0.0).max(axis=0)
    load = np.max([load for *_, load in external.cases()], axis=0)
    moved = acceleration[..., :2] @ model.loads.per_acceleration_kg.T
    lightest = LIGHTEST * model.inertia.weight_N / model.count
    return np.asarray(worst * np.maximum(load + moved, lightest))


def efforts(model: Model, friction: Friction, external: External, acceleration: Array) -> Effort:
    """What accelerations (R, M, 3) of the centre of mass and in yaw ask for in each of M states.

    The worst over the materials that the wheels may stand on and over external wrenches that are not known.
    """
    c, moved = model.geometry, (*acceleration.shape[:2], model.count)
    on_drive, on_side = (-c.radius_m * np.sum(c.drive * axis, axis=1) for axis in (c.grip, c.free))
    use, torque = np.zeros(moved[:2]), np.zeros((2, *moved))
    for balance, side in _balances(model, friction, external, acceleration):
        twist, share = balance.rest()
        np.maximum(use, share.max(axis=1).reshape(use.shape), out=use)
        drive = -balance.grip * continued_share(balance.law, balance.steep * (twist @ balance.along))
        each = on_drive * drive.reshape(moved) + on_side * side
        np.maximum(torque, np.stack([each, -each]), out=torque)
    return Effort(use=use, torque_N_m=torque)


def coasting_use(model: Model, friction: Friction, external: External, count: int) -> Array:
    """Largest realised share (M,) of any wheel's grip at constant speed in each of ``count`` states M."""
    at_rest = np.zeros((1, count, 3))
    each = [b.rest()[1].max(axis=1) for b, _ in _balances(model, friction, external, at_rest)]
    return np.asarray(np.max(each, axis=0) if len(each) > 1 else each[0])


def _balances(
    model: Model, friction: Friction, external: External, acceleration: Array
) -> Iterator[tuple[Balance, Array]]:
    """The R·M balances of forces for each combination that may be met, and the drag (R, M, N) in it [N]."""
    along, across = (np.ascontiguousarray(b) for b in model.wrench_maps())
    lever = float(np.max(np.abs(along[2]))) or 1.0
    scale = model.inertia.weight_N * float(np.max(model.grip.roller[:, 0])) * np.array([1.0, 1.0, lever])
    lightest = LIGHTEST * model.inertia.weight_N / model.count
    moved = acceleration[..., :2] @ model.loads.per_acceleration_kg.T
    steep = np.broadcast_to(friction.drive_stiffness, moved.shape).reshape(-1, model.count)
    middle = 0.5 * (friction.drag_low + friction.drag_high)
    none = np.zeros_like(steep)
    for pick in material_states(friction.possible):
        mu = np.where(pick, friction.drive[1], friction.drive[0])
        drag = np.where(pick, middle[1], middle[0])
        for wrench, load in external.corners():
            side = -drag * (load + moved)
            yield (
                Balance(
                    law=model.grip.law,
                    along=along,
                    across=along,
                    grip=(mu * np.maximum(load + moved, lightest)).reshape(steep.shape),
                    drag=none,
                    steep=steep,
                    steep_across=steep,
                    slide=none,
                    need=(acceleration * model.inertia.diagonal - wrench - side @ across.T).reshape(-1, 3),
                    carried=np.zeros((len(steep), 4)),
                    scale=scale,
                ),
                side,
            )
