"""One stiffly accurate Rosenbrock step for the robot's six states (compiled).

RODAS, order 4(3), L-stable, six stages, dense output (Hairer & Wanner, Solving Ordinary Differential
Equations II, section IV.10).  The linear systems use the exact block structure: poses follow
velocities, so each stage solves a 3 × 3 system only.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.sim import layout as at
from slipmargin.sim.body import evaluate, slopes
from slipmargin.sim.compiled import fast, inner

GAMMA = 0.25
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

_BY_POSITION, _BY_VELOCITY, _ITERATES = at.BY_POSITION, at.BY_VELOCITY, at.LOAD_ITERATES


@inner
def derivative(y: Any, acc: Any, dy: Any) -> None:
    """ẏ from the state and the acceleration acc = (a, ω̇) in body axes."""
    c, s = math.cos(y[2]), math.sin(y[2])
    dy[0] = c * y[3] - s * y[4]
    dy[1] = s * y[3] + c * y[4]
    dy[2] = y[5]
    dy[3] = acc[0] + y[5] * y[4]
    dy[4] = acc[1] - y[5] * y[3]
    dy[5] = acc[2]


@fast
def jacobian(
    P: Any,
    t: float,
    y: Any,
    C: Any,
    B: Any,
    acc: Any,
    pose: bool,
    J: Any,
    jt: Any,
    Jp: Any,
    trial: Any,
    away: Any,
) -> None:
    """∂(a, ω̇)/∂velocity → J, ∂/∂t → jt (through wheel speeds), ∂/∂pose → Jp; analytic where it can be.

    ``acc`` holds the value at y; ``trial`` (6) and ``away`` (3) are work space.
    """
    slopes(P, C, B, J, jt)
    by_velocity = P[_BY_VELOCITY] > 0 or P[_ITERATES] > 0
    for k in range(6):
        if (k < 2 and P[_BY_POSITION] == 0.0) or (k == 2 and not pose) or (k >= 3 and not by_velocity):
            continue
        for r in range(6):
            trial[r] = y[r]
        trial[k] = y[k] + (1e-7 if k < 3 else 1e-9)
        d = trial[k] - y[k]
        evaluate(P, t, trial, C, B, away)
        for r in range(3):
            if k < 3:
                Jp[r, k] = (away[r] - acc[r]) / d
            else:
                J[r, k - 3] = (away[r] - acc[r]) / d


@inner
def factor(J: Any, Jp: Any, y: Any, gh: float, pose: bool, M: Any, E: Any) -> None:
    """Invert the reduced velocity matrix into M (3, 3); E (4) holds ∂ẋ/∂φ, ∂ẏ/∂φ, cos φ, sin φ."""
    c, s = math.cos(y[2]), math.sin(y[2])
    E[0], E[1], E[2], E[3] = -s * y[3] - c * y[4], c * y[3] - s * y[4], c, s
    a, b, d = -J[0, 0] + 1.0 / gh, -J[0, 1] - y[5], -J[0, 2] - y[4]
    e, f, g = -J[1, 0] + y[5], -J[1, 1] + 1.0 / gh, -J[1, 2] + y[3]
    p, q, r = -J[2, 0], -J[2, 1], -J[2, 2] + 1.0 / gh
    if pose:  # − Jp (1/γh − J_pp)⁻¹ J_pv, column by column
        x0, x1 = gh * c, gh * s
        a -= Jp[0, 0] * x0 + Jp[0, 1] * x1
        e -= Jp[1, 0] * x0 + Jp[1, 1] * x1
        p -= Jp[2, 0] * x0 + Jp[2, 1] * x1
        b -= Jp[0, 1] * x0 - Jp[0, 0] * x1
        f -= Jp[1, 1] * x0 - Jp[1, 0] * x1
        q -= Jp[2, 1] * x0 - Jp[2, 0] * x1
        x0, x1 = gh * gh * E[0], gh * gh * E[1]
        d -= Jp[0, 0] * x0 + Jp[0, 1] * x1 + Jp[0, 2] * gh
        g -= Jp[1, 0] * x0 + Jp[1, 1] * x1 + Jp[1, 2] * gh
        r -= Jp[2, 0] * x0 + Jp[2, 1] * x1 + Jp[2, 2] * gh
    m00, m01, m02 = f * r - g * q, d * q - b * r, b * g - d * f
    det = 1.0 / (a * m00 + e * m01 + p * m02)
    M[0, 0], M[0, 1], M[0, 2] = m00 * det, m01 * det, m02 * det
    M[1, 0], M[1, 1], M[1, 2] = (g * p - e * r) * det, (a * r - d * p) * det, (d * e - a * g) * det
    M[2, 0], M[2, 1], M[2, 2] = (e * q - f * p) * det, (b * p - a * q) * det, (a * f - b * e) * det


@inner
def solve(M: Any, E: Any, Jp: Any, gh: float, pose: bool, r: Any, K: Any, i: int) -> None:
    """Stage k = K[i] with (1/(γh) − ∂ẏ/∂y) k = r."""
    r3, r4, r5, c, s = r[3], r[4], r[5], E[2], E[3]
    if pose:
        z2 = gh * r[2]
        z0, z1 = gh * (r[0] + E[0] * z2), gh * (r[1] + E[1] * z2)
        r3 += Jp[0, 0] * z0 + Jp[0, 1] * z1 + Jp[0, 2] * z2
        r4 += Jp[1, 0] * z0 + Jp[1, 1] * z1 + Jp[1, 2] * z2
        r5 += Jp[2, 0] * z0 + Jp[2, 1] * z1 + Jp[2, 2] * z2
    k3 = M[0, 0] * r3 + M[0, 1] * r4 + M[0, 2] * r5
    k4 = M[1, 0] * r3 + M[1, 1] * r4 + M[1, 2] * r5
    k5 = M[2, 0] * r3 + M[2, 1] * r4 + M[2, 2] * r5
    k2 = gh * (r[2] + k5)
    K[i, 0] = gh * (r[0] + E[0] * k2 + c * k3 - s * k4)
    K[i, 1] = gh * (r[1] + E[1] * k2 + s * k3 + c * k4)
    K[i, 2], K[i, 3], K[i, 4], K[i, 5] = k2, k3, k4, k5
