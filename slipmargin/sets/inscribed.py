"""The largest box and the largest ellipsoid about the origin inside a polytope A a ≤ 1.

Both are small convex programs, of at most six unknowns whatever the number of rows:

    box        max Σ log x_j   s.t.  C x ≤ 1,           C ≥ 0
    ellipsoid  max log det P   s.t.  A_k·P A_k ≤ 1,     a = P^½ u, ‖u‖ ≤ 1

(S. Boyd and L. Vandenberghe, Convex Optimization, section 8.4).  A barrier method with damped Newton steps
(section 11.3) solves them.  General cone solvers gave up on every third drawn robot: they turn thousands of
nearly parallel rows into as many slack variables.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution

#: The optimum is approached until the objective is this close to it [1].
GAP = 1e-9
#: The weight of the barrier falls by this factor a stage; Newton steps a stage at most.
_FALL, _STEPS = 8.0, 80
#: Of more than twice so many rows so many are added at a time; how far within all the next search starts.
_PART, _NEAR = 1000, 0.9
#: Rows whose least and greatest spread are in less than this ratio do not span all dimensions [1].
FLAT = 1e-14
#: A stage ends where half the squared Newton decrement is below this [1].
_CENTRED = 1e-6

#: An objective: its value at x (−∞ outside its domain), gradient and Hessian.
_Objective = Callable[[Array], tuple[float, Array, Array]]


def largest_box(rows: Array) -> Array:
    """The box of largest volume: sides x (n,) > 0 with ``rows`` (K, n) x ≤ 1, rows ≥ 0.

    Sides that no row bounds are infinite.
    """
    bounded = np.max(rows, axis=0) > 0.0
    rows = rows[:, bounded]

    def volume(x: Array) -> tuple[float, Array, Array]:
        if np.min(x) <= 0.0:
            return -np.inf, x, np.diag(x)
        return float(np.sum(np.log(x))), 1.0 / x, -np.diag(1.0 / x**2)

    out = np.full(len(bounded), np.inf)
    out[bounded] = _maximise(volume, rows, 0.5 / (rows.shape[1] * np.max(rows, axis=0)))
    return out


def largest_ellipsoid(rows: Array) -> Array:
    """The ellipsoid of largest volume: E (d, d) symmetric with ‖E rows_k‖ ≤ 1 for ``rows`` (K, d).

    Raises
    ------
    NoSolution
        If the rows do not bound it in every direction.
    """
    d = rows.shape[1]
    spread = rows.T @ rows / len(rows)
    value, turn = np.linalg.eigh(spread) if np.all(np.isfinite(spread)) else (np.zeros(d), np.eye(d))
    if value[0] <= FLAT * value[-1]:
        raise NoSolution(
            "largest ellipsoid", "the rows leave some direction free", "bound it in every direction"
        )
    frame = turn / np.sqrt(value)  # it does not depend on the axes: in these it is no needle
    rows = rows @ frame
    i, j = np.triu_indices(d)
    basis = np.zeros((len(i), d, d))
    basis[np.arange(len(i)), i, j] = basis[np.arange(len(i)), j, i] = 1.0

    def volume(x: Array) -> tuple[float, Array, Array]:
        try:
            root = np.linalg.cholesky(np.tensordot(x, basis, 1))
        except np.linalg.LinAlgError:
            return -np.inf, x, np.diag(x)
        inverse = np.linalg.inv(root)
        seen = inverse @ basis @ inverse.T
        flat = seen.reshape(len(x), -1)
        return 2.0 * float(np.sum(np.log(np.diag(root)))), np.trace(seen, axis1=1, axis2=2), -flat @ flat.T

    start = np.where(i == j, 0.5 / (d * np.max(rows**2, axis=0)[i]), 0.0)
    x = _maximise(volume, np.einsum("ka,nab,kb->kn", rows, basis, rows), start)
    axes, size, _ = np.linalg.svd(frame @ np.linalg.cholesky(np.tensordot(x, basis, 1)))
    return np.asarray((axes * size) @ axes.T)  # not by eigenvalues: rounding makes those of a needle negative


def _maximise(objective: _Objective, rows: Array, x: Array) -> Array:
    """The x with rows x < 1 that is within :data:`GAP` of the largest objective, from an inner x.

    Of very many rows a part is kept, and those that its optimum breaks are added until it breaks none.
    """
    if len(rows) <= 2 * _PART:
        return _inside(objective, rows, x)
    chosen = np.zeros(len(rows), dtype=bool)
    reach = rows @ x
    while True:
        chosen[np.argpartition(reach, -_PART)[-_PART:]] = True
        found = _inside(objective, rows[chosen], x)
        reach = rows @ found
        if np.max(reach) < 1.0:
            return found
        x = found * (_NEAR / np.max(reach))  # within all rows again
        reach[chosen] = -np.inf


def _inside(objective: _Objective, rows: Array, x: Array) -> Array:
    weight = 1.0
    while True:
        x = _centre(objective, rows, x, weight)
        if weight * len(rows) <= GAP:
            return x
        weight /= _FALL


def _centre(objective: _Objective, rows: Array, x: Array, weight: float) -> Array:
    """The maximum of objective + weight Σ log(1 − rows x), by damped Newton steps."""
    value, gradient, hessian = objective(x)
    room = 1.0 - rows @ x
    value += weight * float(np.sum(np.log(room)))
    for _ in range(_STEPS):
        slope = gradient - weight * (rows / room[:, None]).sum(axis=0)
        scaled = rows / room[:, None]
        curved = weight * scaled.T @ scaled - hessian
        size_of = 1.0 / np.sqrt(np.diag(curved))
        step = size_of * np.linalg.solve(size_of[:, None] * curved * size_of, size_of * slope)
        gain = float(slope @ step)
        if gain <= 2.0 * _CENTRED * max(weight, GAP):
            break
        size = 1.0
        while size > 1e-12:
            new = x + size * step
            left = 1.0 - rows @ new
            if np.min(left) > 0.0:
                high, gradient_there, hessian_there = objective(new)
                high += weight * float(np.sum(np.log(left)))
                if high >= value + 0.1 * size * gain:
                    break
            size *= 0.5
        else:
            break
        x, room, value, gradient, hessian = new, left, high, gradient_there, hessian_there
    return x
