"""Cone programs solved through cvxpy: a second computation of every answer, written independently.

Diamond and Boyd, "CVXPY: A Python-embedded modeling language for convex optimization", JMLR 17 (2016).
"""

from __future__ import annotations

import warnings
from typing import Any

import cvxpy
import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.solve.program import ConeKind, ConeProgram, Solution

cp: Any = cvxpy  # its functions are not declared to type checkers

#: Relative gaps and feasibilities asked of the solver [1]; the next is tried where the solver stalls.
#: Second-order cones stall below 1e-9, and at 1e-9 where the grips of all wheels are nearly parallel.
TOLERANCES, CONE_TOLERANCES = (1e-10,), (1e-9, 1e-8)


def solve(program: ConeProgram) -> Solution:
    """Solve one program, its blocks stated as cvxpy constraints.

    Raises
    ------
    NoSolution
        With the program as evidence.
    """
    x = cp.Variable(len(program.c))
    rows = program.b - program.a @ x
    constraints = []
    for block, at in program.slices():
        part = rows[at]
        if block.kind is ConeKind.ZERO:
            constraints.append(part == 0)
        elif block.kind is ConeKind.NONNEGATIVE:
            constraints.append(part >= 0)
        else:
            constraints.append(cp.SOC(part[0], part[1:]))
    problem = cp.Problem(cp.Minimize(program.c @ x), constraints)
    round_ = any(block.kind is ConeKind.SECOND_ORDER for block in program.blocks)
    _run(problem, program.what, CONE_TOLERANCES if round_ else TOLERANCES)
    s = program.b - program.a @ x.value
    z = np.zeros(len(program.b))
    for (block, at), constraint in zip(program.slices(), constraints, strict=True):
        dual = constraint.dual_value
        if block.kind is ConeKind.ZERO:
            z[at], s[at] = -np.ravel(dual), 0.0
        elif block.kind is ConeKind.NONNEGATIVE:
            z[at] = np.ravel(dual)
        else:
            z[at] = np.concatenate([np.ravel(part) for part in dual])
    return Solution(program=program, x=x.value, s=s, z=z, solver="cvxpy")


def block_box(maps: Array, limits: Array, rays: Array, bias: Array | None = None) -> Array:
    """Eqs (13)–(18) for every ray as ONE problem: max Σ F_m, B f_m + F_m d_m = −w_m, |f| ≤ limits.

    Parameters
    ----------
    maps : (3, n)
        B: wrench of each unit force.
    limits : (n,)
    rays : (M, 3)
    bias : (M, 3), optional

    Returns
    -------
    (M,) F_m
    """
    count = len(rays)
    unit = np.max(limits)
    size = np.array([1.0, 1.0, np.max(np.abs(maps[2])) or 1.0])[:, None]
    force, reach = cp.Variable((maps.shape[1], count)), cp.Variable((1, count))
    right = np.zeros((3, count)) if bias is None else -bias.T / (unit * size)
    box = np.repeat((limits / unit)[:, None], count, axis=1)
    constraints = [
        (maps / size) @ force + cp.multiply(rays.T / size, np.ones((3, 1)) @ reach) == right,
        force <= box,
        -box <= force,
    ]
    _run(cp.Problem(cp.Maximize(cp.sum(reach)), constraints), f"{count} pulls as one problem")
    return np.asarray(reach.value[0] * unit)


def block_cone(maps: Array, radii: Array, strips: Array, rays: Array) -> Array:
    """As :func:`block_box` for forces in ellipses cut by strips, one second-order cone a wheel and ray.

    Parameters
    ----------
    maps : (3, N, 2)
    radii : (N, 2)
        Semi-axes (f_1/r_1)² + (f_2/r_2)² ≤ 1 [N].
    strips : (N,)
        |f_2| ≤ strip [N]; infinity for none.
    rays : (M, 3)

    Returns
    -------
    (M,) F_m
    """
    count, unit = len(rays), np.max(radii)
    size = np.array([1.0, 1.0, np.max(np.abs(maps[2])) or 1.0])[:, None]
    reach = cp.Variable((1, count))
    balance = cp.multiply(rays.T / size, np.ones((3, 1)) @ reach)
    constraints = []
    for i in range(maps.shape[1]):
        share = cp.Variable((2, count))  # of each semi-axis
        balance = balance + (maps[:, i] * (radii[i] / unit) / size) @ share
        constraints.append(cp.norm(share, 2, axis=0) <= 1.0)
        if strips[i] < radii[i, 1]:
            constraints.append(cp.abs(share[1]) <= strips[i] / radii[i, 1])
    constraints.append(balance == 0)
    _run(
        cp.Problem(cp.Maximize(cp.sum(reach)), constraints), f"{count} pulls as one problem", CONE_TOLERANCES
    )
    return np.asarray(reach.value[0] * unit)


def _run(problem: Any, what: str, tolerances: tuple[float, ...] = TOLERANCES) -> None:
    for tolerance in tolerances:
        with warnings.catch_warnings():
            # The status says the same as cvxpy's warning, and is judged below.
            warnings.filterwarnings("ignore", message="Solution may be inaccurate")
            problem.solve(
                solver=cp.CLARABEL, tol_gap_abs=tolerance, tol_gap_rel=tolerance, tol_feas=tolerance
            )
        if problem.status == cp.OPTIMAL:
            return
    raise NoSolution(what, f"cvxpy found it {problem.status}", "relax a bound", problem)
