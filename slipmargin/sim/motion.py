"""One run from start to end: adaptive steps from breakpoint to breakpoint (compiled).

States are X, Y, φ, v_x, v_y, ω and, where wheels are driven through their motors, the N wheel speeds and
the N wheel angles; otherwise the wheels' motion is known in time.  A step ends where a wheel changes its
sector: known wheels are followed ahead, driven ones on the dense output of a step that was tried.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.physics import frames
from slipmargin.physics.compiled import inner, kernel, spliced, twin
from slipmargin.sim import layout as at
from slipmargin.sim.body import evaluate, slopes, wheel_rate
from slipmargin.sim.columns import (
    AIR,
    ALPHA,
    BODY,
    CONTACT,
    FORCE_T,
    FORCE_W,
    HUNG,
    JAMMED,
    K_T,
    K_W,
    LOAD,
    MU_T,
    MU_W,
    OMEGA,
    PULLED,
    PUSH,
    RESTING,
    RIGID,
    SLIP_T,
    SLIP_W,
    THETA,
    UP,
)
from slipmargin.sim.rodas import GAMMA, TIME, WHEN, begin, bends, dense, end, factor, solve
from slipmargin.sim.stops import AHEAD, SAME_S, first_switch, next_stop, sector
from slipmargin.sim.wheels import turn

_LAG, _RADIUS, _DRIVEN, _LEAST = at.LAG, at.RADIUS, at.DRIVEN, at.SHARE
_CW, _CT = at.VISCOUS_W, at.VISCOUS_T
_to_floor = twin(frames.to_floor)

#: How a run ended.
DONE, TIPS, NOT_FINITE, STUCK, TOO_LONG, JAMS = range(6)
#: Columns of what is told of each wheel: angle, slip (2), force (2), load, coefficients (2), slopes (2).
TOLD = 10
#: Entries of a run's task: state at the start (6), relative and absolute error, most steps, the pull that
#: a wheel may bear before the run ends [m g/N], speeds of the wheels (N); and of what comes back in their
#: place: status, time reached, steps taken and rejected, when a wheel first hung in the air (−1: never);
#: and for how long each did (N) [s].
START, RTOL, ATOL, MOST, PULL, TASK = 0, 6, 7, 8, 9, 10
#: Entries of a step that was taken: when it began and how long it is [s], the wheels' piece and the push's;
#: the six states at its start and its end, what its dense output needs beside them (6, 6); 1 for each wheel
#: that stood on rigid material (N).
WHEN_S, LONG_S, PIECE, PUSHED, FROM, TO, BEND, TWIST, TRACE = 0, 1, 2, 3, 4, 10, 16, 22, 28


@spliced
def rates(
    P: Any,
    W: Any,
    t: float,
    y: Any,
    coef: Any,
    knot: float,
    push: Any,
    k: int,
    C: Any,
    B: Any,
    acc: Any,
    out: Any,
) -> None:
    """ẏ of all states into ``out``; coef (N, 5) is the wheels' piece since ``knot``, push[k:k+2] the push."""
    n, driven = len(W), P[_DRIVEN] > 0.0
    for i in range(n):
        c = C[i]
        c[THETA], c[OMEGA], c[ALPHA] = turn(coef[i], W[i, _LAG], t - knot)
        if driven:
            out[6 + i], c[OMEGA], c[THETA] = c[OMEGA], y[6 + i], y[6 + n + i]
            out[6 + n + i] = y[6 + i]
    if len(push) > 0:
        part = min(max((t - push[k, 0]) / (push[k + 1, 0] - push[k, 0]), 0.0), 1.0)
        for r in range(4):
            B[PUSH + r] = push[k, 1 + r] + part * (push[k + 1, 1 + r] - push[k, 1 + r])
    evaluate(P, W, t, y, C, B, acc)
    out[0], out[1] = _to_floor(y[2], y[3], y[4])
    out[2], out[5] = y[5], acc[2]
    out[3], out[4] = acc[0] + y[5] * y[4], acc[1] - y[5] * y[3]
    if driven:
        for i in range(n):
            out[6 + i] = wheel_rate(P, W[i], C[i], out[6 + i], C[i, ALPHA])


@inner
def rates_called(*of: Any) -> None:
    """:func:`rates`, not spliced, where it is asked once a step: the kernel compiles in half the time."""
    rates(*of)


@inner
def jacobian(
    P: Any,
    W: Any,
    t: float,
    y: Any,
    coef: Any,
    knot: float,
    push: Any,
    pk: int,
    C: Any,
    B: Any,
    columns: Any,
    f: Any,
    z: Any,
    rate: Any,
    acc: Any,
    J: Any,
) -> None:
    """Derivatives of the accelerations into J, after :func:`rates` left f; overwrites z, rate, acc."""
    speeds, m = len(J) - 3, J.shape[1] - 1
    slopes(P, W, t, y, C, B, J, speeds)
    for k in columns:
        for r in range(m):
            z[r] = y[r]
        d = 1e-9 if k >= 3 and k < 6 + speeds else 1e-7
        at_time = t
        if k < m:
            z[k] = y[k] + d
            d = z[k] - y[k]
        else:
            at_time = t + d
        rates_called(P, W, at_time, z, coef, knot, push, pk, C, B, acc, rate)
        for r in range(3 + speeds):
            J[r, k] = (rate[3 + r] - f[3 + r]) / d


@spliced
def tell(P: Any, y: Any, C: Any, out: Any) -> None:
    """A row of the output: six states, then what is known of each wheel where the row has room for it."""
    for r in range(6):
        out[r] = y[r]
    if len(out) > 6:
        for i in range(len(C)):
            c, q, n = C[i], 6 + i * TOLD, C[i, LOAD]
            out[q], out[q + 1], out[q + 2] = c[THETA], c[SLIP_W], c[SLIP_T]
            out[q + 3] = -n * c[FORCE_W] - P[_CW] * c[SLIP_W]
            out[q + 4] = -n * c[FORCE_T] - P[_CT] * c[SLIP_T]
            out[q + 5], out[q + 6], out[q + 7] = n, c[MU_W], c[MU_T]
            out[q + 8], out[q + 9] = c[K_W], c[K_T]


def workspace(wheels: int, driven: bool) -> tuple[Array, ...]:
    """Tables, all zero, that a run works on: wheels, vectors, stages, Jacobian, matrix."""
    speeds = wheels if driven else 0
    m = 6 + 2 * speeds
    shapes = (
        (wheels, CONTACT),
        (9, max(m, BODY)),
        (6, m),
        (3 + speeds, m + 1),
        (3 + speeds, 3 + speeds),
    )
    return tuple(np.zeros(shape) for shape in shapes)


def probed(P: Array, pushed: bool) -> NDArray[np.int64]:
    """Columns of the Jacobian that are taken by differences: the pose's, time's, the velocities'."""
    wheels, driven, iterates = int(P[at.COUNT]), P[_DRIVEN] > 0.0, P[at.BY_LOAD] * P[at.LOAD_FOLLOWS] > 0.0
    first = 6 + (wheels if driven else 0)
    m = first + (wheels if driven else 0)
    by_velocity = iterates or P[at.BY_VELOCITY] > 0.0
    columns: list[int] = []
    if P[at.BY_POSITION] > 0.0:
        columns += [0, 1]
    if pushed or P[at.BY_HEADING] > 0.0:
        columns += [2]
    if driven and P[at.BY_ANGLE] > 0.0:
        columns += range(first, m)
    if pushed or driven or by_velocity or P[at.BY_TIME] > 0.0:
        columns += [m]
    if by_velocity:
        columns += range(3, first)
    return np.array(columns, dtype=np.int64)


@kernel
def run(
    P: Any,
    W: Any,
    knots: Any,
    coef: Any,
    push: Any,
    edges: Any,
    columns: Any,
    place: Any,
    times: Any,
    task: Any,
    tables: Any,
    trace: Any,
    out: Any,
) -> None:
    """Integrate one run and write a row at each of ``times``.

    P packed model and W (N, WHEEL) its wheels; knots (K+1), coef (K, N, 5) pieces of what the wheels do or,
    where they are driven, are asked for; push (Q, 5) time, force on the centre of mass in the floor frame and
    its height (Q = 0: none); edges (E) instants at which a force or friction jumps or kinks; columns
    (:func:`probed`); place (:func:`next_stop`); task (:data:`TASK`); tables that it works on
    (:func:`workspace`); trace (0 or most steps, TRACE + N) receives the steps taken; out (T, 6) receives
    states, out (T, 6 + 10 N) also the wheels.
    """
    n, driven = len(W), P[_DRIVEN] > 0.0
    speeds = n if driven else 0
    moving = 6 + speeds
    m = moving + speeds
    C, S, K, J, M = tables
    y, z, f = S[0], S[1], S[2]
    rhs, rate, B = S[3], S[4], S[5]
    acc, away, E = S[6], S[7], S[8]
    rtol, atol, most = task[RTOL], task[ATOL], task[MOST]
    for r in range(6):
        y[r] = task[START + r]
    for i in range(speeds):
        y[6 + i], y[moving + i] = task[TASK + i], coef[0, i, 0]
    for i in range(n):
        C[i, HUNG], task[TASK + i] = 0.0, 0.0
    held, hung, lifted, since = task[PULL] == np.inf, False, -1.0, knots[0]
    pose = len(columns) > 0 and (columns[0] < 3 or (columns[0] >= moving and columns[0] < m))
    status, steps, rejected = DONE, 0, 0
    row, total, pk = 0, len(times), 0
    least, h, restart, t = -task[PULL] * P[_LEAST], 1e-4, 1e-4, knots[0]
    stop, until, first, fresh, switched = t, knots[len(knots) - 1], True, True, True
    c, k0 = coef[0], t
    while True:
        if t >= stop and t < until:  # a new stretch: to where something next jumps or a wheel switches
            B[RESTING] = 0.0
            stop, jumps = next_stop(W, knots, coef, push, edges, t, place)
            c, k0, pk = coef[place[0]], knots[place[0]], place[1]
            first = jumps or switched
            if first:
                h = min(h, restart)
            if not driven:
                for i in range(n):
                    theta, omega, alpha = turn(c[i], W[i, _LAG], t - k0)
                    omega = omega if omega != 0.0 else alpha
                    C[i, RIGID] = sector(W[i], theta, omega, AHEAD) % 2.0
                share = first_switch(W, c, t - k0, y, z, K, stop - t)
                switched = share <= 1.0 and share * (stop - t) > SAME_S
                if switched:
                    stop = t + share * (stop - t)
            fresh = True
        if fresh:
            for i in range(speeds):
                C[i, RIGID] = sector(W[i], y[moving + i], y[6 + i], AHEAD) % 2.0
            rates_called(P, W, t, y, c, k0, push, pk, C, B, acc, f)
            if held and B[JAMMED] > 0.0:  # what was measured did go on: until something next jumps
                B[RESTING] = 1.0
                rates_called(P, W, t, y, c, k0, push, pk, C, B, acc, f)
            if B[UP] > 0.0 and B[PULLED] > -least:
                status = TIPS
            if B[JAMMED] > 0.0:
                status = JAMS
            if status != DONE and lifted < 0.0:
                lifted = t
            if status != DONE:
                break
            if hung or B[UP] > 0.0:
                if lifted < 0.0:
                    lifted = t
                hung = B[UP] > 0.0
                for i in range(n):
                    up = C[i, AIR] if hung else 0.0
                    task[TASK + i] += 0.5 * (up + C[i, HUNG]) * (t - since)
                    C[i, HUNG] = up
            since = t
            while row < total and times[row] <= t:
                tell(P, y, C, out[row])
                row += 1
            if row >= total or t >= until:
                break
            jacobian(P, W, t, y, c, k0, push, pk, C, B, columns, f, z, rate, away, J)
            fresh = False
        step = stop - t if stop - t < 1.01 * h else h
        if steps + rejected >= most or t + step <= t:
            status = TOO_LONG if steps + rejected >= most else STUCK
            break
        error = 1e300
        for again in range(2):  # again, shorter, where a driven wheel changes its sector on the way
            factor(J, y, GAMMA * step, M, E)
            for stage in range(6):
                begin(y, K, stage, step, z, rhs)
                slope = f
                if stage > 0:
                    rates(P, W, t + WHEN[stage] * step, z, c, k0, push, pk, C, B, away, rate)
                    slope = rate
                solve(J, M, E, GAMMA * step, TIME[stage] * step, pose, slope, rhs, K[stage])
            error = end(y, K, task, rtol, atol, W[0, _RADIUS], z)
            if again == 1 or not driven or not error <= 1.0:
                break
            share = first_switch(W, c, t - k0, y, z, K, step)
            if share > 1.0 or share * step < 1e-13:
                break
            step *= share
        if not error <= 1.0:
            rejected += 1
            if held and B[JAMMED] > 0.0:  # it would jam on the way
                B[RESTING], fresh = 1.0, True
            h = step * (max(1.0 / 6.0, 0.9 * error**-0.25) if error < 1e30 else 0.1)
            if h < 1e-14:
                status = STUCK if error < 1e30 else NOT_FINITE
                break
            continue
        if len(trace) > 0:
            told = trace[steps]
            told[WHEN_S], told[LONG_S], told[PIECE], told[PUSHED] = t, step, place[0], pk
            for r in range(6):
                told[FROM + r], told[TO + r] = y[r], z[r]
                told[BEND + r], told[TWIST + r] = bends(K, r)
            for i in range(n):
                told[TRACE + i] = C[i, RIGID]
        steps += 1
        grow = min(5.0, 0.9 * error**-0.25) if error > 1e-4 else 5.0
        while row < total and times[row] < t + step:
            for r in range(m):
                rhs[r] = dense(y, z, K, r, (times[row] - t) / step)
            if out.shape[1] > 6:
                rates_called(P, W, times[row], rhs, c, k0, push, pk, C, B, away, rate)
            tell(P, rhs, C, out[row])
            row += 1
        t = stop if step == stop - t else t + step
        for r in range(m):
            y[r] = z[r]
        if first and step == h:
            restart, first = grow * step, False
        # A step cut short at a stop says nothing against the longer one.
        h = max(h, grow * step) if step < h else grow * step
        fresh = True
    for k in range(row, total):  # after a stop everything stays as it was, at rest
        tell(P, y, C, out[k])
        for r in range(3, out.shape[1]):
            if status != DONE and (r < 6 or (r - 6) % TOLD > 0):
                out[k, r] = 0.0
    task[0], task[1] = status, t
    task[2], task[3], task[4] = steps, rejected, lifted
