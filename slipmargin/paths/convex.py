"""The same fastest profile as a second-order-cone program: the independent road.

Verscheure et al., "Time-optimal path tracking for robots: a convex optimization approach", IEEE TAC
54(10), 2009: with x_j = ṡ_j² at the grid points and s̈ constant between them,

    min Σ 2 Δ_j / (z_j + z_{j+1}),   z_j² ≤ x_j,   rows linear in (s̈_j, x_j),

solved by Clarabel through cvxpy.  Beyond the compiled pass it also takes ellipsoids ‖Q a‖ ≤ 1 of
body accelerations (friction ellipses of the body, circle-limited planners).  A torque–speed line is
concave in x; its tangent at a profile (as :mod:`slipmargin.paths.along` writes it) keeps it convex.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.paths.along import Rows


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ellipsoids:
    """‖Q (push s̈ + bend ṡ²)‖ ≤ 1 at both ends (2, n, 3) of every interval, Q (3, 3)."""

    Q: Array
    push: Array
    bend: Array


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConvexProfile:
    """ṡ² (n + 1,) at the grid points, s̈ (n,) between them, and the time it takes [s]."""

    x: Array
    u: Array
    duration_s: float


def convex_profile(
    step: Array,
    rows: Rows,
    *,
    start_m_s: float = 0.0,
    end_m_s: float = 0.0,
    ellipsoids: Ellipsoids | None = None,
) -> ConvexProfile:
    """The fastest profile by convex programming.

    Parameters
    ----------
    step : (n,)
        Lengths of the intervals [m].
    rows : Rows
        The linear limits at both ends of every interval.

    Raises
    ------
    NoSolution
        If the solver finds none.
    """
    import cvxpy

    cp: Any = cvxpy

    n, size = len(step), max(float(np.sum(step)), 1e-9)
    # ṡ² grows in proportion to the distance from rest: scaled by it, all unknowns are of one size.
    s = np.concatenate([[0.0], np.cumsum(step)])
    typical = np.maximum(np.minimum(np.minimum(s, s[-1] - s), 0.25 * size), float(np.min(step)))
    y, w = cp.Variable(n + 1, nonneg=True), cp.Variable(n + 1, nonneg=True)
    x, z = cp.multiply(typical, y), cp.multiply(np.sqrt(typical), w)
    u = cp.multiply(0.5 / step, x[1:] - x[:-1])
    limits = [w <= cp.sqrt(y), y[0] == start_m_s**2 / typical[0], y[n] == end_m_s**2 / typical[n]]
    bounded = np.isfinite(rows.cap)
    if np.any(bounded):
        limits.append(x[bounded] <= rows.cap[bounded])
    for e, here in ((0, x[:-1]), (1, x[1:])):
        for r in range(rows.a.shape[2]):
            a, b, c = rows.a[e, :, r], rows.b[e, :, r], rows.c[e, :, r]
            width = np.abs(a) + np.abs(b)
            weight = 1.0 / np.maximum(width, 1e-6 * float(np.max(width)) or 1.0)
            left = cp.multiply(weight * a, u) + cp.multiply(weight * b, here)
            limits.append(left <= weight * c)
        if ellipsoids is not None:
            push, bend = ellipsoids.push[e] @ ellipsoids.Q.T, ellipsoids.bend[e] @ ellipsoids.Q.T
            columns = [cp.multiply(push[:, k], u) + cp.multiply(bend[:, k], here) for k in range(3)]
            limits.append(cp.norm(cp.vstack(columns), axis=0) <= 1.0)
    time = cp.sum(cp.multiply(2.0 * step / size, cp.inv_pos(z[1:] + z[:-1])))
    problem = cp.Problem(cp.Minimize(time), limits)
    with warnings.catch_warnings():  # an inaccurate end is judged by the caller: durations are compared
        warnings.simplefilter("ignore", UserWarning)
        problem.solve(solver="CLARABEL")
    if problem.status not in ("optimal", "optimal_inaccurate"):
        raise NoSolution(
            "convex profile",
            f"the solver ended as {problem.status}",
            "use a smaller margin or another path",
            problem,
        )
    found = np.maximum(np.asarray(x.value, dtype=np.float64), 0.0)
    root = np.sqrt(found)
    return ConvexProfile(
        x=found,
        u=np.asarray(np.diff(found) / (2.0 * step)),
        duration_s=float(np.sum(2.0 * step / (root[1:] + root[:-1]))),
    )
