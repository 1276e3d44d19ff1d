"""The largest box and the largest ellipsoid about the origin inside a polytope A a ≤ 1.

Both are small convex programs, of at most six unknowns whatever the number of rows:

    box        max Σ log x_j   s.t.  C x ≤ 1,           C ≥ 0
    ellipsoid  max log det P   s.t.  A_k·P A_k ≤ 1,     a = P^½ u, ‖u‖ ≤ 1

(S. Boyd and L. Vandenberghe, Convex Optimization, section 8.4).  A barrier method with damped Newton steps
(section 11.3) solves them.  General cone solvers gave up on every third drawn robot: they turn thousands of
nearly parallel rows into as many slack variables.
"""

from __future__ import annotations

import math

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.errors import NoSolution
from slipmargin.physics.compiled import inner, kernel

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


def largest_box(rows: Array) -> Array:
    """The box of largest volume: sides x (n,) > 0 with ``rows`` (K, n) x ≤ 1, rows ≥ 0.

    Sides that no row bounds are infinite.
    """
    bounded = np.max(rows, axis=0) > 0.0
    rows = _outermost(rows[:, bounded])
    none = np.zeros(0, dtype=np.intp)
    out = np.full(len(bounded), np.inf)
    out[bounded] = _largest(rows, 0.5 / (rows.shape[1] * np.max(rows, axis=0)), none, none)
    return out


def _outermost(rows: Array) -> Array:
    """The rows (K, n) that none of the others exceeds in every column: C ≥ C' makes C x ≤ 1 the tighter."""
    sums = rows.sum(axis=1)
    rows = np.ascontiguousarray(rows[np.argsort(-sums, kind="stable")])  # what exceeds a row stands before it
    return rows[: _keep_outermost(rows)]


@kernel
def _keep_outermost(rows: Array) -> int:
    """Move the outermost of rows in falling order of their sums to the front; how many they are."""
    kept = 0
    for k in range(len(rows)):
        outermost = True
        for o in range(kept):
            below = True
            for a in range(rows.shape[1]):
                if rows[k, a] > rows[o, a]:
                    below = False
                    break
            if below:
                outermost = False
                break
        if outermost:
            for a in range(rows.shape[1]):
                rows[kept, a] = rows[k, a]
            kept += 1
    return kept


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
    # a·P a in the entries of P above its diagonal
    squares = rows[:, i] * rows[:, j] * np.where(i == j, 1.0, 2.0)
    x = _largest(squares, np.where(i == j, 0.5 / (d * np.max(rows**2, axis=0)[i]), 0.0), i, j)
    root = np.zeros((d, d))
    root[i, j] = root[j, i] = x
    axes, size, _ = np.linalg.svd(frame @ np.linalg.cholesky(root))
    return np.asarray((axes * size) @ axes.T)  # not by eigenvalues: rounding makes those of a needle negative


def _largest(rows: Array, start: Array, i: Index, j: Index) -> Array:
    """The x with rows x < 1 that is within :data:`GAP` of the largest objective, from an inner ``start``.

    The objective is Σ log x, or log det P of the P whose entries ``i``, ``j`` are x.  Of very many rows a
    part is kept, and those that its optimum breaks are added until it breaks none.
    """
    if len(rows) <= 2 * _PART:
        return _within(rows, start, i, j)
    chosen = np.zeros(len(rows), dtype=bool)
    x, reach = start, rows @ start
    while True:
        chosen[np.argpartition(reach, -_PART)[-_PART:]] = True
        found = _within(rows[chosen], x, i, j)
        reach = rows @ found
        most = float(np.max(reach))
        if most < 1.0:
            return found
        x = found * (_NEAR / most)  # within all rows again
        reach[chosen] = -np.inf


def _within(rows: Array, start: Array, i: Index, j: Index) -> Array:
    n, x = len(start), np.array(start)
    tables = np.zeros((7, n, n)), np.zeros((7, n)), np.zeros((2, len(rows)))
    _maximise(np.ascontiguousarray(rows), x, i, j, *tables)
    return x


@kernel
def _maximise(
    rows: Array, x: Array, i: Index, j: Index, squares: Array, lines: Array, columns: Array
) -> None:
    """The maximum, in place, of objectives that lean less and less on the barrier."""
    weight = 1.0
    while True:
        _centre(rows, x, weight, i, j, squares, lines, columns)
        if weight * len(rows) <= GAP:
            return
        weight /= _FALL


@inner
def _centre(
    rows: Array,
    x: Array,
    weight: float,
    i: Index,
    j: Index,
    squares: Array,
    lines: Array,
    columns: Array,
) -> None:
    """The maximum of objective + weight Σ log(1 − rows x), by damped Newton steps, in place."""
    n = len(x)
    slope, size_of, step, new = lines[0], lines[1], lines[2], lines[3]
    gradient, there = lines[4], lines[5]
    curved, root, curvature, bend = squares[0], squares[1], squares[2], squares[3]
    room, left = columns[0], columns[1]
    value = _objective(x, i, j, gradient, curvature, squares) + weight * _room(rows, x, room)
    for _ in range(_STEPS):
        for a in range(n):
            slope[a] = gradient[a]
            for b in range(a + 1):
                curved[a, b] = curvature[a, b]
        for k in range(len(rows)):
            for a in range(n):
                scaled = rows[k, a] / room[k]
                slope[a] -= weight * scaled
                for b in range(a + 1):
                    curved[a, b] += weight * scaled * rows[k, b] / room[k]
        for a in range(n):
            size_of[a] = 1.0 / math.sqrt(curved[a, a])
        for a in range(n):
            new[a] = size_of[a] * slope[a]
            for b in range(a + 1):
                curved[a, b] *= size_of[a] * size_of[b]
        if not _cholesky(curved, root):
            break
        _solve(root, new, step)
        gain = 0.0
        for a in range(n):
            step[a] *= size_of[a]
            gain += slope[a] * step[a]
        if not gain > 2.0 * _CENTRED * max(weight, GAP):
            break
        size, high, better = 1.0, value, False
        while size > 1e-12:
            for a in range(n):
                new[a] = x[a] + size * step[a]
            inside = _room(rows, new, left)
            if inside > -math.inf:
                high = _objective(new, i, j, there, bend, squares) + weight * inside
                if high >= value + 0.1 * size * gain:
                    better = True
                    break
            size *= 0.5
        if not better:
            break
        value = high
        for a in range(n):
            x[a], gradient[a] = new[a], there[a]
            for b in range(n):
                curvature[a, b] = bend[a, b]
        for k in range(len(rows)):
            room[k] = left[k]


@inner
def _room(rows: Array, x: Array, room: Array) -> float:
    """1 − rows x, and the sum of its logarithms; −∞ where one is not positive."""
    total = 0.0
    for k in range(len(rows)):
        room[k] = 1.0
        for a in range(len(x)):
            room[k] -= rows[k, a] * x[a]
        if not room[k] > 0.0:
            return -math.inf
        total += math.log(room[k])
    return total


@inner
def _objective(x: Array, i: Index, j: Index, gradient: Array, curvature: Array, squares: Array) -> float:
    """Σ log x, or log det P where ``i``, ``j`` name its entries; its gradient and −Hessian.  −∞ outside."""
    n, total = len(x), 0.0
    if len(i) == 0:
        for a in range(n):
            if not x[a] > 0.0:
                return -math.inf
            total += math.log(x[a])
            gradient[a] = 1.0 / x[a]
            for b in range(n):
                curvature[a, b] = 1.0 / x[a] ** 2 if a == b else 0.0
        return total
    d = i[n - 1] + 1
    P, root, inverse = squares[4][:d, :d], squares[5][:d, :d], squares[6][:d, :d]
    for a in range(n):
        P[i[a], j[a]] = P[j[a], i[a]] = x[a]
    if not _cholesky(P, root):
        return -math.inf
    for a in range(d):
        total += 2.0 * math.log(root[a, a])
        for b in range(d):
            P[0, b] = 1.0 if a == b else 0.0  # P itself is not needed any more
        _solve(root, P[0], inverse[a])
    for a in range(n):
        gradient[a] = inverse[i[a], j[a]] * (1.0 if i[a] == j[a] else 2.0)
        for b in range(n):
            # tr(P⁻¹ A P⁻¹ B) of the symmetric unit matrices A and B of two entries
            one = inverse[j[b], i[a]] * inverse[j[a], i[b]]
            two = inverse[i[b], i[a]] * inverse[j[a], j[b]]
            curvature[a, b] = (one + two) * (0.5 if i[a] == j[a] else 1.0) * (1.0 if i[b] == j[b] else 2.0)
    return total


@inner
def _cholesky(A: Array, root: Array) -> bool:
    """L of A = L Lᵀ from the lower triangle of A; False where A is not definite."""
    for a in range(len(A)):
        for b in range(a + 1):
            left = A[a, b]
            for c in range(b):
                left -= root[a, c] * root[b, c]
            if a != b:
                root[a, b] = left / root[b, b]
            elif left > 0.0:
                root[a, a] = math.sqrt(left)
            else:
                return False
    return True


@inner
def _solve(root: Array, b: Array, x: Array) -> None:
    """x with L Lᵀ x = b."""
    n = len(root)
    for a in range(n):
        x[a] = b[a]
        for c in range(a):
            x[a] -= root[a, c] * x[c]
        x[a] /= root[a, a]
    for a in range(n - 1, -1, -1):
        for c in range(a + 1, n):
            x[a] -= root[c, a] * x[c]
        x[a] /= root[a, a]
