"""Runs whose wheel speeds answer to load: droop, the torque–speed line, wheel inertia (compiled).

Beside the six states of the body each wheel has its speed ω_i and angle θ_i.  The speed loop asks

    τ ω̇_i = ω_ref,i(t) − droop_i T_i − ω_i,   T_i = −ρ_i F_i·ŝ_i  (torque delivered to the floor)

with ω_ref the command after modulations, gain and delay, and τ the lag, at least :data:`LEAST_LAG_S`
(a droop without lag would be an algebraic loop; so fast a wheel follows within a few milliseconds).
With a wheel inertia J the motor torque T_i + J ω̇_i is cut to the line ± stall (1 ∓ ω/max_speed).
Sector switches are found on the dense output and stepped to; the Jacobian is by differences.
Accelerations asked by the wheels (``ACCELERATION_X`` …) are those of the command.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.sim import layout as at
from slipmargin.sim.body import (
    ALPHA,
    BODY,
    CONTACT,
    FORCE_T,
    FORCE_W,
    LOAD,
    OMEGA,
    PUSH,
    RIGID,
    SLIP_T,
    SLIP_W,
    THETA,
    evaluate,
)
from slipmargin.sim.compiled import fast_unlocked, inner
from slipmargin.sim.linear import back, decompose
from slipmargin.sim.motion import DONE, LOOSER, NOT_FINITE, STUCK, TIPS, TOO_LONG, _lightest, _tell
from slipmargin.sim.rodas import DENSE, GAMMA, MIX, STAGE, TIME, WHEN
from slipmargin.sim.wheels import breakpoints, follow, turn

LEAST_LAG_S = 2e-3
#: A wheel this near an edge counts as past it in the direction it turns [rad]; a step starts with more
#: of it than the search for the next switch uses, so that a switch just reached is not found again.
_NUDGE = 1e-9
_START = 4.0
_H, _W, _COUNT = at.HEAD, at.WHEEL, at.COUNT
_PROBES = 8


@inner
def _wheel_rate(P: Any, i: int, asked: float, C: Any) -> float:
    """ω̇_i for the speed asked, from what ``evaluate`` left in C."""
    q = _H + i * _W
    n = C[i, LOAD]
    along = (n * C[i, FORCE_W] + P[at.VISCOUS_W] * C[i, SLIP_W]) * (
        P[q + at.GRIP_X] * P[q + at.DRIVE_X] + P[q + at.GRIP_Y] * P[q + at.DRIVE_Y]
    )
    along += (n * C[i, FORCE_T] + P[at.VISCOUS_T] * C[i, SLIP_T]) * (
        P[q + at.FREE_X] * P[q + at.DRIVE_X] + P[q + at.FREE_Y] * P[q + at.DRIVE_Y]
    )
    torque = P[q + at.RADIUS] * along
    rate = (asked - P[q + at.DROOP] * torque - C[i, OMEGA]) / max(P[q + at.LAG], LEAST_LAG_S)
    inertia = P[at.WHEEL_INERTIA]
    if inertia > 0.0:
        ratio = C[i, OMEGA] / P[at.MAX_SPEED]
        most, least = P[at.STALL_TORQUE] * (1.0 - ratio), -P[at.STALL_TORQUE] * (1.0 + ratio)
        rate = (min(max(torque + inertia * rate, least), most) - torque) / inertia
    return float(rate)


@inner
def _rates(
    P: Any,
    t: float,
    y: Any,
    coef: Any,
    k0: float,
    pt: Any,
    pw: Any,
    pk: int,
    C: Any,
    B: Any,
    acc: Any,
    out: Any,
) -> None:
    """ẏ of all 6 + 2N states."""
    n = int(P[_COUNT])
    if len(pt) > 0:
        part = min(max((t - pt[pk]) / (pt[pk + 1] - pt[pk]), 0.0), 1.0)
        for r in range(3):
            B[PUSH + r] = pw[pk, r] + part * (pw[pk + 1, r] - pw[pk, r])
    for i in range(n):
        C[i, OMEGA], C[i, THETA] = y[6 + i], y[6 + n + i]
        C[i, ALPHA] = turn(coef[i], 1.0, t - k0)[2]
    evaluate(P, t, y, C, B, acc)
    c, s = math.cos(y[2]), math.sin(y[2])
    out[0], out[1], out[2] = c * y[3] - s * y[4], s * y[3] + c * y[4], y[5]
    out[3], out[4], out[5] = acc[0] + y[5] * y[4], acc[1] - y[5] * y[3], acc[2]
    for i in range(n):
        out[6 + i] = _wheel_rate(P, i, turn(coef[i], 1.0, t - k0)[1], C)
        out[6 + n + i] = y[6 + i]


@inner
def _sector(P: Any, i: int, theta: float, omega: float, nudge: float) -> float:
    """Number of the sector a wheel stands in, odd on rigid material; on an edge the way it turns decides."""
    q = _H + i * _W
    angle, pitch = theta + (nudge if omega >= 0.0 else -nudge), P[q + at.PITCH]
    whole = math.floor(angle / pitch)
    return float(2.0 * whole + (1.0 if angle - whole * pitch >= P[q + at.SWITCH] else 0.0))


@inner
def _at(y: Any, z: Any, K: Any, r: int, x: float) -> float:
    """Dense output of state r at the share x of a step from y to z."""
    c3, c4 = 0.0, 0.0
    for j in range(5):
        c3 += DENSE[0, j] * K[j, r]
        c4 += DENSE[1, j] * K[j, r]
    return float(y[r] * (1.0 - x) + x * (z[r] + (1.0 - x) * (c3 + x * c4)))


@inner
def _first_switch(P: Any, y: Any, z: Any, K: Any) -> float:
    """Share of the step at which the first wheel changes sector; 2 where none does."""
    n, found = int(P[_COUNT]), 2.0
    for i in range(n):
        here = _sector(P, i, y[6 + n + i], y[6 + i], _START * _NUDGE)
        low = 0.0
        for probe in range(1, _PROBES + 1):
            high = probe / _PROBES
            if low >= found:
                break
            if _sector(P, i, _at(y, z, K, 6 + n + i, high), _at(y, z, K, 6 + i, high), _NUDGE) != here:
                for _ in range(60):
                    mid = 0.5 * (low + high)
                    if _sector(P, i, _at(y, z, K, 6 + n + i, mid), _at(y, z, K, 6 + i, mid), _NUDGE) != here:
                        high = mid
                    else:
                        low = mid
                found = min(found, high)
                break
            low = high
    return found


@inner
def _step(
    P: Any,
    t: float,
    h: float,
    y: Any,
    f: Any,
    ft: Any,
    coef: Any,
    k0: float,
    pt: Any,
    pw: Any,
    pk: int,
    C: Any,
    B: Any,
    acc: Any,
    A: Any,
    pivots: Any,
    rhs: Any,
    rate: Any,
    z: Any,
    K: Any,
    rtol: float,
    atol: float,
) -> float:
    """One RODAS step from y into z with stages K; the error in units of the tolerance."""
    m = len(y)
    for stage in range(6):
        for r in range(m):
            z[r], rhs[r] = y[r], f[r] if stage == 0 else 0.0
            for j in range(stage):
                z[r] += STAGE[stage, j] * K[j, r]
                rhs[r] += MIX[stage, j] * K[j, r] / h
        if stage > 0:
            _rates(P, t + WHEN[stage] * h, z, coef, k0, pt, pw, pk, C, B, acc, rate)
            for r in range(m):
                rhs[r] += rate[r]
        for r in range(m):
            rhs[r] += TIME[stage] * h * ft[r]
        back(A, pivots, m, rhs, K[stage])
    error = 0.0
    for r in range(m):
        z[r] += K[5, r]
        scale = atol + rtol * max(abs(y[r]), abs(z[r]))
        loose = LOOSER if 3 <= r < 6 else (LOOSER / P[_H + at.RADIUS] if r >= 6 else 1.0)
        error += (K[5, r] / (loose * scale)) ** 2
    return math.sqrt(error / m)


@fast_unlocked
def run_motor(
    P: Any,
    knots: Any,
    coef: Any,
    spin: Any,
    pt: Any,
    pw: Any,
    times: Any,
    y0: Any,
    rtol: float,
    atol: float,
    max_steps: int,
    Y: Any,
    tell: bool,
    told: Any,
    info: Any,
) -> None:
    """As :func:`slipmargin.sim.motion.run`, with the wheels as states; the signal is always a command."""
    n = int(P[_COUNT])
    m = 6 + 2 * n
    Q = P.copy()  # the command without lag and without sectors, both of which are states here
    for i in range(n):
        Q[_H + i * _W + at.LAG] = 0.0
        Q[_H + i * _W + at.SWITCH] = 0.0
    knots, coef = follow(Q, knots, coef, spin)
    stops, _ = breakpoints(Q, knots, coef, pt)
    C, B, acc = np.zeros((n, CONTACT)), np.zeros(BODY), np.zeros(3)
    A, pivots, K = np.empty((m, m)), np.zeros(m, dtype=np.int64), np.empty((6, m))
    y, z, f, ft, rhs, rate = np.zeros(m), np.empty(m), np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    J = np.empty((m, m))
    for r in range(6):
        y[r] = y0[r]
    for i in range(n):
        y[6 + i], y[6 + n + i] = spin[i], coef[0, i, 0]
    status, steps, rejected, out, piece, pk, total = DONE, 0, 0, 0, 0, 0, len(times)
    t, h = stops[0], 1e-4
    for seg in range(len(stops) - 1):
        stop = stops[seg + 1]
        mid = 0.5 * (t + stop)
        while piece < len(knots) - 2 and knots[piece + 1] <= mid:
            piece += 1
        while pk < len(pt) - 2 and pt[pk + 1] <= mid:
            pk += 1
        c, k0 = coef[piece], knots[piece]
        fresh = True
        while t < stop and out < total:
            if fresh:
                for i in range(n):
                    number = _sector(P, i, y[6 + n + i], y[6 + i], _START * _NUDGE)
                    C[i, RIGID] = number - 2.0 * math.floor(0.5 * number)
                _rates(P, t, y, c, k0, pt, pw, pk, C, B, acc, f)
                if P[at.LOAD_FOLLOWS] > 0 and _lightest(C) < 0.0:
                    status = TIPS
                    break
                while out < total and times[out] <= t:
                    _tell(P, y, C, Y, told, out, tell)
                    out += 1
                for k in range(m):
                    keep = y[k]
                    y[k] = keep + (1e-9 if k >= 3 else 1e-7)
                    d = y[k] - keep
                    _rates(P, t, y, c, k0, pt, pw, pk, C, B, acc, rate)
                    y[k] = keep
                    for r in range(m):
                        J[r, k] = (rate[r] - f[r]) / d
                _rates(P, t + 1e-7, y, c, k0, pt, pw, pk, C, B, acc, rate)
                for r in range(m):
                    ft[r] = (rate[r] - f[r]) / 1e-7
                fresh = False
            step = stop - t if stop - t < 1.01 * h else h
            if steps + rejected >= max_steps or t + step <= t:
                status = TOO_LONG if steps + rejected >= max_steps else STUCK
                break
            error = 1e300
            for again in range(2):  # a second time, shorter, where a wheel changes its sector on the way
                for r in range(m):
                    for k in range(m):
                        A[r, k] = -J[r, k]
                    A[r, r] += 1.0 / (GAMMA * step)
                decompose(A, pivots, m)
                error = _step(
                    P, t, step, y, f, ft, c, k0, pt, pw, pk, C, B, acc, A, pivots, rhs, rate, z, K, rtol, atol
                )
                if again == 1 or not error <= 1.0:
                    break
                share = _first_switch(P, y, z, K)
                if share > 1.0 or share * step < 1e-13:
                    break
                step *= share
            if not error <= 1.0:
                rejected += 1
                h = step * (max(1.0 / 6.0, 0.9 * error**-0.25) if error < 1e30 else 0.1)
                if h < 1e-14:
                    status = STUCK if error < 1e30 else NOT_FINITE
                    break
                continue
            steps += 1
            while out < total and times[out] < t + step:
                x = (times[out] - t) / step
                for r in range(m):
                    rhs[r] = _at(y, z, K, r, x)
                if tell:
                    _rates(P, times[out], rhs, c, k0, pt, pw, pk, C, B, acc, rate)
                _tell(P, rhs, C, Y, told, out, tell)
                out += 1
            t = stop if step == stop - t else t + step
            for r in range(m):
                y[r] = z[r]
            grow = min(5.0, 0.9 * error**-0.25) if error > 1e-4 else 5.0
            h = max(h, grow * step) if step < h else grow * step
            fresh = True
        if status != DONE:
            break
    if status == DONE and out < total:
        _rates(P, t, y, coef[len(coef) - 1], knots[len(knots) - 2], pt, pw, pk, C, B, acc, f)
    for k in range(out, total):
        _tell(P, y, C, Y, told, k, tell)
        if status != DONE:
            Y[k, 3], Y[k, 4], Y[k, 5] = 0.0, 0.0, 0.0
            if tell:
                for i in range(n):
                    for r in range(1, told.shape[2]):
                        told[k, i, r] = 0.0
    info[0], info[1], info[2], info[3], info[4] = status, t, steps, rejected, len(stops)
