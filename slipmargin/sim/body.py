"""Forces and accelerations of the whole robot at one instant (compiled).

The state begins with (X, Y, φ, v_x, v_y, ω): centre of mass in the floor frame, velocity of the centre
of mass in the body frame.  Equations of motion about the centre of mass (eqs 4–7 for any wheels):

    m (v̇ + ω × v) = F,   I ω̇ = M,   F = −Σ N_i (f_W,i ĝ_i + f_T,i f̂_i + ∇h_i) + external forces

with the slope ∇h_i of the floor under wheel i (physics/relief.py).
Loads are N_i = S_i + P_i·a with a = F/m and S_i = rest_i (1 − lift/Σ rest) + tilt_i·Σ h_k F_k
(physics/loads.py), so they are solved with the motion: with φ_i = f_W ĝ_i + f_T f̂_i + ∇h_i,
(m 1 + Σ φ_i P_iᵀ) a = −Σ S_i φ_i + external forces: two linear equations.  Where a wheel
lifts, S and P are those of :mod:`slipmargin.sim.lifting`.
"""

from __future__ import annotations

import math
from typing import Any

from slipmargin.physics import contact as contacts, frames, relief, terms
from slipmargin.physics.compiled import inner, spliced, twin
from slipmargin.physics.constants import CRAWL_M_S, SLOW_M_S, SLOW_RAD_S
from slipmargin.sim import columns as col, layout as at
from slipmargin.sim.lifting import hang, lifts

ALPHA, BY_SPEED, BY_TORQUE, FACTORS, FORCE_T = (
    col.ALPHA,
    col.BY_SPEED,
    col.BY_TORQUE,
    col.FACTORS,
    col.FORCE_T,
)
FORCE_W, HILL, INVERSE, K_T, K_W = col.FORCE_W, col.HILL, col.INVERSE, col.K_T, col.K_W
LEVER, LIFT, LOAD, MU_T, MU_W = col.LEVER, col.LIFT, col.LOAD, col.MU_T, col.MU_W
OMEGA, PUSH, RIGID, RISE_T, RISE_W = col.OMEGA, col.PUSH, col.RIGID, col.RISE_T, col.RISE_W
ROUND, SHARED_X, SHARED_Y, SLIP_T, SLIP_W = col.ROUND, col.SHARED_X, col.SHARED_Y, col.SLIP_T, col.SLIP_W
STILL, THETA, TILTING, TT, UP = col.STILL, col.THETA, col.TILTING, col.TT, col.UP
WRENCH, WT, WW = col.WRENCH, col.WT, col.WW
_TERM, _FORCE, _MASS, _INERTIA = at.TERM, at.FORCE, at.MASS, at.INERTIA
_COM_X, _COM_Y, _LAG, _DROOP = at.COM_X, at.COM_Y, at.LAG, at.DROOP
_STALL, _SLOWING, _WHEEL_INERTIA = at.STALL_TORQUE, at.SLOWING, at.INERTIA_OF_WHEEL
_LAW, _K, _SHAPE, _COUPLING = at.LAW, at.STEEPNESS, at.SHAPE, at.COUPLING
_CW, _CT, _LIFTED = at.VISCOUS_W, at.VISCOUS_T, at.LIFTED
_MODS, _MODS_AT, _FORCES, _FORCES_AT = at.MODULATIONS, at.MODULATIONS_AT, at.FORCES, at.FORCES_AT
_FOLLOWS, _ITERATES, _SHARE = at.LOAD_FOLLOWS, at.LOAD_ITERATES, at.SHARE
_AX, _AY, _GX, _GY, _GM, _GR = at.ARM_X, at.ARM_Y, at.GRIP_X, at.GRIP_Y, at.GRIP_MOMENT, at.GRIP_ROLLS
_FX, _FY, _FM, _FR = at.FREE_X, at.FREE_Y, at.FREE_MOMENT, at.FREE_ROLLS
_RHO, _REST, _LX, _LY, _MU = at.RADIUS, at.REST, at.LOAD_X, at.LOAD_Y, at.ROLLER_W
_PLACE = at.PLACE
_TX, _TY, _NSX = at.TILT_X, at.TILT_Y, at.NO_SLIP_X
_OUT_COS, _OUT_SIN = at.RUNOUT_COS, at.RUNOUT_SIN
_RELIEFS, _RELIEFS_AT, _RELIEF = at.RELIEFS, at.RELIEFS_AT, at.RELIEF

_contact, _basis, _basis_slope = twin(contacts.contact), twin(terms.basis_function), twin(terms.basis_slope)
_place_variable = twin(terms.place_variable)
_rise, _beyond = twin(relief.rise), twin(relief.beyond)
_to_body, _to_floor, _velocity_at = twin(frames.to_body), twin(frames.to_floor), twin(frames.velocity_at)


@inner
def series(P: Any, place: int, count: int, basis: int, a: float, b: float, v: float) -> float:
    """Σ_j c_j φ_j(v) with the coefficients standing at ``P[place:]``."""
    total = 0.0
    for j in range(count):
        total += P[place + j] * _basis(basis, j, count, a, b, v)
    return total


@inner
def _body_variable(P: Any, W: Any, code: int, t: float, y: Any, C: Any) -> float:
    w, phi = y[5], y[2]
    vx, vy = _velocity_at(y[3], y[4], w, -P[_COM_X], -P[_COM_Y])
    value = t
    if code == 0:
        value = 1.0
    elif code == 7:
        value = vx
    elif code == 8:
        value = vy
    elif code == 9:
        value = w
    elif code == 10:
        value = math.hypot(vx, vy)
    elif code <= 13:  # no-slip acceleration that the wheels ask for
        value = 0.0
        for i in range(len(W)):
            value += W[i, _NSX + code - 11] * C[i, ALPHA]
    elif code == 14:
        value = phi
    elif code <= 16:
        cx, cy = _to_floor(phi, P[_COM_X], P[_COM_Y])
        value = y[0] - cx if code == 15 else y[1] - cy
    return value


@inner
def _wheel_variable(P: Any, w: Any, c: Any, code: int, direction: int, m: int, y: Any) -> float:
    if code == 22 or code == 23:  # measured from the place of the modulation at m
        px, py = _to_floor(y[2], w[_AX], w[_AY])
        m += _PLACE
        return float(_place_variable(code == 23, P[m], P[m + 1], P[m + 2], y[0] + px, y[1] + py))
    u = c[SLIP_W + direction]
    if code == 1:
        return float(c[THETA])
    if code == 2:
        return float(c[LOAD] / P[_SHARE] - 1.0)
    if code == 3:
        return abs(float(u))
    if code == 5:
        return math.atan2(abs(c[SLIP_T]), abs(c[SLIP_W]))
    if code == 18:
        d = _FX if direction == 1 else _GX
        return float(y[2] + math.atan2(w[d + 1], w[d]) + (math.pi if u < 0.0 else 0.0))
    if code == 24:
        uw, ut = c[SLIP_W], c[SLIP_T]
        return float(y[2] + math.atan2(uw * w[_GY] + ut * w[_FY], uw * w[_GX] + ut * w[_FX]))
    vx, vy = _velocity_at(y[3], y[4], y[5], w[_AX], w[_AY])
    hub = math.hypot(vx, vy)
    if code == 20:
        return hub
    if code == 21:
        reach = math.hypot(w[_AX], w[_AY])
        out = y[3] * w[_AX] + y[4] * w[_AY]
        return float(out / (reach * (hub + CRAWL_M_S))) if reach > 0.0 else 0.0
    roll = max(hub, abs(w[_RHO] * c[OMEGA]))
    if code == 6:
        return float(roll)
    return float(abs(u) / (roll + CRAWL_M_S))


@inner
def _factors(P: Any, W: Any, i: int, t: float, y: Any, C: Any, B: Any) -> None:
    """What all modulations make of (μ_W, μ_T, k_W, k_T) of wheel i, into B[FACTORS:FACTORS + 4].

    The next two: relative slopes of μ_W over u_W and μ_T over u_T that come from the slip speed.
    """
    for r in range(6):
        B[FACTORS + r] = 1.0 if r < 4 else 0.0
    n = len(W)
    q = int(P[_MODS_AT])
    for _ in range(int(P[_MODS])):
        m = q
        code, basis = int(P[q]), int(P[q + 1])
        target, count = int(P[q + 2]), int(P[q + 3])
        a, b, weight = P[q + 4], P[q + 5], P[q + _TERM + i]
        place = q + _TERM + n
        q = place + count
        if weight == 0.0:
            continue
        own = 1 <= code <= 6 or code == 18 or code >= 20
        sided = code == 3 or code == 4 or code == 18
        kind = FACTORS + 2 if target >= 3 else FACTORS
        first = 1.0
        for side in range(2):
            if target in (1 - side, 5 - side):
                continue
            if side == 0 or sided or target in (1, 5):
                v = (
                    _wheel_variable(P, W[i], C[i], code, side, m, y)
                    if own
                    else _body_variable(P, W, code, t, y, C)
                )
                first = max(0.0, 1.0 + weight * series(P, place, count, basis, a, b, v))
                if code == 3 and first > 0.0:
                    slope = 0.0
                    for j in range(count):
                        slope += P[place + j] * _basis_slope(basis, j, count, a, b, v)
                    u = C[i, SLIP_W + side]
                    slope *= weight / first
                    B[FACTORS + 4 + side] += slope if u > 0.0 else (-slope if u < 0.0 else 0.0)
            B[kind + side] *= first


@inner
def _climb(P: Any, W: Any, y: Any, B: Any) -> None:
    """What the slope of the floor under the wheels adds to the wrench, and to its change with acceleration.

    The loads without acceleration push, into B[WRENCH]; those that follow it, row by row, into B[HILL].
    """
    left = 1.0 - B[LIFT] / P[_LIFTED]
    for r in range(6):
        B[HILL + r] = 0.0
    for i in range(len(W)):
        w = W[i]
        px, py = _to_floor(y[2], w[_AX], w[_AY])
        x, z = 0.0, 0.0
        q = int(P[_RELIEFS_AT])
        for _ in range(int(P[_RELIEFS])):
            away = P[q + 5]
            d = _beyond(P[q + 4], away, y[0] + px, y[1] + py)
            along = _rise(int(P[q]), P[q + 1], P[q + 2], P[q + 3], d)
            x += along * math.cos(away)
            z += along * math.sin(away)
            q += _RELIEF
        x, z = _to_body(y[2], x, z)
        m = w[_AX] * z - w[_AY] * x
        still = left * w[_REST] + w[_TX] * B[TILTING] + w[_TY] * B[TILTING + 1]
        B[WRENCH] -= still * x
        B[WRENCH + 1] -= still * z
        B[WRENCH + 2] -= still * m
        for k in range(2):
            more = w[_LX + k]
            B[HILL + k] += x * more
            B[HILL + 2 + k] += z * more
            B[HILL + 4 + k] -= m * more


@inner
def _external(P: Any, W: Any, t: float, y: Any, C: Any, B: Any) -> None:
    """Push, force terms and slopes as one wrench in the body frame at the centre of mass, moment and lift."""
    fx, fy = B[PUSH], B[PUSH + 1]
    if fx != 0.0 or fy != 0.0:
        fx, fy = _to_body(y[2], fx, fy)
    mz, lift = B[PUSH + 2], 0.0
    hx, hy = B[PUSH + 3] * fx, B[PUSH + 3] * fy
    q = int(P[_FORCES_AT])
    for _ in range(int(P[_FORCES])):
        code, basis = int(P[q]), int(P[q + 1])
        frame, count = int(P[q + 2]), int(P[q + 3])
        a, b, place = P[q + 4], P[q + 5], q + _FORCE
        v = _body_variable(P, W, code, t, y, C)
        x, z, m = 0.0, 0.0, 0.0
        for j in range(count):
            part = _basis(basis, j, count, a, b, v)
            x += P[place + j] * part
            z += P[place + count + j] * part
            m += P[place + 2 * count + j] * part
        if frame == 1:
            x, z = _to_body(y[2], x, z)
        elif frame >= 2:
            px, py = (-P[_COM_X], -P[_COM_Y]) if frame == 2 else (P[q + 8], P[q + 9])
            vx, vy = _velocity_at(y[3], y[4], y[5], px, py)
            size = math.sqrt(vx * vx + vy * vy + SLOW_M_S * SLOW_M_S)
            c, s = vx / size, vy / size
            x, z = -c * x - s * z, -s * x + c * z
            m = -m * y[5] / math.sqrt(y[5] * y[5] + SLOW_RAD_S * SLOW_RAD_S)
            if frame == 3:
                m += px * z - py * x
        fx += x
        fy += z
        mz += m
        hx += P[q + 6] * x
        hy += P[q + 6] * z
        lift += P[q + 7]
        q = place + 3 * count
    B[WRENCH], B[WRENCH + 1], B[WRENCH + 2] = fx, fy, mz
    B[TILTING], B[TILTING + 1], B[LIFT] = hx, hy, lift
    if P[_RELIEFS] > 0.0:
        _climb(P, W, y, B)


@spliced
def evaluate(P: Any, W: Any, t: float, y: Any, C: Any, B: Any, acc: Any) -> None:
    """Acceleration acc (3) = (a, ω̇) in body axes; fills the rest of C and B.

    Reads ω, θ, ω̇ and the sector of each wheel from C and the push from B.
    """
    _external(P, W, t, y, C, B)
    vx, vy, vw = y[3], y[4], y[5]
    left, hx, hy = 1.0 - B[LIFT] / P[_LIFTED], B[TILTING], B[TILTING + 1]
    law, shape, coupling = int(P[_LAW]), int(P[_SHAPE]), P[_COUPLING]
    k, cw, ct = P[_K], P[_CW], P[_CT]
    modulated, follows, mass = P[_MODS] > 0.0, P[_FOLLOWS] > 0.0, P[_MASS]
    for turn in range(60):
        fx, fy, mz = B[WRENCH], B[WRENCH + 1], B[WRENCH + 2]
        mxx, mxy, lx = mass + B[HILL], B[HILL + 1], B[HILL + 4]
        myx, myy, ly = B[HILL + 2], mass + B[HILL + 3], B[HILL + 5]
        for i in range(len(W)):
            w, c = W[i], C[i]
            gx, gy, gm = w[_GX], w[_GY], w[_GM]
            ex, ey, em = w[_FX], w[_FY], w[_FM]
            if turn == 0:
                c[ROUND] = 1.0
                if w[_OUT_COS] != 0.0 or w[_OUT_SIN] != 0.0:
                    c[ROUND] += w[_OUT_COS] * math.cos(c[THETA]) + w[_OUT_SIN] * math.sin(c[THETA])
            rolls = c[OMEGA] * c[ROUND]
            uw = gx * vx + gy * vy + gm * vw + w[_GR] * rolls
            ut = ex * vx + ey * vy + em * vw + w[_FR] * rolls
            still = left * w[_REST] + w[_TX] * hx + w[_TY] * hy
            c[SLIP_W], c[SLIP_T], c[STILL] = uw, ut, still
            if turn == 0:
                c[LOAD] = still
            z = _MU + 2 * int(c[RIGID])
            mw, mt = w[z], w[z + 1]
            kw, kt = k, k
            if modulated:
                _factors(P, W, i, t, y, C, B)
                mw, mt = mw * B[FACTORS], mt * B[FACTORS + 1]
                kw, kt = kw * B[FACTORS + 2], kt * B[FACTORS + 3]
            f, g, ww, wt, _, tt = _contact(law, shape, coupling, uw, ut, mw, mt, kw, kt)
            if modulated:
                ww, tt = ww + f * B[FACTORS + 4], tt + g * B[FACTORS + 5]
            c[FORCE_W], c[FORCE_T] = f, g
            c[WW], c[WT], c[TT] = ww, wt, tt
            c[MU_W], c[MU_T] = mw, mt
            c[K_W], c[K_T] = kw, kt
            a, b = still * f + cw * uw, still * g + ct * ut
            fx -= a * gx + b * ex
            fy -= a * gy + b * ey
            mz -= a * gm + b * em
            if follows:
                px, py = w[_LX], w[_LY]
                x, v, m = f * gx + g * ex, f * gy + g * ey, f * gm + g * em
                mxx, mxy = mxx + x * px, mxy + x * py
                myx, myy = myx + v * px, myy + v * py
                lx, ly = lx - m * px, ly - m * py
        det = 1.0 / (mxx * myy - mxy * myx)
        ax, ay = (myy * fx - mxy * fy) * det, (mxx * fy - myx * fx) * det
        B[INVERSE], B[INVERSE + 1] = myy * det, -mxy * det
        B[INVERSE + 2], B[INVERSE + 3] = -myx * det, mxx * det
        B[LEVER], B[LEVER + 1] = lx, ly
        before_x, before_y = acc[0], acc[1]
        acc[0], acc[1], acc[2] = ax, ay, (mz + lx * ax + ly * ay) / P[_INERTIA]
        if follows:
            for i in range(len(W)):
                C[i, LOAD] = C[i, STILL] + W[i, _LX] * ax + W[i, _LY] * ay
        B[UP] = 0.0
        if lifts(P, C):
            hang(P, W, C, B, acc)
        if P[_ITERATES] == 0.0 and not (modulated and B[UP] > 0.0):
            break
        change = abs(acc[0] - before_x) + abs(acc[1] - before_y)
        if turn > 0 and change <= 1e-14 * (1.0 + abs(ax) + abs(ay)):
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
    stall = P[_STALL]
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
def slopes(P: Any, W: Any, y: Any, C: Any, B: Any, J: Any, speeds: int) -> None:
    """Analytic derivatives of the body's (and driven wheels') accelerations, after :func:`evaluate`.

    Into J (3 or 3 + N rows): column 3 + k over velocity k (v_x, v_y, ω and, where there are ``speeds`` = N,
    the wheel speeds); without speeds the last column over time, through prescribed wheel speeds.
    """
    for k in range(3 + max(speeds, 1)):
        fx, fy, mz = 0.0, 0.0, 0.0
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
            c[RISE_W], c[RISE_T] = a, b
            fx -= a * row[_GX] + b * row[_FX]
            fy -= a * row[_GY] + b * row[_FY]
            mz -= a * row[_GM] + b * row[_FM]
        ax, ay = B[INVERSE] * fx + B[INVERSE + 1] * fy, B[INVERSE + 2] * fx + B[INVERSE + 3] * fy
        column = 3 + k if k < 3 or speeds > 0 else J.shape[1] - 1
        J[0, column], J[1, column] = ax, ay
        J[2, column] = (mz + B[LEVER] * ax + B[LEVER + 1] * ay) / P[_INERTIA]
        for i in range(speeds):  # torques follow the loads, which follow the body
            row, c = W[i], C[i]
            px, py = row[_LX], row[_LY]
            if B[UP] > 0.0:
                px, py = c[SHARED_X], c[SHARED_Y]
            load = px * ax + py * ay
            torque = (c[RISE_W] + c[FORCE_W] * load) * row[_GR]
            torque += (c[RISE_T] + c[FORCE_T] * load) * row[_FR]
            torque *= c[ROUND]
            J[3 + i, column] = c[BY_TORQUE] * torque + (c[BY_SPEED] if k - 3 == i else 0.0)
    # v̇ = a − ω × v
    J[0, 4] += y[5]
    J[0, 5] += y[4]
    J[1, 3] -= y[5]
    J[1, 5] -= y[3]
