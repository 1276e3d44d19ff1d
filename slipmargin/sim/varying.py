"""Friction that varies and forces that come on top, at one instant (compiled).

What each term of a packed model (:mod:`slipmargin.sim.layout`) depends on is read off the state here: y as
in :mod:`slipmargin.sim.body`, the wheels from the contact table C, the push from the body table B.
"""

from __future__ import annotations

import math
from typing import Any

from slipmargin.physics import contact, frames, relief, terms
from slipmargin.physics.compiled import inner, spliced, twin
from slipmargin.physics.constants import CRAWL_M_S, SLOW_M_S, SLOW_RAD_S
from slipmargin.sim import layout as at
from slipmargin.sim.columns import (
    ALPHA,
    DRAGS,
    FACTORS,
    FORCE_T,
    FORCE_W,
    LIFT,
    LOAD,
    OMEGA,
    PASS_T,
    PASS_W,
    PUSH,
    RISE_M,
    RISE_X,
    RISE_Y,
    SLIP_T,
    SLIP_W,
    THETA,
    TILTING,
    TT,
    WRENCH,
    WT,
    WW,
)

_TERM, _FORCE, _COM_X, _COM_Y = at.TERM, at.FORCE, at.COM_X, at.COM_Y
_MODS, _MODS_AT, _FORCES, _FORCES_AT = at.MODULATIONS, at.MODULATIONS_AT, at.FORCES, at.FORCES_AT
_SHARE, _AX, _AY, _GX, _GY, _FX = at.SHARE, at.ARM_X, at.ARM_Y, at.GRIP_X, at.GRIP_Y, at.FREE_X
_FY, _RHO, _PLACE, _NSX = at.FREE_Y, at.RADIUS, at.PLACE, at.NO_SLIP_X
_RELIEFS, _RELIEFS_AT, _RELIEF = at.RELIEFS, at.RELIEFS_AT, at.RELIEF
_SHAPE, _COUPLING = at.SHAPE, at.COUPLING

_BOX = contact.BOX
_basis, _basis_slope = twin(terms.basis_function), twin(terms.basis_slope)
_first_of_two, _HATS = twin(terms.first_of_two), terms.HATS
_place_variable = twin(terms.place_variable)
_slope = twin(relief.slope)
_to_body, _to_floor, _velocity_at = twin(frames.to_body), twin(frames.to_floor), twin(frames.velocity_at)


@spliced
def series(
    P: Any, place: int, count: int, basis: int, a: float, b: float, v: float, rises: bool = False
) -> float:
    """Σ_j c_j φ_j(v) with the coefficients standing at ``P[place:]``; with ``rises`` its slope over v."""
    total = 0.0
    first, beyond = _not_zero(basis, count, a, b, v)
    for j in range(first, beyond):
        part = _basis_slope(basis, j, count, a, b, v) if rises else _basis(basis, j, count, a, b, v)
        total += P[place + j] * part
    return total


@spliced
def _not_zero(basis: int, count: int, a: float, b: float, v: float) -> tuple[int, int]:
    """Which functions of a family are to be looked at: from the first to before the second number."""
    if basis != _HATS:
        return 0, count
    first = _first_of_two(count, a, b, v)
    return first, min(first + 2, count)


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


@spliced
def _modulation(P: Any, q: int, n: int) -> tuple[int, int, int, int, float, float, int]:
    """Variable, basis, target, count, two constants and first coefficient's place of the modulation at q."""
    return int(P[q]), int(P[q + 1]), int(P[q + 2]), int(P[q + 3]), P[q + 4], P[q + 5], q + _TERM + n


@spliced
def _of_hub(code: int, w: Any, vx: float, vy: float, slip: float) -> tuple[float, float, float, float]:
    """A variable of a hub's velocity, what it changes by with that, and with the ``slip`` along ĝ."""
    if code == 21:  # the tread passes with the floor but for the slip: rollers turn with the floor
        vx, vy = vx - slip * w[_GX], vy - slip * w[_GY]
    v = math.sqrt(vx * vx + vy * vy)
    if v == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    by_x, by_y = vx / v, vy / v
    return v, by_x, by_y, -(by_x * w[_GX] + by_y * w[_GY]) if code == 21 else 0.0


@spliced
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
    if code == 20 or code == 21:
        return float(_of_hub(code, w, vx, vy, P[m + _PLACE] * c[SLIP_W])[0])
    hub = math.sqrt(vx * vx + vy * vy)
    roll = max(hub, abs(w[_RHO] * c[OMEGA]))
    if code == 6:
        return float(roll)
    return float(abs(u) / (roll + CRAWL_M_S))


@inner
def factors(P: Any, W: Any, i: int, t: float, y: Any, C: Any, B: Any) -> None:
    """What all modulations make of (μ_W, μ_T, k_W, k_T) of wheel i, into B[FACTORS:FACTORS + 4].

    The next two: relative slopes of μ_W over u_W and μ_T over u_T that come from the slip speed.
    """
    for r in range(6):
        B[FACTORS + r] = 1.0 if r < 4 else 0.0
    n = len(W)
    q = int(P[_MODS_AT])
    for _ in range(int(P[_MODS])):
        m, weight = q, P[q + _TERM + i]
        code, basis, target, count, a, b, place = _modulation(P, q, n)
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
                    slope = series(P, place, count, basis, a, b, v, True) * weight / first
                    u = C[i, SLIP_W + side]
                    B[FACTORS + 4 + side] += slope if u > 0.0 else (-slope if u < 0.0 else 0.0)
            B[kind + side] *= first


@inner
def passing(P: Any, W: Any, i: int, y: Any, C: Any) -> None:
    """What f_W, f_T of wheel i change by with the hub's velocity and u_W, into C[i, PASS_W:], C[i, PASS_T:].

    Only by friction over a variable that is one of the hub's velocity; after the wheel's force is known.
    f k-fold as steep is f at k-fold slip, so that k ∂f/∂k = u_W ∂f/∂u_W + u_T ∂f/∂u_T.
    """
    w, c, n = W[i], C[i], len(W)
    for r in range(3):
        c[PASS_W + r], c[PASS_T + r] = 0.0, 0.0
    coupled = P[_SHAPE] != _BOX and P[_COUPLING] > 0.0
    uw, ut = c[SLIP_W], c[SLIP_T]
    vx, vy = _velocity_at(y[3], y[4], y[5], w[_AX], w[_AY])
    q = int(P[_MODS_AT])
    for _ in range(int(P[_MODS])):
        m, weight = q, P[q + _TERM + i]
        code, basis, target, count, a, b, place = _modulation(P, q, n)
        q = place + count
        if weight == 0.0 or not (code == 20 or code == 21):
            continue
        v, by_x, by_y, by_slip = _of_hub(code, w, vx, vy, P[m + _PLACE] * uw)
        first = 1.0 + weight * series(P, place, count, basis, a, b, v)
        if first <= 0.0:
            continue
        along, across = c[FORCE_W], c[FORCE_T]
        if target >= 3:
            along, across = uw * c[WW] + ut * c[WT], uw * c[WT] + ut * c[TT]
        if target == 1 or target == 5:
            along = 0.0
        if target == 0 or (target == 4 and not coupled) or (target == 5 and coupled):
            across = 0.0
        slope = series(P, place, count, basis, a, b, v, True) * weight / first
        by_slip *= P[m + _PLACE]
        for at_first, change in ((PASS_W, along * slope), (PASS_T, across * slope)):
            c[at_first] += change * by_x
            c[at_first + 1] += change * by_y
            c[at_first + 2] += change * by_slip


@inner
def climb(P: Any, W: Any, y: Any, C: Any) -> None:
    """The slope of the floor under each wheel, in body axes, and its moment about the centre of mass."""
    for i in range(len(W)):
        w = W[i]
        px, py = _to_floor(y[2], w[_AX], w[_AY])
        x, z = 0.0, 0.0
        q = int(P[_RELIEFS_AT])
        for _ in range(int(P[_RELIEFS])):
            place = P[q + 4], P[q + 5]
            along, across = _slope(int(P[q]), P[q + 1], P[q + 2], P[q + 3], place, y[0] + px, y[1] + py)
            x += along
            z += across
            q += _RELIEF
        x, z = _to_body(y[2], x, z)
        C[i, RISE_X], C[i, RISE_Y], C[i, RISE_M] = x, z, w[_AX] * z - w[_AY] * x


@inner
def _own_wrench(P: Any, q: int, v: float, rises: bool) -> tuple[float, float, float]:
    """The wrench of the force term at q in its own frame; with ``rises`` its slope over v."""
    basis, count, a, b, place = int(P[q + 1]), int(P[q + 3]), P[q + 4], P[q + 5], q + _FORCE
    x, z, m = 0.0, 0.0, 0.0
    for j in range(count):
        part = _basis_slope(basis, j, count, a, b, v) if rises else _basis(basis, j, count, a, b, v)
        x += P[place + j] * part
        z += P[place + count + j] * part
        m += P[place + 2 * count + j] * part
    return x, z, m


@inner
def external(P: Any, W: Any, t: float, y: Any, C: Any, B: Any) -> None:
    """Push and force terms as one wrench in the body frame, its moment h F and lift."""
    fx, fy = B[PUSH], B[PUSH + 1]
    if fx != 0.0 or fy != 0.0:
        fx, fy = _to_body(y[2], fx, fy)
    mz, lift = B[PUSH + 2], 0.0
    hx, hy = B[PUSH + 3] * fx, B[PUSH + 3] * fy
    q = int(P[_FORCES_AT])
    for _ in range(int(P[_FORCES])):
        frame, count = int(P[q + 2]), int(P[q + 3])
        v = _body_variable(P, W, int(P[q]), t, y, C)
        x, z, m = _own_wrench(P, q, v, False)
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
        q += _FORCE + 3 * count
    B[WRENCH], B[WRENCH + 1], B[WRENCH + 2] = fx, fy, mz
    B[TILTING], B[TILTING + 1], B[LIFT] = hx, hy, lift


@inner
def dragging(P: Any, W: Any, t: float, y: Any, C: Any, B: Any) -> None:
    """What external forces and their moment h F change by with the body's velocity, into B[DRAGS:].

    Only where variable or frame is one of that velocity; frames are those of :func:`external`.
    """
    for r in range(15):
        B[DRAGS + r] = 0.0
    origin_x, origin_y = -P[_COM_X], -P[_COM_Y]
    ox, oy = _velocity_at(y[3], y[4], y[5], origin_x, origin_y)
    q = int(P[_FORCES_AT])
    for _ in range(int(P[_FORCES])):
        at_term, code, frame = q, int(P[q]), int(P[q + 2])
        q += _FORCE + 3 * int(P[q + 3])
        moves = code >= 7 and code <= 10
        if not moves and frame < 2:
            continue
        v = _body_variable(P, W, code, t, y, C)
        x, z, m = _own_wrench(P, at_term, v, False)
        dx, dz, dm = _own_wrench(P, at_term, v, True) if moves else (0.0, 0.0, 0.0)
        px, py = (P[at_term + 8], P[at_term + 9]) if frame == 3 else (origin_x, origin_y)
        vx, vy = _velocity_at(y[3], y[4], y[5], px, py)
        size = math.sqrt(vx * vx + vy * vy + SLOW_M_S * SLOW_M_S)
        spin = math.sqrt(y[5] * y[5] + SLOW_RAD_S * SLOW_RAD_S)
        c, s = vx / size, vy / size
        for k in range(3):
            gx, gy = _velocity_at(1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2), origin_x, origin_y)
            by = 1.0 * (k == 2)  # what v changes by
            if code == 7:
                by = gx
            elif code == 8:
                by = gy
            elif code == 10:
                by = (ox * gx + oy * gy) / v if v > 0.0 else 0.0
            fx, fz, fm = dx * by, dz * by, dm * by
            if frame == 1:
                fx, fz = _to_body(y[2], fx, fz)
            elif frame >= 2:
                gx, gy = _velocity_at(1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2), px, py)
                along = c * gx + s * gy
                dc, ds = (gx - c * along) / size, (gy - s * along) / size
                fx, fz = -c * fx - s * fz - dc * x - ds * z, -s * fx + c * fz - ds * x + dc * z
                fm *= -y[5] / spin
                if k == 2:
                    fm -= m * SLOW_RAD_S * SLOW_RAD_S / (spin * spin * spin)
                if frame == 3:
                    fm += px * fz - py * fx
            place, height = DRAGS + 5 * k, P[at_term + 6]
            B[place] += fx
            B[place + 1] += fz
            B[place + 2] += fm
            B[place + 3] += height * fx
            B[place + 4] += height * fz
