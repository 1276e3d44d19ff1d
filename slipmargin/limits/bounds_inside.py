"""The largest box and the largest ellipsoid of accelerations that are safe whatever the motion.

Tools that take one number an axis need a box.  Which accelerations are admissible depends on the
direction of motion (drag helps to brake and hinders speeding up), so the box has a speeding-up and a
slowing-down side for each axis: component j may lie between −slow_j and +fast_j along sign(v_j).  Both
sets come from convex programs (:mod:`~slipmargin.sets.inscribed`), j over the two axes of translation and
r the yaw acceleration in reserve:

    box         max Σ log fast_j + Σ log slow_j  s.t.  Σ_j (A_j s_j)⁺ fast_j + (A_j s_j)⁻ slow_j ≤ b − |A_α| r
    ellipsoid   max log det E                    s.t.  ‖E A_k‖ ≤ b_k

With four wheels and more the rows only say that some distribution of forces holds.  So the ends of each set
are driven as motions, and the rows drawn in until the realised distribution keeps the share too, of the grip
and of the motors' torque.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, real, rounded_down
from slipmargin.errors import NoSolution
from slipmargin.limits.bounds import spin
from slipmargin.limits.bounds_pace import pace, yaw_rate
from slipmargin.limits.bounds_states import CLOSE, States
from slipmargin.limits.ends import Ends, circle_end, ellipsoid_end, even_corners, sided_corners
from slipmargin.limits.margin import unit
from slipmargin.limits.motion_state import Contact
from slipmargin.model import Model
from slipmargin.sets.alike import alike
from slipmargin.sets.inscribed import largest_box, largest_ellipsoid

#: Share of the spinning limit kept for yaw by default: corrections of the heading while driving straight [1].
YAW_SHARE = 0.1
#: Rounds in which a set is drawn in [1].
ROUNDS = 12
#: After so many rounds in a row a motion's rows are drawn in further each time, and those of its grip and of
#: its motors alike: where others bind, a ratio near one took more rounds than there are to be felt, and
#: torque that creep asks for along one axis is none that the motors' own row, along another, takes back [1].
PATIENCE = 3


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inside:
    """Safe sets of body accelerations (right, forward, yaw) for every direction of motion.

    ``fast`` and ``slow`` (3,): how much each axis may speed up and slow down at once [m/s², m/s², rad/s²];
    ``even`` (3,): the largest box with equal sides, for tools with one number an axis.
    ``circle_m_s2``: the largest acceleration in any direction.  All of them keep ``yaw_rad_s2`` of yaw
    acceleration in reserve, at once with what they say.  ``ellipsoid`` (3, 3): accelerations E u, ‖u‖ ≤ 1,
    which trades yaw against translation and keeps no reserve.
    ``coefficient``: the largest friction coefficient [1] of swerve modules in the wheels' places, each
    pushing any way with up to μ m g / N, all of whose accelerations are safe: the robot that Choreo and
    PathPlanner plan for.

    ``pace``: the share of the motors' top speed up to which all this is there with the same share of the
    torque; None without motors.  ``yaw_rate_rad_s``: the fastest turn on the spot in which the mass, where it
    is off the middle, leaves the reserved yaw acceleration; infinite where nothing limits it but the motors.
    """

    fast: Array
    slow: Array
    even: Array
    ellipsoid: Array
    circle_m_s2: float
    yaw_rad_s2: float
    coefficient: float
    pace: float | None
    yaw_rate_rad_s: float


def inside(
    model: Model,
    *,
    share: float = 1.0,
    contact: Contact = Contact.ROLLERS,
    yaw_rad_s2: float | None = None,
    with_ellipsoid: bool = True,
) -> Inside:
    """The largest safe box, circle and ellipsoid; see the module for the programs.

    Parameters
    ----------
    yaw_rad_s2 : float, optional
        Yaw acceleration that box and circle keep in reserve, by default :data:`YAW_SHARE` of what spinning
        on the spot allows.
    with_ellipsoid : bool
        Without it the ellipsoid is NaN.

    Raises
    ------
    NoSolution
        If no acceleration is safe in every motion, or none beside that yaw acceleration.
    """
    if yaw_rad_s2 is None:
        yaw_rad_s2 = YAW_SHARE * spin(model, share=share, contact=contact).weaker_rad_s2
    yaw = real("yaw", yaw_rad_s2, low=0.0, cure="give a yaw acceleration [rad/s²], 0 for none")

    def circle(A: Array, b: Array, sign: Array) -> tuple[Array, ...]:
        left = b - np.abs(A[:, 2]) * yaw
        if np.min(left) <= 0.0:
            raise _too_much(A, b, yaw)
        return (np.array([np.min(left / np.maximum(np.hypot(A[:, 0], A[:, 1]), 1e-300)), yaw]),)

    def ellipsoid(A: Array, b: Array, sign: Array) -> tuple[Array, ...]:
        A, b = _tightest(A, b)
        scale = _sizes(A, b)
        return (scale[:, None] * largest_ellipsoid(A * scale / b[:, None]),)

    modules = _modules(model)

    def swerve(A: Array, b: Array, sign: Array) -> tuple[Array, ...]:
        pushed = A @ side_by_side
        reach = np.sqrt(pushed[:, ::2] ** 2 + pushed[:, 1::2] ** 2).sum(axis=1)
        return (np.array([np.min(b / reach)]),)

    side_by_side = np.ascontiguousarray(np.swapaxes(modules, 0, 1)).reshape(3, -1)  # each module's two pushes

    def swerve_end(coefficient: Array, normal: Array) -> Array:
        push = unit((normal @ side_by_side).reshape(*normal.shape[:2], -1, 2))
        return np.asarray(coefficient[0] * (push.reshape(*normal.shape[:2], -1) @ side_by_side.T))

    asked: list[Array] = []
    states = States.of(model, share, contact)

    def safe(largest: Callable[..., tuple[Array, ...]], ends: Ends, counts: bool = True) -> tuple[Array, ...]:
        found, torque = _safe(states, largest, ends)
        if counts:
            asked.append(torque)
        return found

    sided = safe(lambda A, b, sign: _sided(A, b, sign, yaw), Ends(corners=sided_corners))
    even = safe(lambda A, b, sign: _even(A, b, sign, yaw), Ends(corners=even_corners))
    ball = safe(circle, Ends(farthest=circle_end))
    grip = safe(swerve, Ends(farthest=swerve_end))
    round_ = np.full((3, 3), np.nan)
    if with_ellipsoid:
        with suppress(NoSolution):  # nothing else follows from it: its failure must not cost the box
            round_ = safe(ellipsoid, Ends(farthest=ellipsoid_end), counts=False)[0]
    return Inside(
        fast=sided[0],
        slow=sided[1],
        even=even[0],
        ellipsoid=round_,
        circle_m_s2=float(ball[0][0]),
        yaw_rad_s2=yaw,
        coefficient=float(grip[0][0]),
        pace=pace(model, states.motion.velocity, np.max(asked, axis=0), share),
        yaw_rate_rad_s=yaw_rate(model, yaw, share, contact),
    )


def _safe(
    states: States, largest: Callable[..., tuple[Array, ...]], ends: Ends
) -> tuple[tuple[Array, ...], Array]:
    """The largest set whose every end, driven as a motion, keeps each wheel's realised share and torque.

    Each motion's rows are drawn in by the ratio in which an end of the set exceeds the share in it, counted
    from what constant speed uses already.  Where that ends nowhere, as creep asks for grip along an axis that
    the rows of its motion leave open, the rows of all motions are drawn in together, and the set keeps its
    shape.  Also the greatest torques (2, M, N) of the ends.
    """
    for together in (False, True):
        found = _drawn_in(states, largest, ends, together)
        if found is not None:
            return found
    raise NoSolution(
        "safe accelerations",
        "no set was found in which the creep of the wheels keeps the margin",
        "use a larger margin or a smaller yaw reserve",
    )


def _drawn_in(
    states: States, largest: Callable[..., tuple[Array, ...]], ends: Ends, together: bool
) -> tuple[tuple[Array, ...], Array] | None:
    """:func:`_safe`, rows drawn in for each motion or for all ``together``; None where that ends nowhere."""
    model, share, least, steady = states.model, states.share, states.least, states.steady
    part, aim, rows = np.full(steady.shape, share), share - 0.5 * CLOSE, states.rows
    again, creep = np.zeros(steady.shape), ends.unknown(states)
    for _ in range(ROUNDS):
        found = largest(*rows)
        seen = ends.driven(found, states, creep)
        used = np.concatenate([seen.use, seen.motors])
        if share == 1.0 or model.count == 3:  # the rows are exact for the grip
            used[0] = 0.0
        if np.max(used) <= share + CLOSE:
            return found, seen.torque_N_m
        over = used > share
        drawn = np.where(over, (aim - steady) / np.where(over, used - steady, 1.0), 1.0)
        again = np.where(over, again + 1.0, 0.0)
        late = np.max(again, axis=0) > PATIENCE
        drawn, again = np.where(late, drawn.min(axis=0), drawn), np.where(late, again.max(axis=0), again)
        if together:
            drawn, again = np.full_like(drawn, drawn.min()), np.full_like(again, again.max())
        part = least + (part - least) * np.clip(drawn ** np.maximum(1.0, again - PATIENCE), 0.1, 1.0)
        rows = states.rows_of(*part)
    return None


def _modules(model: Model) -> Array:
    """(N, 3, 2) accelerations of the origin by a module's force in each wheel's place, per coefficient."""
    body = model.inertia
    arm = model.geometry.position_m - body.com_m
    load = body.weight_N / model.count
    spinning = np.stack([-arm[:, 1], arm[:, 0]], axis=1) / body.inertia_kg_m2
    moving = np.broadcast_to(np.eye(2) / body.mass_kg, (model.count, 2, 2))
    # a = a_com − α ẑ × c
    moving = moving + np.array([body.com_m[1], -body.com_m[0]])[:, None] * spinning[:, None]
    return np.asarray(load * np.concatenate([moving, spinning[:, None]], axis=1))


def _sizes(A: Array, b: Array) -> Array:
    """How far each axis alone goes, so that programs see numbers of one size."""
    least = 1e-12 * np.max(np.abs(A))
    return np.asarray(np.min(b[:, None] / np.maximum(np.abs(A), least), axis=0))


def _too_much(A: Array, b: Array, yaw: float) -> NoSolution:
    most = rounded_down(float(np.min(b / np.maximum(np.abs(A[:, 2]), 1e-300))))
    return NoSolution(
        "safe accelerations",
        f"a yaw acceleration of {yaw:.4g} rad/s² leaves no grip to translate in some motion",
        f"reserve less than {most:g} rad/s² (--yaw)",
    )


def _sided(A: Array, b: Array, sign: Array, yaw: float) -> tuple[Array, ...]:
    """Sides (3,) of the largest box, speeding up and slowing down."""
    flat, scale = _flat(A, b, yaw)
    # Where v_j = 0 either side may come: the row must hold for both.
    with_v, against = np.zeros_like(flat), np.zeros_like(flat)
    still = sign[:, :2] == 0.0
    along = flat * sign[:, :2]
    with_v[~still], against[~still] = np.maximum(along, 0.0)[~still], np.maximum(-along, 0.0)[~still]
    with_v[still] = np.abs(flat)[still]  # from rest an axis can only speed up
    pair = largest_box(np.hstack([with_v, against]))
    return np.append(pair[:2] * scale, yaw), np.append(pair[2:] * scale, yaw)


def _even(A: Array, b: Array, sign: Array, yaw: float) -> tuple[Array, ...]:
    """Sides (3,) of the largest box with equal ones."""
    flat, scale = _flat(A, b, yaw)
    return (np.append(largest_box(np.abs(flat)) * scale, yaw),)


def _flat(A: Array, b: Array, yaw: float) -> tuple[Array, Array]:
    """Rows (R, 2) a ≤ 1 on what is left beside a yaw acceleration, in units of the sizes (2,) given too."""
    left = b - np.abs(A[:, 2]) * yaw
    if np.min(left) <= 0.0:
        raise _too_much(A, b, yaw)
    scale = _sizes(A[:, :2], left)
    return A[:, :2] * scale / left[:, None], scale


def _tightest(A: Array, b: Array) -> tuple[Array, Array]:
    """One row for each normal: the least b."""
    kind, first = alike(np.round(A / np.max(np.abs(A)), 10))
    last_is_least = np.argsort(b, kind="stable")[::-1]  # of equal ones the first
    first[kind[last_is_least]] = last_is_least
    return A[first], b[first]
