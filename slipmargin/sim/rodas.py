"""The stiffly accurate Rosenbrock method behind every step, and its linear systems (compiled).

RODAS, order 4(3), L-stable, six stages, dense output (Hairer & Wanner, Solving Ordinary Differential
Equations II, section IV.10).  The linear systems use the block structure: positions follow
velocities, so each stage solves for the velocities only: 3, or 3 + N where wheel speeds are states.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.physics.compiled import inner, spliced

GAMMA = 0.25
#: Velocities may err by this many times the tolerance of poses: friction damps them within milliseconds.
LOOSER = 10.0
#: Stage i starts at y + Σ_j STAGE[i, j] k_j; its right-hand side gets Σ_j MIX[i, j] k_j / h.
STAGE = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [1.544, 0.0, 0.0, 0.0, 0.0],
        [0.9466785280815826, 0.2557011698983284, 0.0, 0.0, 0.0],
        [3.314825187068521, 2.896124015972201, 0.9986419139977817, 0.0, 0.0],
        [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 0.0],
        [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0],
    ]
)
MIX = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [-5.6688, 0.0, 0.0, 0.0, 0.0],
        [-2.430093356833875, -0.2063599157091915, 0.0, 0.0, 0.0],
        [-0.1073529058151375, -9.594562251023355, -20.47028614809616, 0.0, 0.0],
        [7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160, 0.0],
        [8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054],
    ]
)
#: When a stage looks at the world (share of the step), and its share of h ∂f/∂t.
WHEN = np.array([0.0, 0.386, 0.21, 0.63, 1.0, 1.0])
TIME = np.array([0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0])
#: Dense output y(x) = (1 − x) y0 + x (y1 + (1 − x)(c + x d)), c and d from the first five stages.
DENSE = np.array(
    [
        [10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662],
        [-0.6762803392806898, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872],
    ]
)


@spliced
def factor(J: Any, y: Any, gh: float, M: Any, E: Any) -> None:
    """Invert the velocities' matrix, positions eliminated, into M; E (4): ∂ẋ/∂φ, ∂ẏ/∂φ, cos φ, sin φ.

    M comes from 1/(γh) − ∂v̇/∂v − ∂v̇/∂p (1/(γh) − ∂ṗ/∂p)⁻¹ ∂ṗ/∂v, with v_x, v_y, ω (and the wheel speeds)
    as velocities and X, Y, φ (and the wheel angles) as positions.
    """
    n, speeds = M.shape[0], M.shape[0] - 3
    c, s = math.cos(y[2]), math.sin(y[2])
    E[0], E[1], E[2], E[3] = -s * y[3] - c * y[4], c * y[3] - s * y[4], c, s
    for r in range(n):
        for k in range(n):
            M[r, k] = -J[r, 3 + k]
        for k in range(speeds):
            M[r, 3 + k] -= gh * J[r, 3 + n + k]
        M[r, r] += 1.0 / gh
        M[r, 0] -= gh * (c * J[r, 0] + s * J[r, 1])
        M[r, 1] -= gh * (c * J[r, 1] - s * J[r, 0])
        M[r, 2] -= gh * (gh * (E[0] * J[r, 0] + E[1] * J[r, 1]) + J[r, 2])
    for k in range(n):  # Gauss and Jordan in place; a bad pivot costs a rejected step, no more
        per = 1.0 / M[k, k]
        M[k, k] = 1.0
        for r in range(n):
            M[k, r] *= per
        for r in range(n):
            if r != k:
                share = M[r, k]
                M[r, k] = 0.0
                for j in range(n):
                    M[r, j] -= share * M[k, j]


@spliced
def solve(J: Any, M: Any, E: Any, gh: float, ahead: float, pose: bool, f: Any, r: Any, k: Any) -> None:
    """Stage k with (1/(γh) − ∂ẏ/∂y) k = r + f + ``ahead``·∂f/∂t; r is overwritten."""
    n, speeds = M.shape[0], M.shape[0] - 3
    for i in range(len(k)):
        r[i] += f[i]
    for i in range(n):
        r[3 + i] += ahead * J[i, J.shape[1] - 1]
    if pose:
        turned = gh * r[2]
        x, z = gh * (r[0] + E[0] * turned), gh * (r[1] + E[1] * turned)
        for i in range(n):
            r[3 + i] += J[i, 0] * x + J[i, 1] * z + J[i, 2] * turned
            for j in range(speeds):
                r[3 + i] += J[i, 3 + n + j] * gh * r[3 + n + j]
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += M[i, j] * r[3 + j]
        k[3 + i] = total
    k[2] = gh * (r[2] + k[5])
    k[0] = gh * (r[0] + E[0] * k[2] + E[2] * k[3] - E[3] * k[4])
    k[1] = gh * (r[1] + E[1] * k[2] + E[3] * k[3] + E[2] * k[4])
    for j in range(speeds):
        k[3 + n + j] = gh * (r[3 + n + j] + k[6 + j])


@spliced
def begin(y: Any, K: Any, stage: int, step: float, z: Any, rhs: Any) -> None:
    """Where a stage looks at the right-hand side, into z, and what the stages before add to it, into rhs."""
    for r in range(K.shape[1]):
        at, add = y[r], 0.0
        for j in range(stage):
            at += STAGE[stage, j] * K[j, r]
            add += MIX[stage, j] * K[j, r]
        z[r], rhs[r] = at, add / step


@spliced
def end(y: Any, K: Any, start: Any, rtol: float, atol: float, radius: float, z: Any) -> float:
    """State at the end of the step, into z, and its error [1]: a step is good up to 1.

    The pose may miss a share ``rtol`` of its way from the ``start`` of the run: the origin does not matter.
    """
    error, m = 0.0, K.shape[1]
    for r in range(m):
        z[r] += K[5, r]
        loose = 1.0 if r < 3 else LOOSER
        zero = start[r] if r < 3 else 0.0
        least = atol if r < 6 else atol / radius
        miss = K[5, r] / (loose * (least + rtol * max(abs(y[r] - zero), abs(z[r] - zero))))
        error += miss * miss
    return math.sqrt(error / m)


@inner
def bends(K: Any, r: int) -> tuple[float, float]:
    """What the dense output of state r needs of a step's stages K."""
    c, d = 0.0, 0.0
    for j in range(5):
        c += DENSE[0, j] * K[j, r]
        d += DENSE[1, j] * K[j, r]
    return c, d


@inner
def between(start: float, end: float, c: float, d: float, x: float) -> float:
    """A state at the share x of a step that led it from start to end and :func:`bends` so."""
    return start * (1.0 - x) + x * (end + (1.0 - x) * (c + x * d))


@inner
def dense(y: Any, z: Any, K: Any, r: int, x: float) -> float:
    """State r at the share x of a step from y to z with stages K."""
    c, d = bends(K, r)
    return float(between(y[r], z[r], c, d, x))
