"""One run from start to end: adaptive RODAS steps from breakpoint to breakpoint (compiled)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from slipmargin.sim import layout as at
from slipmargin.sim.body import evaluate
from slipmargin.sim.rodas import (
    _A21, _A31, _A32, _A41, _A42, _A43, _A51, _A52, _A53, _A54,
    _C21, _C31, _C32, _C41, _C42, _C43, _C51, _C52, _C53, _C54, _C61, _C62, _C63, _C64, _C65,
    _D1, _D2, _D3, _D4, _D21, _D22, _D23, _D24, _D25, _D31, _D32, _D33, _D34, _D35, _T2, _T3, _T4,
    GAMMA, derivative, factor, jacobian, solve,
)  # fmt: skip
from slipmargin.sim.wheels import breakpoints, follow, turn

_H, _W, _COUNT = at.HEAD, at.WHEEL, at.COUNT
_BY_POSE, _BY_TIME, _LAGGED, _FOLLOWS = at.BY_POSE, at.BY_TIME, at.LAGGED, at.LOAD_FOLLOWS
_LAG, _PITCH, _SWITCH = at.LAG, at.PITCH, at.SWITCH

#: How a run ended.
DONE, TIPS, NOT_FINITE, STUCK, TOO_LONG = range(5)


@njit(cache=True)
def _wheels(P: Any, coef: Any, x: float, om: Any, th: Any, al: Any) -> None:
    for i in range(int(P[_COUNT])):
        th[i], om[i], al[i] = turn(coef[i], P[_H + i * _W + _LAG], x)


@njit(cache=True)
def _push(pt: Any, pw: Any, t: float, k: int, push: Any) -> None:
    part = min(max((t - pt[k]) / (pt[k + 1] - pt[k]), 0.0), 1.0)
    for r in range(3):
        push[r] = pw[k, r] + part * (pw[k + 1, r] - pw[k, r])


@njit(cache=True)
def _sectors(P: Any, th: Any, rigid: Any) -> None:
    for i in range(int(P[_COUNT])):
        q = _H + i * _W
        pitch = P[q + _PITCH]
        rigid[i] = 1 if th[i] - math.floor(th[i] / pitch) * pitch >= P[q + _SWITCH] else 0


@njit(cache=True)
def run(P: Any, knots: Any, coef: Any, spin: Any, commanded: bool, pt: Any, pw: Any, times: Any, y0: Any,
        rtol: float, atol: float, max_steps: int, Y: Any, tell: bool, TH: Any, SLIP: Any, FORCE: Any, LOAD: Any,
        info: Any) -> None:
    """Integrate one run and write the state at ``times``.

    P packed model; knots (K+1), coef (K, N, 5) wheel pieces, ``spin`` (N) their speed before;
    pt (Q), pw (Q, 3) force on the centre of mass in the floor frame (Q = 0: none); y0 (6) state;
    Y (T, 6) receives states, and where ``tell`` TH (T, N), SLIP, FORCE (T, N, 2), LOAD (T, N) too;
    info (5): status, stop time, steps, rejected, breakpoints.
    """
    n = int(P[_COUNT])
    if commanded and P[_LAGGED] > 0:
        knots, coef = follow(P, knots, coef, spin)
    stops = breakpoints(P, knots, coef, pt)
    om, th, al = np.empty(n), np.empty(n), np.empty(n)
    rigid = np.zeros(n, dtype=np.int8)
    U, F, L, D = np.empty((n, 2)), np.empty((n, 2)), np.empty(n), np.empty((n, 4))
    acc, frame, push = np.zeros(3), np.empty(6), np.zeros(3)
    J, jt, Jp, M, E = np.empty((3, 3)), np.empty(3), np.zeros((3, 3)), np.empty((3, 3)), np.empty(2)
    y, z, dy, rhs, trial, away = np.empty(6), np.empty(6), np.empty(6), np.empty(6), np.empty(6), np.empty(3)
    K, ft, c3, c4 = np.empty((6, 6)), np.zeros(6), np.empty(6), np.empty(6)
    y[:] = y0
    pushed = len(pt) > 0
    pose, by_time = P[_BY_POSE] > 0 or pushed, P[_BY_TIME] > 0 or pushed
    status, steps, rejected, out, piece, pk = DONE, 0, 0, 0, 0, 0
    last = len(knots) - 2
    h, end = 1e-4, times[len(times) - 1]
    t = stops[0]
    for seg in range(len(stops) - 1):
        stop = stops[seg + 1]
        mid = 0.5 * (t + stop)
        while piece < last and knots[piece + 1] <= mid:
            piece += 1
        if pushed:
            while pk < len(pt) - 2 and pt[pk + 1] <= mid:
                pk += 1
        c, k0 = coef[piece], knots[piece]
        _wheels(P, c, mid - k0, om, th, al)
        _sectors(P, th, rigid)
        fresh = True
        while t < stop and out < len(times):
            if steps + rejected >= max_steps:
                status = TOO_LONG
                break
            if fresh:
                _wheels(P, c, t - k0, om, th, al)
                if pushed:
                    _push(pt, pw, t, pk, push)
                evaluate(P, t, y, om, th, al, rigid, push, U, F, L, D, acc, frame)
                if P[_FOLLOWS] > 0 and L.min() < 0.0:
                    status = TIPS
                    break
                if tell:
                    while out < len(times) and times[out] <= t:
                        Y[out] = y
                        TH[out], SLIP[out], LOAD[out] = th, U, L
                        for i in range(n):
                            FORCE[out, i, 0] = -L[i] * F[i, 0] - P[at.VISCOUS_W] * U[i, 0]
                            FORCE[out, i, 1] = -L[i] * F[i, 1] - P[at.VISCOUS_T] * U[i, 1]
                        out += 1
                else:
                    while out < len(times) and times[out] <= t:
                        Y[out] = y
                        out += 1
                derivative(y, acc, dy)
                jacobian(P, t, y, om, th, al, rigid, push, U, F, L, D, acc, frame, J, jt, Jp, trial, away)
                if by_time:
                    d = 1e-7
                    _wheels(P, c, t + d - k0, om, th, al)
                    if pushed:
                        _push(pt, pw, t + d, pk, push)
                    evaluate(P, t + d, y, om, th, al, rigid, push, U, F, L, D, away, frame)
                    for r in range(3):
                        jt[r] = (away[r] - acc[r]) / d
                ft[3], ft[4], ft[5] = jt[0], jt[1], jt[2]
                fresh = False
            step = min(h, stop - t)
            if stop - t < 1.01 * step:
                step = stop - t
            if t + step <= t:
                status = STUCK
                break
            gh = GAMMA * step
            factor(J, Jp, y, gh, pose, M, E)
            cp, sp = math.cos(y[2]), math.sin(y[2])
            for r in range(6):
                rhs[r] = dy[r] + step * _D1 * ft[r]
            solve(M, E, Jp, cp, sp, gh, pose, rhs, K[0])
            for stage in range(1, 6):
                if stage == 1:
                    x, d = t + _T2 * step, step * _D2
                    for r in range(6):
                        z[r] = y[r] + _A21 * K[0, r]
                        rhs[r] = _C21 * K[0, r] / step
                elif stage == 2:
                    x, d = t + _T3 * step, step * _D3
                    for r in range(6):
                        z[r] = y[r] + _A31 * K[0, r] + _A32 * K[1, r]
                        rhs[r] = (_C31 * K[0, r] + _C32 * K[1, r]) / step
                elif stage == 3:
                    x, d = t + _T4 * step, step * _D4
                    for r in range(6):
                        z[r] = y[r] + _A41 * K[0, r] + _A42 * K[1, r] + _A43 * K[2, r]
                        rhs[r] = (_C41 * K[0, r] + _C42 * K[1, r] + _C43 * K[2, r]) / step
                elif stage == 4:
                    x, d = t + step, 0.0
                    for r in range(6):
                        z[r] = y[r] + _A51 * K[0, r] + _A52 * K[1, r] + _A53 * K[2, r] + _A54 * K[3, r]
                        rhs[r] = (_C51 * K[0, r] + _C52 * K[1, r] + _C53 * K[2, r] + _C54 * K[3, r]) / step
                else:
                    for r in range(6):
                        z[r] += K[4, r]
                        rhs[r] = (_C61 * K[0, r] + _C62 * K[1, r] + _C63 * K[2, r] + _C64 * K[3, r]
                                  + _C65 * K[4, r]) / step
                if stage < 5:
                    _wheels(P, c, x - k0, om, th, al)
                    if pushed:
                        _push(pt, pw, x, pk, push)
                evaluate(P, x, z, om, th, al, rigid, push, U, F, L, D, away, frame)
                derivative(z, away, trial)
                for r in range(6):
                    rhs[r] += trial[r] + d * ft[r]
                solve(M, E, Jp, cp, sp, gh, pose, rhs, K[stage])
            error = 0.0
            for r in range(6):
                z[r] += K[5, r]
                scale = atol + rtol * max(abs(y[r]), abs(z[r]))
                error += (K[5, r] / scale) ** 2
            error = math.sqrt(error / 6.0)
            if not error < 1e30:
                rejected += 1
                h = 0.1 * step
                if h < 1e-14:
                    status = NOT_FINITE
                    break
                continue
            ratio = max(1.0 / 6.0, min(5.0, error**0.25 / 0.9))
            if error > 1.0:
                rejected += 1
                h = step / ratio
                if h < 1e-14:
                    status = STUCK
                    break
                continue
            steps += 1
            if out < len(times) and times[out] <= t + step and not tell:
                for r in range(6):
                    c3[r] = (_D21 * K[0, r] + _D22 * K[1, r] + _D23 * K[2, r] + _D24 * K[3, r] + _D25 * K[4, r])
                    c4[r] = (_D31 * K[0, r] + _D32 * K[1, r] + _D33 * K[2, r] + _D34 * K[3, r] + _D35 * K[4, r])
                while out < len(times) and times[out] <= t + step:
                    x = (times[out] - t) / step
                    for r in range(6):
                        Y[out, r] = y[r] * (1.0 - x) + x * (z[r] + (1.0 - x) * (c3[r] + x * c4[r]))
                    out += 1
            elif tell:
                while out < len(times) and times[out] < t + step:
                    x = (times[out] - t) / step
                    for r in range(6):
                        c3[r] = (_D21 * K[0, r] + _D22 * K[1, r] + _D23 * K[2, r] + _D24 * K[3, r]
                                 + _D25 * K[4, r])
                        c4[r] = (_D31 * K[0, r] + _D32 * K[1, r] + _D33 * K[2, r] + _D34 * K[3, r]
                                 + _D35 * K[4, r])
                        trial[r] = y[r] * (1.0 - x) + x * (z[r] + (1.0 - x) * (c3[r] + x * c4[r]))
                    _wheels(P, c, times[out] - k0, om, th, al)
                    if pushed:
                        _push(pt, pw, times[out], pk, push)
                    evaluate(P, times[out], trial, om, th, al, rigid, push, U, F, L, D, away, frame)
                    Y[out] = trial
                    TH[out], SLIP[out], LOAD[out] = th, U, L
                    for i in range(n):
                        FORCE[out, i, 0] = -L[i] * F[i, 0] - P[at.VISCOUS_W] * U[i, 0]
                        FORCE[out, i, 1] = -L[i] * F[i, 1] - P[at.VISCOUS_T] * U[i, 1]
                    out += 1
            t = stop if step == stop - t else t + step
            y[:] = z
            # A step cut short at a breakpoint says nothing against the longer one.
            h = max(h, step / ratio) if step < 0.99 * h and ratio < 1.0 else step / ratio
            fresh = True
        if status != DONE:
            break
    if tell and status == DONE and out < len(times):
        _wheels(P, coef[last], t - knots[last], om, th, al)
        if pushed:
            _push(pt, pw, t, pk, push)
        evaluate(P, t, y, om, th, al, rigid, push, U, F, L, D, acc, frame)
        while out < len(times):
            Y[out] = y
            TH[out], SLIP[out], LOAD[out] = th, U, L
            for i in range(n):
                FORCE[out, i, 0] = -L[i] * F[i, 0] - P[at.VISCOUS_W] * U[i, 0]
                FORCE[out, i, 1] = -L[i] * F[i, 1] - P[at.VISCOUS_T] * U[i, 1]
            out += 1
    info[0], info[1], info[2], info[3], info[4] = status, t, steps, rejected, len(stops)
    while out < len(times):  # after a stop everything stays as it was
        Y[out] = y
        Y[out, 3:] = 0.0
        if tell:
            TH[out], SLIP[out], LOAD[out], FORCE[out] = th, 0.0, 0.0, 0.0
        out += 1


@njit(cache=True, nogil=True)
def run_range(low: int, high: int, models: Any, which: Any, signal: Any, knot_at: Any, knots: Any, piece_at: Any,
              coef: Any, spin: Any, commanded: bool, push_at: Any, pt: Any, pw: Any, time_at: Any, times: Any,
              start: Any, rtol: float, atol: float, max_steps: int, Y: Any, tell: bool, TH: Any, SLIP: Any,
              FORCE: Any, LOAD: Any, info: Any) -> None:
    """Runs ``low … high − 1``: run r moves model ``which[r]`` by signal ``signal[r]``."""
    for r in range(low, high):
        s = signal[r]
        P = models[which[r]]
        count = time_at[s + 1] - time_at[s]
        told = r if tell else 0
        run(P, knots[knot_at[s]:knot_at[s + 1]], coef[piece_at[s]:piece_at[s + 1]], spin[s], commanded,
            pt[push_at[s]:push_at[s + 1]], pw[push_at[s]:push_at[s + 1]], times[time_at[s]:time_at[s + 1]],
            start[r], rtol, atol, max_steps, Y[r, :count], tell, TH[told, :count], SLIP[told, :count],
            FORCE[told, :count], LOAD[told, :count], info[r])
        for k in range(count, Y.shape[1]):
            Y[r, k] = Y[r, count - 1]
