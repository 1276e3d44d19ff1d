"""One run from start to end: adaptive steps from breakpoint to breakpoint (compiled).

States are X, Y, φ, v_x, v_y, ω and, where wheels are driven through their motors, the N wheel speeds and
the N wheel angles; otherwise the wheels' motion is known in time.  Sectors of known wheels change at
breakpoints (:mod:`slipmargin.sim.wheels`); those of driven wheels are found on the dense output.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics import sectors
from slipmargin.physics.compiled import inner, kernel, twin
from slipmargin.sim import layout as at
from slipmargin.sim.body import (
    ALPHA,
    BODY,
    CONTACT,
    FORCE_T,
    FORCE_W,
    K_T,
    K_W,
    LOAD,
    MU_T,
    MU_W,
    OMEGA,
    PUSH,
    RIGID,
    SLIP_T,
    SLIP_W,
    THETA,
    _to_floor,
    evaluate,
    slopes,
    wheel_rate,
)
from slipmargin.sim.rodas import GAMMA, MIX, STAGE, TIME, WHEN, dense, factor, solve
from slipmargin.sim.wheels import turn

_H, _W, _COUNT, _LAG, _PITCH, _SHARE = at.HEAD, at.WHEEL, at.COUNT, at.LAG, at.PITCH, at.RIGID_SHARE
_CW, _CT, _DRIVEN = at.VISCOUS_W, at.VISCOUS_T, at.DRIVEN
_on_rigid = twin(sectors.on_rigid)

#: How a run ended.
DONE, TIPS, NOT_FINITE, STUCK, TOO_LONG = range(5)
#: Columns of what is told of each wheel: angle, slip (2), force (2), load, coefficients (2), slopes (2).
TOLD = 10
#: Entries of a run's task: state at the start (6), relative and absolute error, most steps; and of what
#: comes back in their place: status, time reached, steps taken and rejected.
START, RTOL, ATOL, MOST, TASK = 0, 6, 7, 8, 9
#: Velocities may err by this many times the tolerance of poses: friction damps them within milliseconds.
LOOSER = 10.0
#: A driven wheel this near an edge of a sector counts as past it in the direction it turns [rad]; a step
#: starts with more of it than the search for the next edge uses, so that an edge is not found twice.
_NUDGE = 1e-9
_START = 4.0
_PROBES = 8


@inner
def rates(
    P: Any, t: float, y: Any, coef: Any, knot: float, push: Any, k: int, C: Any, B: Any, acc: Any, out: Any
) -> None:
    """ẏ of all states into ``out``; coef (N, 5) is the wheels' piece since ``knot``, push[k:k+2] the push."""
    n, driven = int(P[_COUNT]), P[_DRIVEN] > 0.0
    for i in range(n):
        C[i, THETA], C[i, OMEGA], C[i, ALPHA] = turn(coef[i], P[_H + i * _W + _LAG], t - knot)
    if driven:
        for i in range(n):
            out[6 + i], C[i, OMEGA], C[i, THETA] = C[i, OMEGA], y[6 + i], y[6 + n + i]
            out[6 + n + i] = y[6 + i]
    if len(push) > 0:
        part = min(max((t - push[k, 0]) / (push[k + 1, 0] - push[k, 0]), 0.0), 1.0)
        for r in range(4):
            B[PUSH + r] = push[k, 1 + r] + part * (push[k + 1, 1 + r] - push[k, 1 + r])
    evaluate(P, t, y, C, B, acc)
    out[0], out[1] = _to_floor(y[2], y[3], y[4])
    out[2], out[5] = y[5], acc[2]
    out[3], out[4] = acc[0] + y[5] * y[4], acc[1] - y[5] * y[3]
    if driven:
        for i in range(n):
            out[6 + i] = wheel_rate(P, i, out[6 + i], C[i, ALPHA], C)


@inner
def _sector(P: Any, i: int, theta: float, omega: float, nudge: float) -> float:
    """Number of the sector a wheel stands in, odd on rigid material; on an edge the way it turns decides."""
    q = _H + i * _W
    angle = theta + (nudge if omega >= 0.0 else -nudge)
    number = 2.0 * math.floor(angle / P[q + _PITCH])
    return float(number + (1.0 if _on_rigid(angle, P[q + _PITCH], P[q + _SHARE]) else 0.0))


@inner
def _first_switch(P: Any, y: Any, z: Any, K: Any) -> float:
    """Share of the step at which the first driven wheel changes sector; 2 where none does."""
    n, found = int(P[_COUNT]), 2.0
    for i in range(n):
        share = P[_H + i * _W + _SHARE]
        if share <= 0.0 or share >= 1.0:
            continue
        here = _sector(P, i, y[6 + n + i], y[6 + i], _START * _NUDGE)
        low, high, halving = 0.0, 1.0 / _PROBES, 0
        while high <= 1.0 and low < found and halving < 60:
            theta, omega = dense(y, z, K, 6 + n + i, high), dense(y, z, K, 6 + i, high)
            if _sector(P, i, theta, omega, _NUDGE) != here:  # between low and high: halve
                found, halving = min(found, high), halving + 1
                high = 0.5 * (low + high)
            elif halving > 0:
                low, halving = high, halving + 1
                high = 0.5 * (low + found)
            else:
                low, high = high, high + 1.0 / _PROBES
    return found


@inner
def _tell(P: Any, y: Any, C: Any, out: Any) -> None:
    """A row of the output: six states, then what is known of each wheel where the row has room for it."""
    for r in range(6):
        out[r] = y[r]
    if len(out) > 6:
        for i in range(int(P[_COUNT])):
            q, n = 6 + i * TOLD, C[i, LOAD]
            out[q], out[q + 1], out[q + 2] = C[i, THETA], C[i, SLIP_W], C[i, SLIP_T]
            out[q + 3] = -n * C[i, FORCE_W] - P[_CW] * C[i, SLIP_W]
            out[q + 4] = -n * C[i, FORCE_T] - P[_CT] * C[i, SLIP_T]
            out[q + 5], out[q + 6], out[q + 7] = n, C[i, MU_W], C[i, MU_T]
            out[q + 8], out[q + 9] = C[i, K_W], C[i, K_T]


def workspace(wheels: int, driven: bool) -> tuple[Array, ...]:
    """Tables, all zero, that a run works on: wheels, vectors, stages, Jacobian, matrix, columns of probes."""
    speeds = wheels if driven else 0
    m = 6 + 2 * speeds
    shapes = (
        (wheels, CONTACT),
        (9, max(m, BODY)),
        (6, m),
        (3 + speeds, m + 1),
        (3 + speeds, 3 + speeds),
        (m + 1, 1),
    )
    return tuple(np.zeros(shape) for shape in shapes)


@kernel
def run(
    P: Any, knots: Any, coef: Any, stops: Any, push: Any, times: Any, task: Any, tables: Any, out: Any
) -> None:
    """Integrate one run and write a row at each of ``times``.

    P packed model; knots (K+1), coef (K, N, 5) pieces of what the wheels do or, where they are driven, are
    asked for; stops (M, 2) breakpoints and whether they are hard (:func:`slipmargin.sim.wheels.breakpoints`);
    push (Q, 5) time, force on the centre of mass in the floor frame and its height (Q = 0: none);
    task (:data:`TASK`); tables that it works on (:func:`workspace`); out (T, 6) receives states,
    out (T, 6 + 10 N) also the wheels.
    """
    n, driven, pushed = int(P[_COUNT]), P[_DRIVEN] > 0.0, len(push) > 0
    speeds = n if driven else 0
    m = 6 + 2 * speeds
    C, S, K, J, M, columns = tables
    y, z, f, rhs, rate, B, acc, away, E = S[0], S[1], S[2], S[3], S[4], S[5], S[6], S[7], S[8]
    rtol, atol, most = task[RTOL], task[ATOL], task[MOST]
    for r in range(6):
        y[r] = task[START + r]
    for i in range(speeds):
        y[6 + i], y[6 + n + i] = task[TASK + i], coef[0, i, 0]
    # Columns of the Jacobian that are taken by differences: the place, the heading, velocities, time.
    heading = P[at.BY_HEADING] > 0.0 or pushed
    by_velocity = P[at.BY_VELOCITY] > 0.0 or P[at.LOAD_ITERATES] > 0.0
    by_time = P[at.BY_TIME] > 0.0 or by_velocity or pushed or driven
    by_angle = driven and P[at.BY_ANGLE] > 0.0
    pose = heading or P[at.BY_POSITION] > 0.0 or by_angle
    probes = 0
    for k in range(m + 1):
        velocity = 3 <= k < 6 + speeds
        asked = (k == 2 and heading) or (k < 2 and P[at.BY_POSITION] > 0.0) or (velocity and by_velocity)
        if asked or (k == m and by_time) or (6 + speeds <= k < m and by_angle):
            columns[probes, 0] = k
            probes += 1
    status, steps, rejected, piece, pk, row, total = DONE, 0, 0, 0, 0, 0, len(times)
    last, least = len(knots) - 2, -1e-9 * P[at.SHARE]
    h, restart, t = 1e-4, 1e-4, stops[0, 0]
    for seg in range(len(stops) - 1):
        stop = stops[seg + 1, 0]
        mid = 0.5 * (t + stop)
        while piece < last and knots[piece + 1] <= mid:
            piece += 1
        while pk < len(push) - 2 and push[pk + 1, 0] <= mid:
            pk += 1
        c, k0 = coef[piece], knots[piece]
        for i in range(n):
            angle = turn(c[i], P[_H + i * _W + _LAG], mid - k0)[0]
            C[i, RIGID] = _sector(P, i, angle, 1.0, 0.0) % 2.0
        first, fresh = stops[seg, 1] > 0.0, True
        if first:
            h = min(h, restart)
        while t < stop and row < total:
            if fresh:
                for i in range(speeds):
                    C[i, RIGID] = _sector(P, i, y[6 + n + i], y[6 + i], _START * _NUDGE) % 2.0
                rates(P, t, y, c, k0, push, pk, C, B, acc, f)
                low = C[0, LOAD]
                for i in range(1, n):
                    low = min(low, C[i, LOAD])
                if low < least:
                    status = TIPS
                    break
                while row < total and times[row] <= t:
                    _tell(P, y, C, out[row])
                    row += 1
                slopes(P, y, C, B, J, speeds)
                for probe in range(probes):
                    k = int(columns[probe, 0])
                    for r in range(m):
                        z[r] = y[r]
                    d = 1e-7 if k == m or k < 3 or k >= 6 + speeds else 1e-9
                    if k < m:
                        z[k] = y[k] + d
                        d = z[k] - y[k]
                    rates(P, t + d if k == m else t, z, c, k0, push, pk, C, B, away, rate)
                    for r in range(3 + speeds):
                        J[r, k] = (rate[3 + r] - f[3 + r]) / d
                fresh = False
            step = stop - t if stop - t < 1.01 * h else h
            if steps + rejected >= most or t + step <= t:
                status = TOO_LONG if steps + rejected >= most else STUCK
                break
            error = 1e300
            for again in range(
                2
            ):  # a second time, shorter, where a driven wheel changes its sector on the way
                gh, per = GAMMA * step, 1.0 / step
                factor(J, y, gh, M, E)
                for stage in range(6):
                    x = t + WHEN[stage] * step
                    if stage > 0:
                        for r in range(m):
                            total_a, total_m = y[r], 0.0
                            for j in range(stage):
                                total_a += STAGE[stage, j] * K[j, r]
                                total_m += MIX[stage, j] * K[j, r]
                            z[r], rhs[r] = total_a, total_m * per
                        rates(P, x, z, c, k0, push, pk, C, B, away, rate)
                        for r in range(m):
                            rhs[r] += rate[r]
                    else:
                        for r in range(m):
                            rhs[r] = f[r]
                    for r in range(3 + speeds):
                        rhs[3 + r] += TIME[stage] * step * J[r, m]
                    solve(J, M, E, gh, pose, rhs, K[stage])
                error = 0.0
                for r in range(m):
                    z[r] += K[5, r]
                    scale = atol + rtol * max(abs(y[r]), abs(z[r]))
                    loose = 1.0 if r < 3 else (LOOSER if r < 6 else LOOSER / P[_H + at.RADIUS])
                    miss = K[5, r] / (loose * scale)
                    error += miss * miss
                error = math.sqrt(error / m)
                if again == 1 or speeds == 0 or not error <= 1.0:
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
            grow = min(5.0, 0.9 * error**-0.25) if error > 1e-4 else 5.0
            while row < total and times[row] < t + step:
                for r in range(m):
                    rhs[r] = dense(y, z, K, r, (times[row] - t) / step)
                if out.shape[1] > 6:
                    rates(P, times[row], rhs, c, k0, push, pk, C, B, away, rate)
                _tell(P, rhs, C, out[row])
                row += 1
            t = stop if step == stop - t else t + step
            for r in range(m):
                y[r] = z[r]
            if first and step == h:
                restart, first = grow * step, False
            # A step cut short at a breakpoint says nothing against the longer one.
            h = max(h, grow * step) if step < h else grow * step
            fresh = True
        if status != DONE:
            break
    if status == DONE and row < total:
        rates(P, t, y, coef[last], knots[last], push, pk, C, B, acc, f)
    for k in range(row, total):  # the end; after a stop everything stays as it was, at rest
        _tell(P, y, C, out[k])
        if status != DONE:
            for r in range(3, out.shape[1]):
                if r < 6 or (r - 6) % TOLD > 0:
                    out[k, r] = 0.0
    task[0], task[1], task[2], task[3] = status, t, steps, rejected
