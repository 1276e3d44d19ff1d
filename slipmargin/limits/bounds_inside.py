"""The largest box and the largest ellipsoid of accelerations that are safe whatever the motion.

Tools that take one number an axis need a box.  Which accelerations are admissible depends on the
direction of motion (drag helps to brake and hinders speeding up), so the box has a speeding-up and a
slowing-down side for each axis: component j may lie between −slow_j and +fast_j along sign(v_j).  Both
sets come from convex programs (S. Boyd and L. Vandenberghe, Convex Optimization, section 8.4) in
cvxpy, solved by Clarabel:

    box         max Σ log fast_j + Σ log slow_j   s.t.  Σ_j (A_j s_j)⁺ fast_j + (A_j s_j)⁻ slow_j ≤ b
    ellipsoid   max log det E                     s.t.  ‖E A_k‖ ≤ b_k
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.motion import needed_share
from slipmargin.limits.motion_rows import acceleration_rows
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.physics.frames import directions
from slipmargin.physics.kinematics import com_acceleration

#: Directions of translation and yaw rates (times speed over arm) that the sets must be safe for.
HEADINGS, YAW = 72, (-1.0, 0.0, 1.0)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inside:
    """Safe sets of body accelerations (right, forward, yaw) for every direction of motion.

    ``fast`` and ``slow`` (3,): how much each axis may speed up and slow down at once [m/s², m/s², rad/s²];
    ``even`` (3,): the largest box with equal sides, for tools with one number an axis.
    ``ellipsoid`` (3, 3): accelerations E u, ‖u‖ ≤ 1; ``circle_m_s2``: the largest acceleration in any
    direction without yaw acceleration.
    """

    fast: Array
    slow: Array
    even: Array
    ellipsoid: Array
    circle_m_s2: float


def safe_rows(
    model: Model, *, share: float = 1.0, contact: Contact = Contact.ROLLERS
) -> tuple[Array, Array, Array]:
    """Rows A (R, 3) a ≤ b (R,) on the origin's acceleration for every motion, and sign(v) (R, 3).

    Raises
    ------
    NoSolution
        If some motion must slip even at constant speed.
    """
    motion = _all_motions(model)
    need = needed_share(model, motion, contact=contact)
    if float(np.max(need)) >= share:
        v = motion.velocity[int(np.argmax(need))]
        way = f"along {np.rad2deg(np.arctan2(v[1], v[0])) % 360.0:.0f}°" + (" while turning" if v[2] else "")
        worst = float(np.max(need))
        if np.isinf(worst):
            raise NoSolution(
                "safe accelerations",
                f"in steady motion {way} drag uses the whole grip of a wheel and leaves none to drive",
                "use the grip disc-strip for rollers that spin freely, or lower the transverse friction",
            )
        cure = (
            f"use a margin below {np.floor(100.0 * (1.0 - worst)) / 100.0:g}"
            if worst < 1.0
            else "plan for rollers only, or lower the transverse friction"
        )
        raise NoSolution(
            "safe accelerations", f"steady motion {way} already needs {worst:.3g} of the grip", cure
        )
    rows = acceleration_rows(model, motion, share=share, contact=contact)
    shift = com_acceleration(model.inertia.com_m, np.zeros((3, 3)), np.eye(3)).T
    A, b = rows.A @ shift, rows.b
    sign = np.broadcast_to(np.sign(motion.velocity)[:, None], A.shape)
    return _tightest(A.reshape(-1, 3), b.ravel(), sign.reshape(-1, 3))


def inside(model: Model, *, share: float = 1.0, contact: Contact = Contact.ROLLERS) -> Inside:
    """The largest safe box and ellipsoid; see the module for the programs."""
    A, b, sign = safe_rows(model, share=share, contact=contact)
    scale = np.min(
        b / np.maximum(np.abs(A), 1e-12 * np.max(np.abs(A)))[np.arange(len(b))[:, None], np.arange(3)].T,
        axis=1,
    )
    scaled = A * scale / b[:, None]
    return Inside(
        **_boxes(scaled, sign, scale),
        ellipsoid=_ellipsoid(scaled, scale),
        circle_m_s2=float(np.min(b / np.maximum(np.hypot(A[:, 0], A[:, 1]), 1e-300))),
    )


def _boxes(A: Array, sign: Array, scale: Array) -> dict[str, Array]:
    import cvxpy

    cp: Any = cvxpy

    # Where v_j = 0 either side may come: the row must hold for both.
    with_v, against = np.zeros_like(A), np.zeros_like(A)
    still = sign == 0.0
    along = A * sign
    with_v[~still], against[~still] = np.maximum(along, 0.0)[~still], np.maximum(-along, 0.0)[~still]
    with_v[still] = np.abs(A)[still]  # from rest an axis can only speed up
    fast, slow, even = cp.Variable(3, pos=True), cp.Variable(3, pos=True), cp.Variable(3, pos=True)
    pair = cp.Problem(
        cp.Maximize(cp.sum(cp.log(fast)) + cp.sum(cp.log(slow))),
        [_once(np.hstack([with_v, against])) @ cp.hstack([fast, slow]) <= 1.0],
    )
    one = cp.Problem(cp.Maximize(cp.sum(cp.log(even))), [_once(np.abs(A)) @ even <= 1.0])
    _solve(pair, "box")
    _solve(one, "box")
    return {"fast": _value(fast) * scale, "slow": _value(slow) * scale, "even": _value(even) * scale}


def _ellipsoid(A: Array, scale: Array) -> Array:
    import cvxpy

    cp: Any = cvxpy

    E = cp.Variable((3, 3), PSD=True)
    problem = cp.Problem(cp.Maximize(cp.log_det(E)), [cp.norm(_once(A) @ E, axis=1) <= 1.0])
    _solve(problem, "ellipsoid")
    return np.asarray(scale[:, None] * _value(E))


def _once(rows: Array) -> Array:
    return np.unique(np.round(rows, 9), axis=0)


def _solve(problem: Any, what: str) -> None:
    problem.solve(solver="CLARABEL")
    if problem.status != "optimal":
        raise NoSolution(
            f"largest {what}",
            f"the solver ended as {problem.status}",
            "check the margin and the robot's friction",
            problem,
        )


def _value(variable: Any) -> Array:
    return np.asarray(variable.value, dtype=np.float64)


def _all_motions(model: Model) -> Motion:
    arm = float(np.mean(np.hypot(*(model.geometry.position_m - model.inertia.com_m).T)))
    ahead = directions(2.0 * np.pi * np.arange(HEADINGS) / HEADINGS)
    moves = [np.column_stack([ahead, np.full(HEADINGS, y / arm)]) for y in YAW]
    return Motion.full_drag(np.vstack([*moves, [[0.0, 0.0, 1.0 / arm], [0.0, 0.0, -1.0 / arm]]]))


def _tightest(A: Array, b: Array, sign: Array) -> tuple[Array, Array, Array]:
    """One row for each normal and sign pattern: the least b."""
    keys = np.round(np.column_stack([A / np.max(np.abs(A)), sign]), 10)
    _, group = np.unique(keys, axis=0, return_inverse=True)
    order = np.lexsort((b, group.ravel()))
    first = order[np.concatenate([[True], np.diff(group.ravel()[order]) > 0])]
    return A[first], b[first], sign[first]
