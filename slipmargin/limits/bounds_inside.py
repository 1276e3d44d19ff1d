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

from slipmargin.checks import Array, Index, real
from slipmargin.errors import NoSolution
from slipmargin.limits.bounds import spin
from slipmargin.limits.bounds_pace import pace, yaw_rate
from slipmargin.limits.effort import Demands, Most
from slipmargin.limits.ends import Ends, circle_end, ellipsoid_end, even_corners, sided_corners, unit
from slipmargin.limits.every_motion import all_motions
from slipmargin.limits.margin import sphere
from slipmargin.limits.motion import needed_share, steady_share
from slipmargin.limits.motion_rows import MOTOR, acceleration_rows, at_pace, prepare, torque_limit
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.physics.kinematics import com_acceleration
from slipmargin.sets.alike import alike
from slipmargin.sets.inscribed import largest_box, largest_ellipsoid

#: Share of the spinning limit kept for yaw by default: corrections of the heading while driving straight [1].
YAW_SHARE = 0.1
#: Share of the motors' top speed up to which the sets hold at least: there a motor's power is greatest [1].
PACE = 0.5
#: Rounds in which a set is drawn in, and how close to the share it ends [1].
ROUNDS, CLOSE = 12, 1e-3
#: After so many rounds in a row a motion's rows are drawn in further each time: where others bind, a ratio
#: near one took more rounds than there are to be felt [1].
PATIENCE = 3
#: Ends of a round set that are tried all round, and at most along rows' normals: of more than eight wheels
#: the normals that lie farthest apart; what is between, the way uphill finds.
SPREAD, ALONG_ROWS = 48, 64


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


def safe_rows(
    model: Model,
    *,
    share: Array | float = 1.0,
    contact: Contact = Contact.ROLLERS,
    torque_share: Array | float | None = None,
) -> tuple[Array, Array, Array]:
    """Rows A (R, 3) a ≤ b (R,) on the origin's acceleration for every motion, and sign(v) (R, 3).

    ``share`` and ``torque_share`` (by default the same) are one number or one for each of the motions.

    Raises
    ------
    NoSolution
        If some motion must slip even at constant speed, or needs more torque than the motors have.
    """
    motion = all_motions(model)
    if isinstance(share, float):
        _refuse_steady(model, motion, share, contact)
    rows = acceleration_rows(
        model, motion, share=share, contact=contact, torque_share=torque_share, pace=PACE
    )
    motor = rows.cause == MOTOR
    if np.any(motor) and np.min(rows.b[:, motor]) <= 0.0:
        at = int(np.argmin(rows.b[:, motor].min(axis=1)))
        raise NoSolution(
            "safe accelerations",
            f"steady motion {_way(motion.velocity[at])} at {PACE:g} of the top speed needs all the torque "
            "that the margin leaves of a motor",
            "use stronger motors or a smaller margin",
        )
    shift = com_acceleration(model.inertia.com_m, np.zeros((3, 3)), np.eye(3)).T
    A, b = rows.A @ shift, rows.b
    sign = np.broadcast_to(np.sign(motion.velocity)[:, None], A.shape)
    return _tightest(A.reshape(-1, 3), b.ravel(), sign.reshape(-1, 3))


def _refuse_steady(model: Model, motion: Motion, share: float, contact: Contact) -> None:
    need = steady_share(model, motion, contact=contact)
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


def _way(velocity: Array) -> str:
    angle = np.rad2deg(np.arctan2(velocity[1], velocity[0])) % 360.0
    return f"along {angle:.0f}°" + (" while turning" if velocity[2] else "")


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
            raise _too_much(yaw)
        return (np.array([np.min(left / np.maximum(np.hypot(A[:, 0], A[:, 1]), 1e-300)), yaw]),)

    def ellipsoid(A: Array, b: Array, sign: Array) -> tuple[Array, ...]:
        scale = _sizes(A, b)
        return (scale[:, None] * largest_ellipsoid(_once(A * scale / b[:, None])),)

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
    states = _States.of(model, share, contact)

    def safe(largest: Callable[..., tuple[Array, ...]], ends: Ends, counts: bool = True) -> tuple[Array, ...]:
        found, torque = _safe(states, largest, ends)
        if counts:
            asked.append(torque)
        return found

    sided = safe(lambda A, b, sign: _boxes(A, b, sign, yaw)[:2], Ends(corners=sided_corners))
    even = safe(lambda A, b, sign: _boxes(A, b, sign, yaw)[2:], Ends(corners=even_corners))
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
        pace=pace(model, np.max(asked, axis=0), share),
        yaw_rate_rad_s=yaw_rate(model, yaw, share, contact),
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _States:
    """What all the sets ask of the M motions; ``rows`` are the safe rows of the whole share.

    ``least`` and ``steady`` (2, M): the shares of grip and torque that constant speed needs and really uses.
    """

    model: Model
    share: float
    contact: Contact
    sign: Array
    normals: Array
    rows: tuple[Array, Array, Array]
    effort: Callable[[Array], Most]
    least: Array
    steady: Array

    @staticmethod
    def of(model: Model, share: float, contact: Contact) -> _States:
        motion = all_motions(model)
        friction, external = prepare(model, motion, share, contact)[1:]
        limit = np.full((2, motion.count, model.count), np.inf)
        if model.drives.stall_torque_N_m is not None:
            limit = torque_limit(model, at_pace(model, motion.velocity, PACE))

        demands = Demands.of(model, friction, external)

        def effort(at: Array) -> Most:
            flat = at.reshape(-1, 3)
            at_com = com_acceleration(model.inertia.com_m, np.zeros_like(flat), flat).reshape(at.shape)
            return demands.most(at_com, limit)

        still, normals = effort(np.zeros((1, motion.count, 3))), _normals(model, motion, share, contact)
        least = np.stack([needed_share(model, motion, contact=contact), still.motors[0]])
        return _States(
            model=model,
            share=share,
            contact=contact,
            sign=np.sign(motion.velocity),
            normals=normals,
            rows=safe_rows(model, share=share, contact=contact),
            effort=effort,
            least=least,
            steady=np.stack([still.use[0], least[1]]),
        )


def _safe(
    states: _States, largest: Callable[..., tuple[Array, ...]], ends: Ends
) -> tuple[tuple[Array, ...], Array]:
    """The largest set whose every end, driven as a motion, keeps each wheel's realised share and torque.

    Each motion's rows are drawn in by the ratio in which an end of the set exceeds the share in it, counted
    from what constant speed uses already.  Also the greatest torques (2, M, N) of the ends.
    """
    model, share, least, steady = states.model, states.share, states.least, states.steady
    motors = model.drives.stall_torque_N_m is not None
    part, aim, rows = np.full(steady.shape, share), share - 0.5 * CLOSE, states.rows
    again = np.zeros(steady.shape)
    for _ in range(ROUNDS):
        found = largest(*rows)
        seen = ends.driven(found, states.sign, states.normals, states.effort, motors)
        used = np.stack([seen.use.max(axis=0), seen.motors.max(axis=0)])
        if share == 1.0 or model.count == 3:  # the rows are exact for the grip
            used[0] = 0.0
        if np.max(used) <= share + CLOSE:
            return found, seen.torque_N_m
        over = used > share
        drawn = np.where(over, (aim - steady) / np.where(over, used - steady, 1.0), 1.0)
        again = np.where(over, again + 1.0, 0.0)
        part = least + (part - least) * np.clip(drawn ** np.maximum(1.0, again - PATIENCE), 0.1, 1.0)
        grip = share if np.all(part == share) else part[0]
        rows = safe_rows(model, share=grip, torque_share=part[1], contact=states.contact)
    raise NoSolution(
        "safe accelerations",
        "no set was found in which the creep of the wheels keeps the margin",
        "use a larger margin or a smaller yaw reserve",
    )


def _normals(model: Model, motion: Motion, share: float, contact: Contact) -> Array:
    """Normals (R, M, 3) of each motion's rows in accelerations of the origin, and all round."""
    shift = com_acceleration(model.inertia.com_m, np.zeros((3, 3)), np.eye(3)).T
    rows = acceleration_rows(model, motion, share=share, contact=contact, pace=PACE).A @ shift
    size = np.sqrt(np.mean(rows**2, axis=(0, 1)))
    round_ = np.broadcast_to((sphere(SPREAD) * size)[:, None], (SPREAD, motion.count, 3))
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


def _too_much(yaw: float) -> NoSolution:
    return NoSolution(
        "safe accelerations",
        f"a yaw acceleration of {yaw:.4g} rad/s² leaves no grip to translate in some motion",
        "reserve less for yaw",
    )


def _boxes(A: Array, b: Array, sign: Array, yaw: float) -> tuple[Array, Array, Array]:
    """Sides (3,) of the largest box, speeding up and slowing down, and of the largest even one."""
    left = b - np.abs(A[:, 2]) * yaw
    if np.min(left) <= 0.0:
        raise _too_much(yaw)
    flat, sign = A[:, :2], sign[:, :2]
    scale = _sizes(flat, left)
    flat = flat * scale / left[:, None]
    # Where v_j = 0 either side may come: the row must hold for both.
    with_v, against = np.zeros_like(flat), np.zeros_like(flat)
    still = sign == 0.0
    along = flat * sign
    with_v[~still], against[~still] = np.maximum(along, 0.0)[~still], np.maximum(-along, 0.0)[~still]
    with_v[still] = np.abs(flat)[still]  # from rest an axis can only speed up
    pair = largest_box(_once(np.hstack([with_v, against])))
    even = largest_box(_once(np.abs(flat)))
    fast, slow, even = (np.append(v * scale, yaw) for v in (pair[:2], pair[2:], even))
    return fast, slow, even


def _once(rows: Array) -> Array:
    rows = np.round(rows, 9)
    return rows[alike(rows)[1]]


def _tightest(A: Array, b: Array, sign: Array) -> tuple[Array, Array, Array]:
    """One row for each normal and sign pattern: the least b."""
    kind, first = alike(np.round(np.column_stack([A / np.max(np.abs(A)), sign]), 10))
    last_is_least = np.argsort(b, kind="stable")[::-1]  # of equal ones the first
    first[kind[last_is_least]] = last_is_least
    return A[first], b[first], sign[first]
