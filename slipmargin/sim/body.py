"""Forces and accelerations of the whole robot at one instant (compiled).

State y = (X, Y, φ, v_x, v_y, ω): centre of mass in the floor frame, velocity of the centre of mass in
the body frame.  Equations of motion about the centre of mass (eqs 4–7 for any wheels):

    m (v̇ + ω × v) = F,   I ω̇ = M,   F = −Σ N_i (f_W,i ĝ_i + f_T,i f̂_i) + losses + push

With N_i = N0_i + P_i·a and a = F/m the loads are solved consistently:
(m 1 + Σ φ_i P_iᵀ) a = Σ N0_i (−φ_i) + rest, φ_i = f_W ĝ_i + f_T f̂_i: two linear equations.
"""

from __future__ import annotations

import math
from typing import Any

from slipmargin.sim import layout as at
from slipmargin.sim.compiled import fast, inner
from slipmargin.sim.friction import contact
from slipmargin.sim.terms import series, series_slope

_H, _W, _TERM = at.HEAD, at.WHEEL, at.TERM
_COUNT, _MASS, _INERTIA, _COM_X, _COM_Y = at.COUNT, at.MASS, at.INERTIA, at.COM_X, at.COM_Y
_K, _SHAPE, _COUPLING, _CW, _CT = at.STEEPNESS, at.SHAPE, at.COUPLING, at.VISCOUS_W, at.VISCOUS_T
_MODS, _MODS_AT, _FORCES, _FORCES_AT = at.MODULATIONS, at.MODULATIONS_AT, at.FORCES, at.FORCES_AT
_FOLLOWS, _ITERATES, _SHARE = at.LOAD_FOLLOWS, at.LOAD_ITERATES, at.SHARE
_AX, _AY, _DX, _DY, _GX, _GY, _FX, _FY = (
    at.ARM_X,
    at.ARM_Y,
    at.DRIVE_X,
    at.DRIVE_Y,
    at.GRIP_X,
    at.GRIP_Y,
    at.FREE_X,
    at.FREE_Y,
)
_RHO, _REST, _LX, _LY, _RW, _GW = at.RADIUS, at.REST, at.LOAD_X, at.LOAD_Y, at.ROLLER_W, at.RIGID_W
_NSX = at.NO_SLIP_X

#: Below this speed a force against the motion fades out smoothly: v/√(v² + v₀²) [m/s], [rad/s].
SLOW_M_S = 1e-3
SLOW_RAD_S = 1e-2
#: Added to the rolling speed in the slip ratio [m/s] (model/variables.py).
CRAWL_M_S = 1e-3


#: Columns of the contact table C (N, CONTACT): what is known of each wheel at one instant.
OMEGA, THETA, ALPHA, RIGID = 0, 1, 2, 3  #: ω [rad/s], θ [rad], ω̇ [rad/s²], 1 on rigid material
SLIP_W, SLIP_T = 4, 5  #: sliding velocity along ĝ, f̂ [m/s]
FORCE_W, FORCE_T = 6, 7  #: f_W, f_T per unit of load [1]
LOAD = 8  #: [N]
WW, WT, TW, TT = 9, 10, 11, 12  #: slopes of the law [s/m]
CONTACT = 13
#: Entries of the body table B: external push in the floor frame, inverse of the mass matrix of a
#: (2 × 2 row by row), yaw moment per acceleration that loads bring about, factors of a wheel.
PUSH, INVERSE, LEVER, FACTORS = 0, 3, 7, 9
BODY = 15


@inner
def _asked(P: Any, C: Any, row: int) -> float:
    """No-slip body acceleration that the wheels ask for, component ``row`` (0 x, 1 y, 2 yaw)."""
    total = 0.0
    for i in range(int(P[_COUNT])):
        total += P[_H + i * _W + _NSX + row] * C[i, ALPHA]
    return total


@inner
def _body_variable(P: Any, code: int, t: float, y: Any, C: Any) -> float:
    w, phi = y[5], y[2]
    if code == 0:
        return 1.0
    if code == 7:
        return float(y[3] + w * P[_COM_Y])
    if code == 8:
        return float(y[4] - w * P[_COM_X])
    if code == 9:
        return float(w)
    if code == 10:
        return math.hypot(y[3] + w * P[_COM_Y], y[4] - w * P[_COM_X])
    if code <= 13:
        return _asked(P, C, code - 11)
    if code == 14:
        return float(phi)
    if code == 15:
        return float(y[0] - math.cos(phi) * P[_COM_X] + math.sin(phi) * P[_COM_Y])
    if code == 16:
        return float(y[1] - math.sin(phi) * P[_COM_X] - math.cos(phi) * P[_COM_Y])
    return t


@inner
def _wheel_variable(P: Any, code: int, i: int, direction: int, y: Any, C: Any) -> float:
    q = _H + i * _W
    u = C[i, SLIP_W + direction]
    if code == 1:
        return float(C[i, THETA])
    if code == 2:
        return float(C[i, LOAD] / P[_SHARE] - 1.0)
    if code == 3:
        return abs(float(u))
    if code == 5:
        return math.atan2(abs(C[i, SLIP_T]), abs(C[i, SLIP_W]))
    if code == 18:
        d = q + _GX + 2 * direction
        return float(y[2] + math.atan2(P[d + 1], P[d]) + (math.pi if u < 0.0 else 0.0))
    hub = math.hypot(y[3] - y[5] * P[q + _AY], y[4] + y[5] * P[q + _AX])
    if code == 20:
        return hub
    if code == 21:
        reach = math.hypot(P[q + _AX], P[q + _AY])
        out = y[3] * P[q + _AX] + y[4] * P[q + _AY]
        return float(out / (reach * (hub + CRAWL_M_S))) if reach > 0.0 else 0.0
    roll = max(hub, abs(P[q + _RHO] * C[i, OMEGA]))
    if code == 6:
        return float(roll)
    return float(abs(u) / (roll + CRAWL_M_S))


@inner
def _factors(P: Any, i: int, t: float, y: Any, C: Any, G: Any) -> None:
    """What all modulations make of (μ_W, μ_T, k_W, k_T) of wheel i, into the factors G[:4].

    G[4], G[5]: relative slopes of μ_W over u_W and μ_T over u_T that come from the slip speed.
    """
    for r in range(4):
        G[r] = 1.0
    G[4], G[5] = 0.0, 0.0
    n = int(P[_COUNT])
    q = int(P[_MODS_AT])
    for _ in range(int(P[_MODS])):
        code, basis, target, count = int(P[q]), int(P[q + 1]), int(P[q + 2]), int(P[q + 3])
        a, b, weight, place = P[q + 4], P[q + 5], P[q + _TERM + i], q + _TERM + n
        q = place + count
        if weight == 0.0:
            continue
        own = 1 <= code <= 6 or code == 18 or code >= 20
        sided = code == 3 or code == 4 or code == 18
        kind = 2 if target >= 3 else 0
        first = 1.0
        for side in range(2):
            if target in (1 - side, 5 - side):
                continue
            if side == 0 or sided or target in (1, 5):
                v = _wheel_variable(P, code, i, side, y, C) if own else _body_variable(P, code, t, y, C)
                first = max(0.0, 1.0 + weight * series(P, place, count, basis, a, b, v))
                if code == 3 and first > 0.0:
                    u = C[i, SLIP_W + side]
                    slope = weight * series_slope(P, place, count, basis, a, b, v) / first
                    G[4 + side] += slope if u > 0.0 else (-slope if u < 0.0 else 0.0)
            G[kind + side] *= first


@inner
def losses(P: Any, t: float, y: Any, C: Any) -> tuple[float, float, float]:
    """All force terms as one wrench in the body frame about the centre of mass."""
    fx, fy, mz = 0.0, 0.0, 0.0
    q = int(P[_FORCES_AT])
    for _ in range(int(P[_FORCES])):
        code, basis, frame, count = int(P[q]), int(P[q + 1]), int(P[q + 2]), int(P[q + 3])
        a, b, place = P[q + 4], P[q + 5], q + _TERM
        v = _body_variable(P, code, t, y, C)
        x = series(P, place, count, basis, a, b, v)
        z = series(P, place + count, count, basis, a, b, v)
        m = series(P, place + 2 * count, count, basis, a, b, v)
        q = place + 3 * count
        if frame == 1:
            c, s = math.cos(y[2]), math.sin(y[2])
            x, z = c * x + s * z, c * z - s * x
        elif frame == 2:
            vx, vy = y[3] + y[5] * P[_COM_Y], y[4] - y[5] * P[_COM_X]
            size = math.sqrt(vx * vx + vy * vy + SLOW_M_S * SLOW_M_S)
            c, s = vx / size, vy / size
            x, z = -c * x - s * z, -s * x + c * z
            m = -m * y[5] / math.sqrt(y[5] * y[5] + SLOW_RAD_S * SLOW_RAD_S)
        fx += x
        fy += z
        mz += m
    return fx, fy, mz


@fast
def evaluate(P: Any, t: float, y: Any, C: Any, B: Any, acc: Any) -> None:
    """Acceleration acc (3) = (a, ω̇) in body axes; fills the rest of C and B.

    Reads ω, θ, ω̇ and the sector of each wheel from C and the push from B.
    """
    n = int(P[_COUNT])
    w = y[5]
    for i in range(n):
        q = _H + i * _W
        r = P[q + _RHO] * C[i, OMEGA]
        ux = y[3] - w * P[q + _AY] + r * P[q + _DX]
        uy = y[4] + w * P[q + _AX] + r * P[q + _DY]
        C[i, SLIP_W] = ux * P[q + _GX] + uy * P[q + _GY]
        C[i, SLIP_T] = ux * P[q + _FX] + uy * P[q + _FY]
        C[i, LOAD] = P[q + _REST]
    px, py, pm = 0.0, 0.0, B[PUSH + 2]
    if B[PUSH] != 0.0 or B[PUSH + 1] != 0.0:
        c, s = math.cos(y[2]), math.sin(y[2])
        px, py = c * B[PUSH] + s * B[PUSH + 1], c * B[PUSH + 1] - s * B[PUSH]
    if P[_FORCES] > 0:
        x, v, m = losses(P, t, y, C)
        px, py, pm = px + x, py + v, pm + m
    mass, modulated, follows, shape = P[_MASS], P[_MODS] > 0, P[_FOLLOWS] > 0, int(P[_SHAPE])
    G = B[FACTORS:]
    rounds = 60 if P[_ITERATES] > 0 else 1
    for turn in range(rounds):
        fx, fy, mz = px, py, pm
        mxx, mxy, myx, myy, lx, ly = mass, 0.0, 0.0, mass, 0.0, 0.0
        for i in range(n):
            q = _H + i * _W
            z = q + (_GW if C[i, RIGID] > 0.0 else _RW)
            mw, mt, kw, kt = P[z], P[z + 1], P[_K], P[_K]
            if modulated:
                _factors(P, i, t, y, C, G)
                mw, mt, kw, kt = mw * G[0], mt * G[1], kw * G[2], kt * G[3]
            law = contact(shape, P[_COUPLING], C[i, SLIP_W], C[i, SLIP_T], mw, mt, kw, kt)
            C[i, FORCE_W], C[i, FORCE_T] = law[0], law[1]
            C[i, WW], C[i, WT], C[i, TW], C[i, TT] = law[2], law[3], law[4], law[5]
            if modulated:
                C[i, WW] += law[0] * G[4]
                C[i, TT] += law[1] * G[5]
            vw, vt = P[_CW] * C[i, SLIP_W], P[_CT] * C[i, SLIP_T]
            rest = P[q + _REST]
            a, b = rest * law[0] + vw, rest * law[1] + vt
            x = -(a * P[q + _GX] + b * P[q + _FX])
            v = -(a * P[q + _GY] + b * P[q + _FY])
            fx += x
            fy += v
            mz += P[q + _AX] * v - P[q + _AY] * x
            if follows:
                x = -(law[0] * P[q + _GX] + law[1] * P[q + _FX])
                v = -(law[0] * P[q + _GY] + law[1] * P[q + _FY])
                m = P[q + _AX] * v - P[q + _AY] * x
                mxx -= x * P[q + _LX]
                mxy -= x * P[q + _LY]
                myx -= v * P[q + _LX]
                myy -= v * P[q + _LY]
                lx += m * P[q + _LX]
                ly += m * P[q + _LY]
        det = 1.0 / (mxx * myy - mxy * myx)
        B[INVERSE], B[INVERSE + 1], B[INVERSE + 2], B[INVERSE + 3] = (
            myy * det,
            -mxy * det,
            -myx * det,
            mxx * det,
        )
        B[LEVER], B[LEVER + 1] = lx, ly
        ax = B[INVERSE] * fx + B[INVERSE + 1] * fy
        ay = B[INVERSE + 2] * fx + B[INVERSE + 3] * fy
        change = abs(ax - acc[0]) + abs(ay - acc[1])
        acc[0], acc[1], acc[2] = ax, ay, (mz + lx * ax + ly * ay) / P[_INERTIA]
        if follows:
            for i in range(n):
                q = _H + i * _W
                C[i, LOAD] = P[q + _REST] + P[q + _LX] * ax + P[q + _LY] * ay
        if turn > 0 and change <= 1e-14 * (1.0 + abs(ax) + abs(ay)):
            break


@inner
def slopes(P: Any, C: Any, B: Any, J: Any, jt: Any) -> None:
    """Analytic ∂(a, ω̇)/∂(v_x, v_y, ω) into J (3, 3) and ∂(a, ω̇)/∂t through the wheel speeds into jt (3)."""
    for r in range(3):
        jt[r] = 0.0
        for k in range(3):
            J[r, k] = 0.0
    for i in range(int(P[_COUNT])):
        q = _H + i * _W
        gx, gy, fx, fy = P[q + _GX], P[q + _GY], P[q + _FX], P[q + _FY]
        ax, ay, n = P[q + _AX], P[q + _AY], C[i, LOAD]
        ww, wt = n * C[i, WW] + P[_CW], n * C[i, WT]
        tw, tt = n * C[i, TW], n * C[i, TT] + P[_CT]
        # 2×2 in body axes: K = [g f] [[ww, wt], [tw, tt]] [g f]ᵀ
        ax_, bx_ = ww * gx + wt * fx, tw * gx + tt * fx
        ay_, by_ = ww * gy + wt * fy, tw * gy + tt * fy
        kxx, kxy = gx * ax_ + fx * bx_, gx * ay_ + fx * by_
        kyx, kyy = gy * ax_ + fy * bx_, gy * ay_ + fy * by_
        kxw, kyw = kxy * ax - kxx * ay, kyy * ax - kyx * ay
        J[0, 0] -= kxx
        J[0, 1] -= kxy
        J[0, 2] -= kxw
        J[1, 0] -= kyx
        J[1, 1] -= kyy
        J[1, 2] -= kyw
        J[2, 0] -= ax * kyx - ay * kxx
        J[2, 1] -= ax * kyy - ay * kxy
        J[2, 2] -= ax * kyw - ay * kxw
        r = P[q + _RHO] * C[i, ALPHA]
        x = kxx * r * P[q + _DX] + kxy * r * P[q + _DY]
        y = kyx * r * P[q + _DX] + kyy * r * P[q + _DY]
        jt[0] -= x
        jt[1] -= y
        jt[2] -= ax * y - ay * x
    for k in range(4):
        fx, fy, mz = (J[0, k], J[1, k], J[2, k]) if k < 3 else (jt[0], jt[1], jt[2])
        x = B[INVERSE] * fx + B[INVERSE + 1] * fy
        y = B[INVERSE + 2] * fx + B[INVERSE + 3] * fy
        z = (mz + B[LEVER] * x + B[LEVER + 1] * y) / P[_INERTIA]
        if k < 3:
            J[0, k], J[1, k], J[2, k] = x, y, z
        else:
            jt[0], jt[1], jt[2] = x, y, z
