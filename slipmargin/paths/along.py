"""The limits along a path as rows in (s̈, ṡ²), one set for each interval.

The acceleration is linear in both (a = push · s̈ + bend · ṡ²), so every row of the wrench set in motion
becomes a s̈ + b ṡ² ≤ c (docs/theory.md, section 5).  What depends on the speed itself (drag near rest, losses,
friction that varies) is taken over the speeds of a profile guessed before, as an interval: the rows
are then safe for every speed in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.bias import refuse_lifting
from slipmargin.limits.motion_external import External, external_in_motion
from slipmargin.limits.motion_friction import Friction, friction_in_motion
from slipmargin.limits.motion_rows import Facets, facet_coefficients, facet_rows, torque_rows
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.spin_up import spin_at_constant
from slipmargin.model import Model
from slipmargin.paths.geometry import Geometry

#: Speeds of a guessed profile are taken this much slower and faster too [1].
SLOWER, FASTER = 0.9, 1.1
#: The torque–speed line is touched at no lower ṡ² than this [m²/s²]: at rest its tangent over ṡ² is upright.
SLOWEST_TOUCHED = 1e-4


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Caps:
    """Speeds that must not be exceeded; infinite where nobody asks."""

    speed_m_s: float = np.inf
    yaw_rate_rad_s: float = np.inf
    wheel_rad_s: float = np.inf


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """Rows a s̈ + b ṡ² ≤ c at the start (index 0) and the end (1) of n intervals.

    ``a``, ``b``, ``c`` (2, n, R); ``cap`` (n + 1,) bounds ṡ² at the grid points; ``names`` (R,) say
    what each row is, ``wheels`` (R, N) which wheels it saturates.
    """

    a: Array
    b: Array
    c: Array
    cap: Array
    names: tuple[str, ...]
    wheels: np.ndarray[tuple[int, int], np.dtype[np.bool_]]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Assumed:
    """Friction and external wrenches of every interval, hulled over the speeds it may be passed at."""

    friction: Friction
    external: External


def assume(
    model: Model, geometry: Geometry, motions: list[Motion], *, share: float, contact: Contact
) -> Assumed:
    """Hull of friction and external wrenches over states (n F) of every interval and several guesses."""
    n, f = geometry.s.shape
    frictions = [friction_in_motion(model, m, share=share, contact=contact) for m in motions]
    external = [external_in_motion(model, m) for m in motions]

    def hull(values: Sequence[NDArray[Any]], pick: np.ufunc, axis: int) -> NDArray[Any]:
        shaped = [v.reshape(*v.shape[:axis], n, f, *v.shape[axis + 1 :]) for v in values]
        return np.asarray(pick.reduce([pick.reduce(v, axis=axis + 1) for v in shaped]))

    low, high = np.minimum, np.maximum
    first = frictions[0]
    friction = replace(
        first,
        drive=hull([x.drive for x in frictions], low, 1),
        drag_low=hull([x.drag_low for x in frictions], low, 1),
        drag_high=hull([x.drag_high for x in frictions], high, 1),
        possible=hull([x.possible for x in frictions], np.logical_or, 1),
        transverse=first.transverse[:, ::f],
        slide=first.slide[::f],
        stiffness=first.stiffness[:, ::f],
        drive_stiffness=first.drive_stiffness[::f],
    )
    change = [hull([x.load_change_N for x in external], pick, 1)[k] for k, pick in enumerate((low, high))]
    hulled = replace(
        external[0],
        low=hull([x.low for x in external], low, 1),
        high=hull([x.high for x in external], high, 1),
        load_change_N=np.stack(change),
    )
    refuse_lifting(model, hulled.standing_N(), "loads", hulled)
    return Assumed(friction=friction, external=hulled)


def rows_along(
    model: Model,
    geometry: Geometry,
    assumed: Assumed,
    *,
    share: Array,
    torque_share: Array,
    caps: Caps,
    cap_share: Array,
    load_share: Array,
    guess: Array,
) -> Rows:
    """Rows of every interval.

    Parameters
    ----------
    geometry : Geometry
        Samples whose first and last fraction are 0 and 1.
    share, torque_share, cap_share : (n,)
        Shares of the grip, the motor's torque and the speed caps that may be used.
    load_share : (n, 1)
        Share of its load at constant speed that a wheel may lose.
    guess : (n + 1,)
        ṡ² of a profile: where the torque–speed line is touched (√x ≤ ½ (√x̄ + x/√x̄), a tangent from
        above, so that the row is safe whatever the guess).
    """
    facets = Facets.of(model)
    A, c = facet_rows(model, facets, facet_coefficients(facets, assumed.friction, share), assumed.external)
    ends = (0, -1)
    a = [np.einsum("nkc,nc->nk", A, geometry.push[:, e]) for e in ends]
    b = [np.einsum("nkc,nc->nk", A, geometry.bend[:, e]) for e in ends]
    cs = [c, c]
    names = ["grip"] * len(facets.normals)
    wheels = [facets.drive > 1e-9 * np.max(facets.drive)]
    blocks = [(a, b, cs)]
    if model.loads.follow_acceleration:
        per = model.loads.per_acceleration_kg
        blocks.append(
            (
                [-geometry.push[:, e, :2] @ per.T for e in ends],
                [-geometry.bend[:, e, :2] @ per.T for e in ends],
                [load_share * assumed.external.standing_N()] * 2,
            )
        )
        names += ["tipping"] * model.count
        wheels.append(np.eye(model.count, dtype=bool))
    if model.drives.stall_torque_N_m is not None:
        blocks.append(_motor(model, geometry, assumed, torque_share, guess))
        known = np.isfinite(model.drives.stall_torques(model.count))
        names += ["motor torque"] * (2 * int(known.sum()))
        wheels.append(np.tile(np.eye(model.count, dtype=bool)[known], (2, 1)))
    stacked = [
        np.stack([np.concatenate([blk[part][e] for blk in blocks], axis=1) for e in (0, 1)])
        for part in range(3)
    ]
    return Rows(
        a=stacked[0],
        b=stacked[1],
        c=stacked[2],
        names=tuple(names),
        wheels=np.vstack(wheels),
        cap=speed_cap(model, geometry, caps, cap_share),
    )


def _motor(
    model: Model, geometry: Geometry, assumed: Assumed, torque_share: Array, guess: Array
) -> tuple[list[Array], list[Array], list[Array]]:
    stall, top = model.drives.stall_torques(model.count), model.drives.max_speed_rad_s
    known = np.isfinite(stall)
    standing = np.zeros((geometry.twist.shape[0], 3))  # what grows with ṡ² is added
    torque = torque_rows(model, assumed.friction, assumed.external, standing)
    gained = spin_at_constant(model, geometry.twist)  # per ṡ² (n, F, N)
    spin = model.geometry.wheel_speeds(geometry.twist)  # θ̇ per ṡ (n, F, N)
    a, b, c = [], [], []
    for e, node in ((0, slice(None, -1)), (-1, slice(1, None))):
        left, right, bound = [], [], []
        for k, sign in enumerate((1.0, -1.0)):
            rate = np.maximum(sign * spin[:, e], 0.0)
            slope = np.zeros_like(rate) if top is None else rate / top
            root = np.sqrt(np.maximum(guess[node], SLOWEST_TOUCHED))[:, None]
            limit = stall[known] * torque_share[:, None]
            steep, turning = slope[:, known], np.einsum("nic,nc->ni", torque.A[k], geometry.bend[:, e])
            left.append(np.einsum("nic,nc->ni", torque.A[k], geometry.push[:, e])[:, known])
            right.append((turning + sign * gained[:, e])[:, known] + limit * steep / (2.0 * root))
            bound.append(torque.b[k][:, known] + limit * (1.0 - 0.5 * steep * root))
        a.append(np.concatenate(left, axis=1))
        b.append(np.concatenate(right, axis=1))
        c.append(np.concatenate(bound, axis=1))
    return a, b, c


def speed_ratio(model: Model, geometry: Geometry, caps: Caps) -> Array:
    """ṡ per unit of each cap used up: (n, F) the largest over speed, yaw rate and wheel speeds."""
    wheel = min(caps.wheel_rad_s, model.drives.max_speed_rad_s or np.inf)
    spin = model.geometry.wheel_speeds(geometry.twist)
    speed = np.hypot(geometry.first[..., 0], geometry.first[..., 1]) / caps.speed_m_s
    turning = np.abs(geometry.first[..., 2]) / caps.yaw_rate_rad_s
    return np.asarray(np.maximum(np.maximum(speed, turning), np.max(np.abs(spin), axis=2) / wheel))


def speed_cap(model: Model, geometry: Geometry, caps: Caps, cap_share: Array) -> Array:
    """Largest ṡ² (n + 1,) at the grid points that keeps both neighbouring intervals under every cap."""
    ratio = speed_ratio(model, geometry, caps).max(axis=1) / cap_share
    with np.errstate(divide="ignore"):
        most = 1.0 / ratio**2
    return np.asarray(np.minimum(np.append(most, np.inf), np.insert(most, 0, np.inf)))
