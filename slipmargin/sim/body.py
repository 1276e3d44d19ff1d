"""Forces and accelerations of the whole robot at one instant (compiled).

The state begins with (X, Y, φ, v_x, v_y, ω): centre of mass in the floor frame, velocity of the centre
of mass in the body frame.  Equations of motion about the centre of mass (eqs 4–7 for any wheels):

    m (v̇ + ω × v) = F,   I ω̇ = M,   F = −Σ N_i (f_W,i ĝ_i + f_T,i f̂_i + ∇h_i) + external forces

with the slope ∇h_i of the floor under wheel i (physics/relief.py).  Loads are N_i = S_i + P_i·a with
a = F/m and S_i = rest_i (1 − lift/Σ rest) + tilt_i·Σ h_k F_k (physics/loads.py), so they are solved with
the motion (:mod:`slipmargin.sim.balance`).  Where a wheel lifts, S and P are those of
:mod:`slipmargin.sim.lifting`.
"""

from __future__ import annotations

import math
from typing import Any

from slipmargin.physics import contact as contacts
from slipmargin.physics.compiled import inner, spliced, twin
from slipmargin.sim import layout as at
from slipmargin.sim.balance import accelerate
from slipmargin.sim.columns import (
    ALPHA,
    BY_SPEED,
    BY_TORQUE,
    DRAGS,
    FACTORS,
    FORCE_T,
    FORCE_W,
    GROW_T,
    GROW_W,
    INVERSE,
    JAMMED,
    K_T,
    K_W,
    LEVER,
    LIFT,
    LOAD,
    MU_T,
    MU_W,
    OMEGA,
    PASS_T,
    PASS_W,
    RESTING,
    RIGID,
    ROUND,
    SHARED,
    SHARED_X,
    SHARED_Y,
    SLIP_T,
    SLIP_W,
    STILL,
    THETA,
    TILTING,
    TT,
    UP,
    WT,
    WW,
)
from slipmargin.sim.lifting import hang, lifts
from slipmargin.sim.varying import climb, dragging, external, factors, passing

_MASS, _INERTIA, _LAG, _DROOP, _STALL = at.MASS, at.INERTIA, at.LAG, at.DROOP, at.STALL_TORQUE
_SLOWING, _WHEEL_INERTIA, _LAW, _K = at.SLOWING, at.INERTIA_OF_WHEEL, at.LAW, at.STEEPNESS
_SHAPE, _COUPLING, _CW, _CT, _LIFTED = at.SHAPE, at.COUPLING, at.VISCOUS_W, at.VISCOUS_T, at.LIFTED
_MODS, _RELIEFS, _FOLLOWS, _BY_LOAD, _GX = at.MODULATIONS, at.RELIEFS, at.LOAD_FOLLOWS, at.BY_LOAD, at.GRIP_X
_GY, _GM, _GR, _FX, _FY = at.GRIP_Y, at.GRIP_MOMENT, at.GRIP_ROLLS, at.FREE_X, at.FREE_Y
_FM, _FR, _REST, _LX, _LY = at.FREE_MOMENT, at.FREE_ROLLS, at.REST, at.LOAD_X, at.LOAD_Y
_BY_HUB, _BY_MOTION, _AX, _AY = at.BY_HUB, at.BY_MOTION, at.ARM_X, at.ARM_Y
_MU, _TX, _TY, _OUT_COS, _OUT_SIN = at.ROLLER_W, at.TILT_X, at.TILT_Y, at.RUNOUT_COS, at.RUNOUT_SIN
_TOE_COS, _TOE_SIN, _MEAN_GX, _MEAN_FX = at.WOBBLE_COS, at.WOBBLE_SIN, at.MEAN_GRIP_X, at.MEAN_FREE_X

_contact = twin(contacts.contact)


@inner
def turn_wheel(w: Any, toe: float) -> None:
    """Turn ĝ and f̂ of a wheel by ``toe`` [rad] from where they stand without wobble, about the vertical."""
    c, s = math.cos(toe), math.sin(toe)
    for first, mean in ((_GX, _MEAN_GX), (_FX, _MEAN_FX)):
        x, y = c * w[mean] - s * w[mean + 1], s * w[mean] + c * w[mean + 1]
        w[first], w[first + 1], w[first + 2] = x, y, w[_AX] * y - w[_AY] * x


@spliced
def evaluate(P: Any, W: Any, t: float, y: Any, C: Any, B: Any, acc: Any) -> None:
    """Acceleration acc (3) = (a, ω̇) in body axes; fills the rest of C and B.

    Reads ω, θ, ω̇ and the sector of each wheel from C and the push from B; turns the wheels in W that wobble.
    """
    external(P, W, t, y, C, B)
    if P[_RELIEFS] > 0.0:
        climb(P, W, y, C)
    vx, vy, vw = y[3], y[4], y[5]
    left, hx, hy = 1.0 - B[LIFT] / P[_LIFTED], B[TILTING], B[TILTING + 1]
    law, shape, coupling = int(P[_LAW]), int(P[_SHAPE]), P[_COUPLING]
    k, modulated, follows, resting = P[_K], P[_MODS] > 0.0, P[_FOLLOWS] > 0.0, B[RESTING] > 0.0
    for turn in range(60):
        for i in range(len(W)):
            w, c = W[i], C[i]
            if turn == 0:
                c[ROUND] = 1.0
                if w[_OUT_COS] != 0.0 or w[_OUT_SIN] != 0.0:
                    c[ROUND] += w[_OUT_COS] * math.cos(c[THETA]) + w[_OUT_SIN] * math.sin(c[THETA])
                if w[_TOE_COS] != 0.0 or w[_TOE_SIN] != 0.0:
                    turn_wheel(w, w[_TOE_COS] * math.cos(c[THETA]) + w[_TOE_SIN] * math.sin(c[THETA]))
            rolls = c[OMEGA] * c[ROUND]
            uw = w[_GX] * vx + w[_GY] * vy + w[_GM] * vw + w[_GR] * rolls
            ut = w[_FX] * vx + w[_FY] * vy + w[_FM] * vw + w[_FR] * rolls
            still = left * w[_REST] + w[_TX] * hx + w[_TY] * hy
            c[SLIP_W], c[SLIP_T], c[STILL] = uw, ut, still
            c[SHARED], c[SHARED_X], c[SHARED_Y] = still, w[_LX], w[_LY]
            if resting:
                c[SHARED], c[SHARED_X], c[SHARED_Y] = max(0.0, still), 0.0, 0.0
            if turn == 0:
                c[LOAD] = still
            z = _MU + 2 * int(c[RIGID])
            mw, mt = w[z], w[z + 1]
            kw, kt = k, k
            if modulated:
                factors(P, W, i, t, y, C, B)
                mw, mt = mw * B[FACTORS], mt * B[FACTORS + 1]
                kw, kt = kw * B[FACTORS + 2], kt * B[FACTORS + 3]
            f, g, ww, wt, _, tt = _contact(law, shape, coupling, uw, ut, mw, mt, kw, kt)
            if modulated:
                ww, tt = ww + f * B[FACTORS + 4], tt + g * B[FACTORS + 5]
            c[FORCE_W], c[FORCE_T] = f, g
            c[WW], c[WT], c[TT] = ww, wt, tt
            c[MU_W], c[MU_T] = mw, mt
            c[K_W], c[K_T] = kw, kt
        before_x, before_y = acc[0], acc[1]
        accelerate(P, W, C, B, acc)
        B[UP], B[JAMMED] = 0.0, 0.0
        if not resting and lifts(P, C):
            hang(P, W, C, B, acc)
        if P[_BY_LOAD] == 0.0 or not (follows or B[UP] > 0.0):
            break  # nothing that friction depends on has changed
        change = abs(acc[0] - before_x) + abs(acc[1] - before_y)
        if turn > 0 and change <= 1e-14 * (1.0 + abs(acc[0]) + abs(acc[1])):
            break


@inner
def wheel_rate(P: Any, w: Any, c: Any, asked: float, rising: float) -> float:
    """ω̇ of a driven wheel whose loop is asked for a speed and its derivative, from what evaluate left in C.

    The loop asks τ ω̇ = ω_ref − droop T − ω; a wheel without lag follows ω̇_ref as well, with τ =
    :data:`LEAST_LAG_S`.  The motor's torque T + J ω̇ keeps to the line ± stall (1 ∓ ω/max_speed).
    """
    torque = (c[LOAD] * c[FORCE_W] + P[_CW] * c[SLIP_W]) * w[_GR]
    torque += (c[LOAD] * c[FORCE_T] + P[_CT] * c[SLIP_T]) * w[_FR]
    torque *= c[ROUND]
    lag, omega, droop = max(w[_LAG], LEAST_LAG_S), c[OMEGA], w[_DROOP]
    rate = (asked - droop * torque - omega) / lag
    if w[_LAG] == 0.0:
        rate += rising
    c[BY_TORQUE], c[BY_SPEED] = -droop / lag, -1.0 / lag
    stall = w[_STALL]
    if stall > 0.0:
        inertia, slowing = w[_WHEEL_INERTIA], stall * P[_SLOWING]
        wanted = torque + inertia * rate + slowing * omega
        if abs(wanted) > stall:
            rate = (math.copysign(stall, wanted) - slowing * omega - torque) / inertia
            c[BY_TORQUE], c[BY_SPEED] = -1.0 / inertia, -slowing / inertia
    return float(rate)


#: Time constant of a driven wheel that has no lag of its own [s]: it keeps the loop solvable, and a step
#: of the command loses no more angle than the wheel turns in this time.
LEAST_LAG_S = 1e-4


@inner
def slopes(P: Any, W: Any, t: float, y: Any, C: Any, B: Any, J: Any, speeds: int) -> None:
    """Analytic derivatives of the body's (and driven wheels') accelerations, after :func:`evaluate`.

    Into J (3 or 3 + N rows): column 3 + k over velocity k (v_x, v_y, ω and, where there are ``speeds`` = N,
    the wheel speeds); without speeds the last column over time, through prescribed wheel speeds.
    """
    by_hub, by_motion = P[_BY_HUB] > 0.0, P[_BY_MOTION] > 0.0
    if by_motion:
        dragging(P, W, t, y, C, B)
    if by_hub:
        for i in range(len(W)):
            passing(P, W, i, y, C)
    for k in range(3 + max(speeds, 1)):
        fx, fy, mz, hx, hy = 0.0, 0.0, 0.0, 0.0, 0.0
        pulled = by_motion and k < 3
        if pulled:
            q = DRAGS + 5 * k
            fx, fy, mz, hx, hy = B[q], B[q + 1], B[q + 2], B[q + 3], B[q + 4]
        for i in range(len(W)):
            row, c = W[i], C[i]
            w, v = row[_GX + min(k, 3)], row[_FX + min(k, 3)]
            if k >= 3:
                rolls = c[ALPHA]
                if speeds > 0:
                    rolls = 1.0 if i == k - 3 else 0.0
                w, v = w * rolls * c[ROUND], v * rolls * c[ROUND]
            load, wt = c[LOAD], c[WT]
            a = load * (c[WW] * w + wt * v) + P[_CW] * w
            b = load * (wt * w + c[TT] * v) + P[_CT] * v
            if by_hub:
                x = 1.0 if k == 0 else (-row[_AY] if k == 2 else 0.0)
                z = 1.0 if k == 1 else (row[_AX] if k == 2 else 0.0)
                a += load * (c[PASS_W] * x + c[PASS_W + 1] * z + c[PASS_W + 2] * w)
                b += load * (c[PASS_T] * x + c[PASS_T + 1] * z + c[PASS_T + 2] * w)
            if pulled:  # what tips the robot presses the wheel
                more = row[_TX] * hx + row[_TY] * hy
                a += more * c[FORCE_W]
                b += more * c[FORCE_T]
            c[GROW_W], c[GROW_T] = a, b
            fx -= a * row[_GX] + b * row[_FX]
            fy -= a * row[_GY] + b * row[_FY]
            mz -= a * row[_GM] + b * row[_FM]
        ax, ay = B[INVERSE] * fx + B[INVERSE + 1] * fy, B[INVERSE + 2] * fx + B[INVERSE + 3] * fy
        column = 3 + k if k < 3 or speeds > 0 else J.shape[1] - 1
        J[0, column], J[1, column] = ax, ay
        J[2, column] = (mz + B[LEVER] * ax + B[LEVER + 1] * ay) / P[_INERTIA]
        for i in range(speeds):  # torques follow the loads, which follow the body
            row, c = W[i], C[i]
            load = c[SHARED_X] * ax + c[SHARED_Y] * ay
            torque = (c[GROW_W] + c[FORCE_W] * load) * row[_GR]
            torque += (c[GROW_T] + c[FORCE_T] * load) * row[_FR]
            torque *= c[ROUND]
            J[3 + i, column] = c[BY_TORQUE] * torque + (c[BY_SPEED] if k - 3 == i else 0.0)
    # v̇ = a − ω × v
    J[0, 4] += y[5]
    J[0, 5] += y[4]
    J[1, 3] -= y[5]
    J[1, 5] -= y[3]
