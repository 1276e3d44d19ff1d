"""How a run changes with small changes of its model: forward sensitivities along its steps (compiled).

Beside a run y(t) of ẏ = f(t, y) the run of a model f* that differs little is y + δ to first order, with

    δ̇ = ∂f/∂y δ + f*(t, y) − f(t, y)

along the run as it is (Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I, section I.14).
The steps are those that the run took, cut where they are long; each solves for δ with the implicit method
Radau IIA of order 3, which is L-stable.  One run and, a step, two looks at each other model take the place
of a run of each.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.compiled import inner, kernel
from slipmargin.physics.sectors import switching
from slipmargin.sim import layout as at
from slipmargin.sim.columns import RIGID
from slipmargin.sim.motion import (
    BEND,
    FROM,
    LONG_S,
    PIECE,
    PUSHED,
    TO,
    TRACE,
    TWIST,
    WHEN_S,
    jacobian,
    rates,
    rates_called,
)
from slipmargin.sim.pack import edges_of, wheels_of
from slipmargin.sim.rodas import between

#: Longest way of a wheel in a step [m]: a roller passes in four, and the sharp edge of a patch of floor is
#: felt where it is.  To keep to it no step is cut shorter than the first of these times [s]; none is longer
#: than the second.
_WAY_M, _SHORTEST_S, _LONGEST_S = 0.005, 0.01, 0.05
_ARM_X, _ARM_Y = at.ARM_X, at.ARM_Y
#: A step is looked at up to this share: at its end something may jump.
_INSIDE = 1.0 - 1e-9
_THIRD = 1.0 / 3.0
#: Changes below this are none [m, rad, m/s, rad/s].
_NOTHING = 1e-100
#: What a change of the model must leave alone, for it changes more than the forces at an instant.
_HEAD = [
    at.COUNT,
    at.COM_X,
    at.COM_Y,
    at.DELAY,
    at.DRIVEN,
    at.LAGGED,
    at.RAMP,
    at.PLAYS,
    at.COMMANDS,
    at.EDGES,
    at.RELIEFS,
]
_WHEEL = [at.LAG, at.GAIN, at.TOP_SPEED, at.PLAY, at.PITCH, at.RIGID_SHARE]
_SECTOR = [at.RIGID_SHARE, at.ROLLER_W, at.ROLLER_T, at.RIGID_W, at.RIGID_T]


def beside(row: Array, other: Array) -> bool:
    """Whether two packed models differ only in forces: wheels move alike and everything jumps when it did."""
    if row[at.DRIVEN] > 0.0 or not np.array_equal(row[_HEAD], other[_HEAD]):
        return False
    one, two = wheels_of(row), wheels_of(other)
    if not np.array_equal(one[:, _WHEEL], two[:, _WHEEL]):
        return False
    if not np.array_equal(switching(*one[:, _SECTOR].T), switching(*two[:, _SECTOR].T)):
        return False
    return all(np.array_equal(of(row), of(other)) for of in (edges_of, _commands, _reliefs))


def _commands(row: Array) -> Array:
    """The modulations of the command, which stand before the edges."""
    return row[int(row[at.COMMANDS_AT]) : int(row[at.EDGES_AT])] if row[at.COMMANDS] else row[:0]


def _reliefs(row: Array) -> Array:
    """The ridges of the floor: the run beside which one moves may step over what it would feel."""
    first = int(row[at.RELIEFS_AT])
    return row[first : first + int(row[at.RELIEFS]) * at.RELIEF]


def growing(others: int) -> tuple[Array, ...]:
    """Tables, all zero, that :func:`grow` works on: slopes, matrix, changes, differences of acceleration."""
    shapes = ((2, 6, 6), (12, 12), (others, 6), (2, others, 3), (3, 12))
    return tuple(np.zeros(shape) for shape in shapes)


@kernel
def grow(
    P: Any,
    W: Any,
    knots: Any,
    coef: Any,
    push: Any,
    columns: Any,
    others: Any,
    wheels: Any,
    trace: Any,
    times: Any,
    tables: Any,
    more: Any,
    out: Any,
) -> None:
    """Change of the pose of each of M models beside a run, to first order, at each of ``times``.

    P, W, knots, coef, push, columns, tables: those of the run (:func:`slipmargin.sim.motion.run`); ``others``
    (M, L) packed models and ``wheels`` (M, N, WHEEL) theirs; trace (S, TRACE + N) the run's steps; ``more``
    (:func:`growing`); out (M, T, 3).
    """
    n, many, total = len(W), len(others), len(times)
    C, S, _, J, _ = tables
    y, z, f = S[0], S[1], S[2]
    rate, B, acc, away = S[4], S[5], S[6], S[7]
    A, M, change, force, work = more
    new, rhs = work[0], work[1]
    row = 0
    for m in range(many):
        for r in range(6):
            change[m, r] = 0.0
    for s in range(len(trace)):
        step = trace[s]
        piece, pk = int(step[PIECE]), int(step[PUSHED])
        c, k0 = coef[piece], knots[piece]
        per_s = min(max(1.0 / _LONGEST_S, _fastest(W, step) / _WAY_M), 1.0 / _SHORTEST_S)
        parts = math.ceil(step[LONG_S] * per_s)
        h = step[LONG_S] / parts
        for part in range(parts):
            begins = step[WHEN_S] + part * h
            for stage in range(2):
                x = (part + (_THIRD if stage == 0 else _INSIDE)) / parts
                t = step[WHEN_S] + x * step[LONG_S]
                for r in range(6):
                    y[r] = between(step[FROM + r], step[TO + r], step[BEND + r], step[TWIST + r], x)
                for i in range(n):
                    C[i, RIGID] = step[TRACE + i]
                rates_called(P, W, t, y, c, k0, push, pk, C, B, acc, f)
                jacobian(P, W, t, y, c, k0, push, pk, C, B, columns, f, z, rate, away, J)
                _slopes(y, J, A[stage])
                for m in range(many):
                    rates(others[m], wheels[m], t, y, c, k0, push, pk, C, B, away, rate)
                    for r in range(3):
                        force[stage, m, r] = rate[3 + r] - f[3 + r]
            _inverted(A, h, M)
            last = row
            while last < total and times[last] < begins + h:
                last += 1
            for m in range(many):
                own, any_change = change[m], 0.0
                for r in range(6):
                    rhs[r], rhs[6 + r] = own[r], own[r]
                    any_change += abs(own[r]) + abs(force[r // 3, m, r % 3])
                if any_change == 0.0:
                    continue
                for r in range(3):
                    one, two = h * force[0, m, r], h * force[1, m, r]
                    rhs[3 + r] += 5.0 / 12.0 * one - 1.0 / 12.0 * two
                    rhs[9 + r] += 0.75 * one + 0.25 * two
                for r in range(12):
                    new[r] = 0.0
                for k in range(12):
                    for r in range(12):
                        new[r] += M[k, r] * rhs[k]
                for k in range(row, last):
                    x = max(0.0, (times[k] - begins) / h)
                    start, third, end = (
                        3.0 * (x - _THIRD) * (x - 1.0),
                        4.5 * x * (1.0 - x),
                        1.5 * x * (x - _THIRD),
                    )
                    for r in range(3):
                        out[m, k, r] = start * own[r] + third * new[r] + end * new[6 + r]
                for r in range(6):  # numbers that have all but died away would cost a hundred times as much
                    own[r] = new[6 + r] if abs(new[6 + r]) > _NOTHING else 0.0
            row = last
    for m in range(many):
        for k in range(row, total):
            for r in range(3):
                out[m, k, r] = change[m, r]


@inner
def _fastest(W: Any, step: Any) -> float:
    """How fast any wheel's contact moves at most at the two ends of a step [m/s]."""
    most = 0.0
    for end in (FROM, TO):
        speed = math.sqrt(step[end + 3] ** 2 + step[end + 4] ** 2)
        for w in W:
            arm = math.sqrt(w[_ARM_X] ** 2 + w[_ARM_Y] ** 2)
            most = max(most, speed + arm * abs(step[end + 5]))
    return most


@inner
def _slopes(y: Any, J: Any, A: Any) -> None:
    """∂f/∂y (6, 6) of a robot whose wheels are known in time, from its accelerations' derivatives."""
    c, s = math.cos(y[2]), math.sin(y[2])
    A[0, 2], A[0, 3], A[0, 4] = -s * y[3] - c * y[4], c, -s
    A[1, 2], A[1, 3], A[1, 4] = c * y[3] - s * y[4], s, c
    A[2, 5] = 1.0
    for r in range(3):
        for k in range(6):
            A[3 + r, k] = J[r, k]


@inner
def _inverted(A: Any, h: float, M: Any) -> None:
    """Transposed inverse (12, 12) of the matrix of a step's two stages with slopes A (2, 6, 6), into M."""
    for r in range(6):
        for k in range(6):
            one, two = h * A[0, r, k], h * A[1, r, k]
            M[k, r], M[6 + k, r] = -5.0 / 12.0 * one, 1.0 / 12.0 * two
            M[k, 6 + r], M[6 + k, 6 + r] = -0.75 * one, -0.25 * two
        M[r, r] += 1.0
        M[6 + r, 6 + r] += 1.0
    for k in range(12):  # Gauss and Jordan in place
        per = 1.0 / M[k, k]
        M[k, k] = 1.0
        for r in range(12):
            M[k, r] *= per
        for r in range(12):
            if r != k:
                share = M[r, k]
                M[r, k] = 0.0
                for j in range(12):
                    M[r, j] -= share * M[k, j]
