"""Clarabel, directly: one program, or one set-up updated for a whole family.

Presolve is off: it forbids updates, and these programs are too small to gain from it.
Goulart and Chen, "Clarabel: an interior-point solver for conic programs", arXiv:2405.12762.
"""

from __future__ import annotations

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.solve.program import ConeFamily, ConeKind, ConeProgram, Solution

#: Relative gap and feasibility asked of the solver [1].
TOLERANCE = 1e-10
#: A solution that the solver calls almost solved must be proven to this [1].
ALMOST = 1e-8
#: Static regularisations [1].  The first is the solver's own, with which the balance of thin ellipses may end
#: a little above :data:`ALMOST`; such a program is solved again with the others, of which each fails on some.
REGULAR, OTHERS = 1e-8, (1e-10, 1e-12, 1e-11, 1e-9, 1e-13)
#: Answers that are no, with why and what to do.
REFUSED = {
    clarabel.SolverStatus.PrimalInfeasible: ("no point satisfies every row", "relax a bound"),
    clarabel.SolverStatus.DualInfeasible: ("its value has no bound", "bound the force"),
}


def solve(program: ConeProgram) -> Solution:
    """Solve one program.

    Raises
    ------
    NoSolution
        With the program as evidence.
    """
    solver = _solver(program, program.a, program.b, program.a != 0.0)
    answer = solver.solve()
    return _accept(answer, program)


def solve_family(family: ConeFamily) -> tuple[Array, Array, Array]:
    """Solve every program of a family with one set-up; one that is the same as that before it is not solved.

    Returns
    -------
    x (M, V), s (M, R), z (M, R)

    Raises
    ------
    NoSolution
        With the first program that has no answer as evidence.
    """
    count, (rows, columns) = len(family), family.a.shape[1:]
    x, s, z = np.empty((count, columns)), np.empty((count, rows)), np.empty((count, rows))
    if count == 0:
        return x, s, z
    shape = np.any(family.a != 0.0, axis=0)
    at_row, at_column = _pattern(shape)
    data = family.a[:, at_row, at_column]
    moving = np.flatnonzero(np.any(data != data[0], axis=0))
    moving_b = np.flatnonzero(np.any(family.b != family.b[0], axis=0))
    solver = _solver(family, family.a[0], family.b[0], shape)
    changes, changes_b = np.ascontiguousarray(data[:, moving]), np.ascontiguousarray(family.b[:, moving_b])
    same = np.all(changes[1:] == changes[:-1], axis=1) & np.all(changes_b[1:] == changes_b[:-1], axis=1)
    for m in range(count):
        if m and same[m - 1]:
            x[m], s[m], z[m] = x[m - 1], s[m - 1], z[m - 1]
            continue
        if m and len(moving):
            solver.update(A=(moving, changes[m]))
        if m and len(moving_b):
            solver.update(b=(moving_b, changes_b[m]))
        answer = solver.solve()
        if answer.status != clarabel.SolverStatus.Solved:
            answer = _accept(answer, family.program(m))
        x[m], s[m], z[m] = answer.x, answer.s, answer.z
    return x, s, z


def _pattern(shape: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    # Rows and columns of the entries in the order of a compressed-column matrix.
    columns, rows = np.nonzero(shape.T)
    return rows, columns


def _solver(
    form: ConeProgram | ConeFamily, a: Array, b: Array, shape: NDArray[np.bool_], regular: float = REGULAR
) -> clarabel.DefaultSolver:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.presolve_enable = False
    settings.max_threads = 1
    settings.static_regularization_constant = regular
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    rows, columns = _pattern(shape)
    starts = np.concatenate([[0], np.cumsum(np.count_nonzero(shape, axis=0))])
    matrix = csc_matrix((a[rows, columns], rows, starts), shape=a.shape)
    cone = {
        ConeKind.ZERO: clarabel.ZeroConeT,
        ConeKind.NONNEGATIVE: clarabel.NonnegativeConeT,
        ConeKind.SECOND_ORDER: clarabel.SecondOrderConeT,
    }
    none = csc_matrix((a.shape[1], a.shape[1]))
    return clarabel.DefaultSolver(
        none, form.c, matrix, b, [cone[k.kind](len(k.rows)) for k in form.blocks], settings
    )


def _accept(answer: clarabel.DefaultSolution, program: ConeProgram) -> Solution:
    """The answer if the solver says so or it is proven to :data:`ALMOST`, else one found again."""
    tried: list[Solution] = []
    for regular in (REGULAR, *OTHERS):
        if regular != REGULAR:
            answer = _solver(program, program.a, program.b, program.a != 0.0, regular).solve()
        if answer.status in REFUSED:
            raise NoSolution(program.what, *REFUSED[answer.status], program)
        x, s, z = (np.array(v) for v in (answer.x, answer.s, answer.z))
        if not np.all(np.isfinite(np.concatenate([x, s, z]))):
            continue
        tried.append(Solution(program=program, x=x, s=s, z=z, solver="Clarabel"))
        if answer.status == clarabel.SolverStatus.Solved or tried[-1].certificate().worst <= ALMOST:
            return tried[-1]
    if not tried:
        why = f"Clarabel stopped with {answer.status}"
        raise NoSolution(program.what, why, "scale the program", program)
    return min(tried, key=lambda found: found.certificate().worst).proven(ALMOST)
