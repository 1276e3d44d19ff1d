"""The acceleration that agrees with loads that follow it (compiled).

With N_i = S_i + P_i·a and the force per load φ_i = f_W ĝ_i + f_T f̂_i + ∇h_i (:mod:`slipmargin.sim.body`),

    (m 1 + Σ φ_i P_iᵀ) a = −Σ (S_i φ_i + viscous friction) + external forces

are two linear equations; the yaw acceleration follows.
"""

from __future__ import annotations

from typing import Any

from slipmargin.physics.compiled import inner
from slipmargin.sim import layout as at
from slipmargin.sim.columns import (
    FORCE_T,
    FORCE_W,
    INVERSE,
    LEVER,
    LOAD,
    RISE_M,
    RISE_X,
    RISE_Y,
    SHARED,
    SHARED_X,
    SHARED_Y,
    SLIP_T,
    SLIP_W,
    WRENCH,
)

_MASS, _INERTIA, _CW, _CT = at.MASS, at.INERTIA, at.VISCOUS_W, at.VISCOUS_T
_GX, _GY, _GM, _FX, _FY, _FM = at.GRIP_X, at.GRIP_Y, at.GRIP_MOMENT, at.FREE_X, at.FREE_Y, at.FREE_MOMENT


@inner
def accelerate(P: Any, W: Any, C: Any, B: Any, acc: Any) -> None:
    """Acceleration acc (3) = (a, ω̇) and the loads that follow it, from what each wheel carries and rubs."""
    fx, fy, mz = B[WRENCH], B[WRENCH + 1], B[WRENCH + 2]
    mxx, mxy, lx = P[_MASS], 0.0, 0.0
    myx, myy, ly = 0.0, P[_MASS], 0.0
    for i in range(len(W)):
        w, c = W[i], C[i]
        f, g, still, px, py = c[FORCE_W], c[FORCE_T], c[SHARED], c[SHARED_X], c[SHARED_Y]
        a, b = P[_CW] * c[SLIP_W], P[_CT] * c[SLIP_T]
        x = f * w[_GX] + g * w[_FX] + c[RISE_X]
        v = f * w[_GY] + g * w[_FY] + c[RISE_Y]
        m = f * w[_GM] + g * w[_FM] + c[RISE_M]
        fx -= still * x + a * w[_GX] + b * w[_FX]
        fy -= still * v + a * w[_GY] + b * w[_FY]
        mz -= still * m + a * w[_GM] + b * w[_FM]
        mxx, mxy = mxx + x * px, mxy + x * py
        myx, myy = myx + v * px, myy + v * py
        lx, ly = lx - m * px, ly - m * py
    det = 1.0 / (mxx * myy - mxy * myx)
    ax, ay = (myy * fx - mxy * fy) * det, (mxx * fy - myx * fx) * det
    B[INVERSE], B[INVERSE + 1], B[INVERSE + 2], B[INVERSE + 3] = myy * det, -mxy * det, -myx * det, mxx * det
    B[LEVER], B[LEVER + 1] = lx, ly
    acc[0], acc[1], acc[2] = ax, ay, (mz + lx * ax + ly * ay) / P[_INERTIA]
    for i in range(len(W)):
        C[i, LOAD] = C[i, SHARED] + C[i, SHARED_X] * ax + C[i, SHARED_Y] * ay
