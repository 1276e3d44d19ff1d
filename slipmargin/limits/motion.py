"""How hard the robot can accelerate while it moves, and how much of its grip that uses.

The static pull limit divided by the mass is not an acceleration limit: in motion the rollers turn and
their friction is drag (docs/theory.md, section 4).  Directions and velocities are in the body frame.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.effort import coasting_use, efforts, greatest_torque
from slipmargin.limits.motion_external import External, least_product
from slipmargin.limits.motion_friction import Friction, Mask, material_states
from slipmargin.limits.motion_rows import (
    CAUSES,
    GRIP,
    MOTOR,
    SPENT,
    TIPS,
    AccelerationRows,
    Facets,
    acceleration_rows,
    prepare,
)
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.ray_ends import SAME, ray_ends
from slipmargin.limits.realised_limit import decided_by_creep, realised_limit, wheels_of
from slipmargin.limits.realised_newton import TIED
from slipmargin.model import Model
from slipmargin.physics.kinematics import com_acceleration

#: Rounds at most in which the acceleration is found whose torques the motors have, and how close to the
#: torque that may be used it is [1].
TORQUE_ROUNDS, TORQUE_CLOSE = 40, 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AccelerationLimit:
    """Limits of M states: ``value`` (M,) multiples of each direction, and the binding row of each.

    Negative: even without acceleration the robot slips.  ``row`` (M,) of ``rows`` is what binds, at the
    acceleration ``end`` (M, 3) of the centre of mass (NaN where ``value`` is infinite).  Where the
    drag uses up a coupled grip (an ellipse whose wheel slides sideways at full slip) and no multiple is
    admissible, the value is what drag alone does: the component of coasting along the direction.  ``coasts``
    (M,) says where; rollers at an angle, which turning wheels drag along, may push ahead: it is then above 0.
    """

    value: Array
    end: Array
    row: NDArray[np.int64]
    rows: AccelerationRows
    names: tuple[str, ...]
    coasts: NDArray[np.bool_]

    @property
    def cause(self) -> tuple[str, ...]:
        """What limits each state: grip, tips, motor torque, or a drag that uses the whole grip."""
        return tuple(
            SPENT if spent else CAUSES[self.rows.cause[k]]
            for k, spent in zip(self.row, self._spent, strict=True)
        )

    @property
    def wheels(self) -> tuple[tuple[str, ...], ...]:
        """The wheels that limit each state: those of every row of one cause that binds there.

        Symmetric robots leave several facets at once; which of them ends the ray is chance.
        """
        rows = self.rows
        count = rows.A.shape[1]
        room = rows.b - np.einsum("mrc,mc->mr", rows.A, self.end)
        binds = room <= SAME * np.max(np.abs(rows.b), axis=1, keepdims=True)
        binds &= rows.cause[:count] == rows.cause[self.row, None]
        limiting = np.where(
            self._spent[:, None], rows.spent, rows.wheels[self.row] | (binds @ rows.wheels[:count])
        )
        return tuple(self._named(wheels) for wheels in limiting)

    @property
    def _spent(self) -> NDArray[np.bool_]:
        return np.asarray(np.any(self.rows.spent, axis=1) & (self.coasts | (self.value <= 0.0)))

    def _named(self, wheels: NDArray[np.bool_]) -> tuple[str, ...]:
        return tuple(name for name, on in zip(self.names, wheels, strict=True) if on)


def acceleration_limit(
    model: Model,
    motion: Motion,
    direction: Array,
    *,
    share: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    motor: bool = True,
) -> AccelerationLimit:
    """Largest t for which the acceleration t · direction is admissible.

    Parameters
    ----------
    motion : Motion
        M states (their accelerations are not used).
    direction : array (M, 3)
        Body-frame acceleration of the origin and yaw acceleration per unit of t.
    share : float
        λ, the share of the drive grip that may be used.
        The same share of each motor's torque may be used, and of the acceleration that lifts a wheel.
    motor : bool
        Whether the torque–speed line of the motor counts.

    Returns
    -------
    AccelerationLimit
        In [m/s²] for unit directions in the plane, [rad/s²] for (0, 0, 1).
    """
    rows = acceleration_rows(model, motion, share=share, contact=contact, motor=motor)
    direction = np.broadcast_to(np.asarray(direction, dtype=float), (motion.count, 3))
    com, still = model.inertia.com_m, np.zeros((motion.count, 3))
    start = com_acceleration(com, motion.velocity, still)
    return along(model, rows, start, com_acceleration(com, still, direction))


def along(model: Model, rows: AccelerationRows, start: Array, direction: Array) -> AccelerationLimit:
    """Largest t with which start + t direction (M, 3) is admissible, about the centre of mass.

    Negative where ``start`` itself is not admissible for want of grip along the direction; −∞ where no t is,
    or what coasting does where a drag leaves no grip to drive.
    """
    return along_each(model, rows, start[None], direction[None])[0]


def along_each(
    model: Model, rows: AccelerationRows, start: Array, direction: Array
) -> list[AccelerationLimit]:
    """:func:`along` for R rays (R, M, 3) at every state.

    With four wheels and more and a share below 1 the wheels' forces are those that their common creep gives
    (:mod:`~slipmargin.limits.realised_limit`): what binds is then a single wheel.
    """
    shape = start.shape[:2]
    low, value, best = np.empty(shape), np.empty(shape), np.empty(shape, dtype=np.int64)
    rays = np.ascontiguousarray(start), np.ascontiguousarray(direction)
    ray_ends(rows.A, rows.b, rows.cause == TIPS, *rays, low, value, best)
    if isinstance(rows.share, float) and decided_by_creep(model, rows.share):
        found, limiting = realised_limit(
            model, rows.friction, rows.external, start, direction, low, value, share=rows.share
        )
        rows = _with_wheels(rows, GRIP, wheels_of(limiting, model.count), limiting > 0, best)
        value = found
    if rows.torque_N_m is not None and model.count > 3:
        value, rows = _within_torque(model, rows, start, direction, low, value, best)
    coasts = np.isposinf(low) & np.any(rows.spent, axis=1)
    end = start + np.where(np.isfinite(value), value, np.nan)[..., None] * direction
    return [
        AccelerationLimit(
            value=_coasted(rows, s, d, v, c), end=e, row=b, rows=rows, names=model.geometry.names, coasts=c
        )
        for s, d, v, e, b, c in zip(start, direction, value, end, best, coasts, strict=True)
    ]


def _with_wheels(
    rows: AccelerationRows, cause: int, wheels: Mask, where: Mask, best: NDArray[np.int64]
) -> AccelerationRows:
    """``rows`` with one more for each set of ``wheels`` (R, M, N), to which ``best`` is set in place."""
    if not np.any(where):
        return rows
    sets, which = np.unique(wheels[where], axis=0, return_inverse=True)
    best[where] = len(rows.cause) + which.ravel()
    return replace(
        rows,
        wheels=np.concatenate([rows.wheels, sets]),
        cause=np.concatenate([rows.cause, np.full(len(sets), cause)]),
    )


def _within_torque(
    model: Model,
    rows: AccelerationRows,
    start: Array,
    direction: Array,
    low: Array,
    value: Array,
    best: NDArray[np.int64],
) -> tuple[Array, AccelerationRows]:
    """``value`` (R, M) lowered until the torques of the realised distribution are there; ``best`` in place.

    The rows of motors take the even distribution, which is a first estimate.
    """
    limit = rows.torque_N_m
    assert limit is not None
    none = ~np.isfinite(value)
    at = start + np.where(none, 0.0, value)[..., None] * direction
    if np.all(greatest_torque(model, rows.friction, rows.external, rows.velocity, at) <= limit.min(axis=0)):
        return value, rows

    def asked(t: Array) -> Array:
        at = start + np.where(none, 0.0, t)[..., None] * direction
        return efforts(model, rows.friction, rows.external, rows.velocity, at).of_motors(limit)

    too_much = asked(value) - 1.0
    over = ~none & (too_much > TORQUE_CLOSE)
    if not np.any(over):
        return value, rows
    least = np.where(np.isfinite(low), np.maximum(low, np.minimum(0.0, value)), np.minimum(0.0, value))
    at_least = asked(least) - 1.0
    fits = at_least <= 0.0
    below = _where_it_turns(lambda t: asked(t) - 1.0, least, at_least, value, too_much, over & fits)
    at = start + np.where(none, 0.0, below)[..., None] * direction
    torque = efforts(model, rows.friction, rows.external, rows.velocity, at).torque_N_m
    used = (torque / np.maximum(limit[:, None], 1e-300)).max(axis=0)
    wheels = used >= (1.0 - TIED) * np.max(used, axis=2, keepdims=True)
    found = np.where(fits, below, -np.inf)
    return np.where(over, found, value), _with_wheels(rows, MOTOR, wheels, over, best)


def _where_it_turns(
    excess: Callable[[Array], Array], low: Array, at_low: Array, high: Array, at_high: Array, sought: Mask
) -> Array:
    """Where a growing function is zero, from below, between ``low`` and ``high`` where ``sought``.

    The Illinois method (M. Dowell, P. Jarratt, BIT 11, 1971): the chord's zero, with the weight of an end
    that stays halved; where the function is infinite at the upper end, the middle.
    """
    unsought = low
    low, high, at_low, at_high = (np.where(sought, end, 0.0) for end in (low, high, at_low, at_high))
    stayed = np.zeros(low.shape)  # which end stayed last: −1 the lower, 1 the upper
    left = at_low.copy()
    for _ in range(TORQUE_ROUNDS):
        open_ = sought & (left < -TORQUE_CLOSE) & (high - low > 1e-15 * np.abs(high))
        if not np.any(open_):
            break
        with np.errstate(invalid="ignore", divide="ignore"):
            part = at_low / (at_low - at_high)
        part = np.where(np.isfinite(at_high) & (part > 0.0) & (part < 1.0), part, 0.5)
        middle = np.where(open_, low + part * (high - low), low)
        found = excess(middle)
        holds = open_ & (found <= 0.0)
        fails = open_ & ~holds
        at_high[holds & (stayed == 1.0)] *= 0.5
        at_low[fails & (stayed == -1.0)] *= 0.5
        low, high = np.where(holds, middle, low), np.where(fails, middle, high)
        at_low, at_high = np.where(holds, found, at_low), np.where(fails, found, at_high)
        left = np.where(holds, found, left)
        stayed = np.where(holds, 1.0, np.where(fails, -1.0, stayed))
    return np.where(sought, low, unsought)


def _coasted(
    rows: AccelerationRows, start: Array, direction: Array, value: Array, coasts: NDArray[np.bool_]
) -> Array:
    """``value``, or what drag alone does where no multiple is admissible as drag leaves no grip to drive."""
    if not coasts.any():
        return value
    away = np.einsum("mc,mc->m", rows.coasting - start, direction)
    away[np.abs(away) < 1e-12 * np.sum(np.abs(rows.coasting), axis=1)] = 0.0
    return np.where(coasts, away / np.einsum("mc,mc->m", direction, direction), value)


def needed_share(model: Model, motion: Motion, *, contact: Contact = Contact.ROLLERS) -> Array:
    """Smallest share λ (M,) of the drive grip with which some distribution does what ``motion`` asks.

    Above 1 the wheels must slip; infinite where drag leaves no grip to drive.  For
    three wheels it is the largest wheel's share; for more, the wheels choose the distribution and the
    largest share may be higher (:func:`slipmargin.limits.motion_realised.realised`).
    """
    return _needed(model, *prepare(model, motion, 1.0, contact), _acceleration(model, motion))


def _needed(model: Model, facets: Facets, friction: Friction, external: External, a: Array) -> Array:
    need = np.full(len(a), -np.inf)
    middle = 0.5 * (friction.drag_low + friction.drag_high)
    half = 0.5 * (friction.drag_high - friction.drag_low)
    for pick in material_states(friction.possible):
        grip, drag, spread = (np.where(pick, x[1], x[0]) for x in (friction.drive, middle, half))
        for low, high, load in external.cases(a):
            top = (a * model.inertia.diagonal) @ facets.normals.T - least_product(facets.normals, low, high)
            top = top + (drag * load) @ facets.across.T + (spread * load) @ np.abs(facets.across).T
            need = np.maximum(need, np.max(_ratio(top, (grip * load) @ facets.drive.T), axis=1))
    return need


def steady_share(model: Model, motion: Motion, *, contact: Contact = Contact.ROLLERS) -> Array:
    """Share (M,) of the grip that the most loaded wheel uses at constant speed, at full drag.

    With four wheels and more that of the realised distribution, which uses more than the best one.  Above 1
    no distribution holds constant speed; infinite where drag leaves no grip to drive.
    """
    return steady_share_of(model, motion, *prepare(model, motion, 1.0, contact))


def steady_share_of(
    model: Model, motion: Motion, facets: Facets, friction: Friction, external: External
) -> Array:
    """:func:`steady_share` of states whose facets, friction and external wrenches are prepared."""
    need = _needed(model, facets, friction, external, _acceleration(model, motion))
    if model.count == 3:
        return need
    use = coasting_use(model, friction, external, motion.count)
    return np.where(need < 1.0, np.clip(use, need, 1.0), need)


def _ratio(asked: Array, held: Array) -> Array:
    """asked / held; where nothing is held: infinite, or −∞ where nothing is asked."""
    tiny = 1e-12 * np.max(np.abs(asked), axis=1, keepdims=True)
    out = np.where(asked > tiny, np.inf, -np.inf)
    np.divide(asked, held, out=out, where=held > tiny)
    return out


def _acceleration(model: Model, motion: Motion) -> Array:
    asked = np.zeros((motion.count, 3)) if motion.acceleration is None else motion.acceleration
    return com_acceleration(model.inertia.com_m, motion.velocity, asked)
