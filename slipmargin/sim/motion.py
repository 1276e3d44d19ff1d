"""One run from start to end: adaptive RODAS steps from breakpoint to breakpoint (compiled)."""

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
from slipmargin.sim.rodas import DENSE, GAMMA, MIX, STAGE, TIME, WHEN, derivative, factor, jacobian, solve
from slipmargin.sim.wheels import turn

_H, _W, _COUNT, _LAG, _PITCH, _SWITCH = at.HEAD, at.WHEEL, at.COUNT, at.LAG, at.PITCH, at.SWITCH
_BY_TIME, _FOLLOWS = at.BY_TIME, at.LOAD_FOLLOWS
_CW, _CT = at.VISCOUS_W, at.VISCOUS_T

#: How a run ended.
DONE, TIPS, NOT_FINITE, STUCK, TOO_LONG = range(5)
#: Columns of what is told of each wheel: angle, slip (2), force (2), load.
TOLD = 6
#: Velocities may err by this many times the tolerance of poses: friction damps them within milliseconds.
LOOSER = 10.0


@inner
def _known(P: Any, coef: Any, x: float, pt: Any, pw: Any, t: float, k: int, C: Any, B: Any) -> None:
    """What is known in time alone: wheel motion into C, push into B."""
    for i in range(int(P[_COUNT])):
        C[i, THETA], C[i, OMEGA], C[i, ALPHA] = turn(coef[i], P[_H + i * _W + _LAG], x)
    if len(pt) > 0:
        part = min(max((t - pt[k]) / (pt[k + 1] - pt[k]), 0.0), 1.0)
        for r in range(3):
            B[PUSH + r] = pw[k, r] + part * (pw[k + 1, r] - pw[k, r])


@inner
def _sectors(P: Any, C: Any) -> None:
    for i in range(int(P[_COUNT])):
        q = _H + i * _W
        angle, pitch = C[i, THETA], P[q + _PITCH]
        C[i, RIGID] = 1.0 if angle - math.floor(angle / pitch) * pitch >= P[q + _SWITCH] else 0.0


@inner
def _tell(P: Any, y: Any, C: Any, Y: Any, W: Any, out: int, tell: bool) -> None:
    for r in range(6):
        Y[out, r] = y[r]
    if tell:
        for i in range(int(P[_COUNT])):
            n = C[i, LOAD]
            W[out, i, 0], W[out, i, 1], W[out, i, 2] = C[i, THETA], C[i, SLIP_W], C[i, SLIP_T]
            W[out, i, 3] = -n * C[i, FORCE_W] - P[_CW] * C[i, SLIP_W]
            W[out, i, 4] = -n * C[i, FORCE_T] - P[_CT] * C[i, SLIP_T]
            W[out, i, 5] = n


@inner
def _lightest(C: Any) -> float:
    low = C[0, LOAD]
    for i in range(1, len(C)):
        low = min(low, C[i, LOAD])
    return float(low)


@fast_unlocked
def run(
    P: Any,
    knots: Any,
    coef: Any,
    stops: Any,
    hard: Any,
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
    """Integrate one run and write the state at ``times``.

    P packed model; knots (K+1), coef (K, N, 5) pieces of what the wheels do, ``stops`` and ``hard``
    their breakpoints (:func:`slipmargin.sim.wheels.breakpoints`);
    pt (Q), pw (Q, 3) force on the centre of mass in the floor frame (Q = 0: none); y0 (6) state;
    Y (T, 6) receives states and, where ``tell``, told (T, N, 6) the wheels;
    info (5): status, stop time, steps, rejected, breakpoints.
    """
    n = int(P[_COUNT])
    C, B, acc = np.zeros((n, CONTACT)), np.zeros(BODY), np.zeros(3)
    J, jt, Jp, M, E = np.empty((3, 3)), np.empty(3), np.zeros((3, 3)), np.empty((3, 3)), np.empty(4)
    y, z, dy, rhs, trial, away = np.empty(6), np.empty(6), np.empty(6), np.empty(6), np.empty(6), np.empty(3)
    K, c3, c4 = np.empty((6, 6)), np.empty(6), np.empty(6)
    for r in range(6):
        y[r] = y0[r]
    pushed = len(pt) > 0
    pose = P[at.BY_HEADING] > 0 or P[at.BY_POSITION] > 0 or pushed
    by_time = P[_BY_TIME] > 0 or P[at.BY_VELOCITY] > 0 or P[at.LOAD_ITERATES] > 0 or pushed
    status, steps, rejected, piece, pk, total = DONE, 0, 0, 0, 0, len(times)
    out = total - len(Y)  # 0, as a number that is not a constant: _tell is then compiled once
    last = len(knots) - 2
    h, restart, t = 1e-4, 1e-4, stops[0]
    for seg in range(len(stops) - 1):
        stop = stops[seg + 1]
        mid = 0.5 * (t + stop)
        while piece < last and knots[piece + 1] <= mid:
            piece += 1
        while pk < len(pt) - 2 and pt[pk + 1] <= mid:
            pk += 1
        c, k0 = coef[piece], knots[piece]
        _known(P, c, mid - k0, pt, pw, mid, pk, C, B)
        _sectors(P, C)
        if hard[seg]:
            h = min(h, restart)
        first, fresh = hard[seg], True
        while t < stop and out < total:
            if fresh:
                _known(P, c, t - k0, pt, pw, t, pk, C, B)
                evaluate(P, t, y, C, B, acc)
                if P[_FOLLOWS] > 0 and _lightest(C) < 0.0:
                    status = TIPS
                    break
                while out < total and times[out] <= t:
                    _tell(P, y, C, Y, told, out, tell)
                    out += 1
                derivative(y, acc, dy)
                jacobian(P, t, y, C, B, acc, pose, J, jt, Jp, trial, away)
                if by_time:
                    _known(P, c, t + 1e-7 - k0, pt, pw, t + 1e-7, pk, C, B)
                    evaluate(P, t + 1e-7, y, C, B, away)
                    for r in range(3):
                        jt[r] = (away[r] - acc[r]) / 1e-7
                fresh = False
            step = stop - t if stop - t < 1.01 * h else h
            if steps + rejected >= max_steps or t + step <= t:
                status = TOO_LONG if steps + rejected >= max_steps else STUCK
                break
            gh, per = GAMMA * step, 1.0 / step
            factor(J, Jp, y, gh, pose, M, E)
            for stage in range(6):
                if stage == 0:
                    for r in range(6):
                        rhs[r] = dy[r]
                else:
                    for r in range(6):
                        z[r] = y[r]
                        rhs[r] = 0.0
                    for j in range(stage):
                        a, m = STAGE[stage, j], MIX[stage, j] * per
                        for r in range(6):
                            z[r] += a * K[j, r]
                            rhs[r] += m * K[j, r]
                    x = t + WHEN[stage] * step
                    if stage < 5:
                        _known(P, c, x - k0, pt, pw, x, pk, C, B)
                    evaluate(P, x, z, C, B, away)
                    derivative(z, away, trial)
                    for r in range(6):
                        rhs[r] += trial[r]
                for r in range(3):
                    rhs[3 + r] += TIME[stage] * step * jt[r]
                solve(M, E, Jp, gh, pose, rhs, K, stage)
            error = 0.0
            for r in range(6):
                z[r] += K[5, r]
                scale = atol + rtol * max(abs(y[r]), abs(z[r]))
                miss = K[5, r] / (scale if r < 3 else LOOSER * scale)
                error += miss * miss
            error = math.sqrt(error / 6.0)
            if not error <= 1.0:
                rejected += 1
                h = step * (max(1.0 / 6.0, 0.9 * error**-0.25) if error < 1e30 else 0.1)
                if h < 1e-14:
                    status = STUCK if error < 1e30 else NOT_FINITE
                    break
                continue
            steps += 1
            grow = min(5.0, 0.9 * error**-0.25) if error > 1e-4 else 5.0
            if out < total and times[out] < t + step:
                for r in range(6):
                    c3[r] = 0.0
                    c4[r] = 0.0
                    for j in range(5):
                        c3[r] += DENSE[0, j] * K[j, r]
                        c4[r] += DENSE[1, j] * K[j, r]
                while out < total and times[out] < t + step:
                    x = (times[out] - t) / step
                    for r in range(6):
                        trial[r] = y[r] * (1.0 - x) + x * (z[r] + (1.0 - x) * (c3[r] + x * c4[r]))
                    if tell:
                        _known(P, c, times[out] - k0, pt, pw, times[out], pk, C, B)
                        evaluate(P, times[out], trial, C, B, away)
                    _tell(P, trial, C, Y, told, out, tell)
                    out += 1
            t = stop if step == stop - t else t + step
            for r in range(6):
                y[r] = z[r]
            if first and step == h:
                restart, first = grow * step, False
            # A step cut short at a breakpoint says nothing against the longer one.
            h = max(h, grow * step) if step < h else grow * step
            fresh = True
        if status != DONE:
            break
    if status == DONE and out < total:
        _known(P, coef[last], t - knots[last], pt, pw, t, pk, C, B)
        evaluate(P, t, y, C, B, acc)
    for k in range(out, total):  # the end; after a stop everything stays as it was, at rest
        _tell(P, y, C, Y, told, k, tell)
        if status != DONE:
            Y[k, 3], Y[k, 4], Y[k, 5] = 0.0, 0.0, 0.0
            if tell:
                for i in range(n):
                    for r in range(1, TOLD):
                        told[k, i, r] = 0.0
    info[0], info[1], info[2], info[3], info[4] = status, t, steps, rejected, len(stops)
