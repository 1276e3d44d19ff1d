"""Where a stretch of a motion ends: a knot, an edge of a term, a wheel's change of sector (compiled)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from slipmargin.physics import sectors
from slipmargin.physics.compiled import fast, inner, spliced, twin
from slipmargin.sim import layout as at
from slipmargin.sim.rodas import dense
from slipmargin.sim.wheels import turn

_LAG, _PITCH, _SHARE, _ROLLER, _RIGID = at.LAG, at.PITCH, at.RIGID_SHARE, at.ROLLER_W, at.RIGID_W
_on_rigid, _matters = twin(sectors.on_rigid), twin(sectors.switching)

#: Instants nearer than this are one [s].
SAME_S = 1e-12
#: A wheel this near an edge of a sector counts as past it in the direction it turns [rad]; a stretch
#: starts with more of it than the search for the next edge uses, so that an edge is not found twice.
_NUDGE = 1e-9
AHEAD = 4.0 * _NUDGE
#: Between two looks for an edge a wheel turns by no more than this share of the sector it stands in, and a
#: stretch is looked at so many times at least; where the wheel reverses in between, there as well.  Sectors
#: beyond the next edge may be as short as they like: that edge comes first.
_LOOK, _LOOKS = 0.5, 8
#: Halvings after which an instant is known to the last digit.
_HALVINGS = 52


@spliced
def sector(w: Any, theta: float, omega: float, nudge: float) -> float:
    """Number of the sector a wheel stands in, odd on rigid material; on an edge the way it turns decides."""
    angle = theta + (nudge if omega >= 0.0 else -nudge)
    number = 2.0 * math.floor(angle / w[_PITCH])
    return float(number + (1.0 if _on_rigid(angle, w[_PITCH], w[_SHARE]) else 0.0))


@fast
def merged(knots: Any, rows: Any, first: Any) -> tuple[Any, Any, Any]:
    """Knots of wheels each of which changes what it does at times of its own.

    The times, those that are one only once, and of each part between two of them its old piece and (M, N) the
    row of each wheel.  Of ``rows`` the first column is the time; those of wheel i begin at ``first[i]``.
    """
    every = np.sort(np.concatenate((knots, rows[:, 0])))
    times, kept = np.empty(len(every)), 1
    times[0] = every[0]
    for t in every:
        if t > times[kept - 1] + SAME_S:
            times[kept] = t
            kept += 1
    times[kept - 1] = knots[len(knots) - 1]
    n, j, now = len(first) - 1, 0, first[:-1].copy()
    piece, current = np.empty(kept - 1, dtype=np.int64), np.empty((kept - 1, n), dtype=np.int64)
    for m in range(kept - 1):
        mid = 0.5 * (times[m] + times[m + 1])
        while j < len(knots) - 2 and knots[j + 1] <= mid:
            j += 1
        piece[m] = j
        for i in range(n):
            while now[i] + 1 < first[i + 1] and rows[now[i] + 1, 0] <= mid:
                now[i] += 1
            current[m, i] = now[i]
    return times[:kept], piece, current


@inner
def _switching(w: Any) -> bool:
    """Whether it matters which sector a wheel stands in."""
    return bool(_matters(w[_SHARE], w[_ROLLER], w[_ROLLER + 1], w[_RIGID], w[_RIGID + 1]))


@spliced
def _wheel(i: int, coef: Any, lag: float, since: float, y: Any, z: Any, K: Any, x: float, span: float) -> Any:
    """(θ, ω) of wheel i at the share x of a stretch: from the dense output of a step, or as known in time."""
    m = K.shape[1]
    if m > 6:
        n = (m - 6) // 2
        return dense(y, z, K, 6 + n + i, x), dense(y, z, K, 6 + i, x)
    theta, omega, _ = turn(coef[i], lag, since + x * span)
    return theta, omega


@inner
def first_switch(W: Any, coef: Any, since: float, y: Any, z: Any, K: Any, span: float) -> float:
    """Share of a stretch of ``span`` seconds at which the first wheel changes sector; 2 where none does.

    Known wheels move by coef (N, 5), ``since`` seconds into the piece; driven ones from y to z.
    """
    found = 2.0
    for i in range(len(W)):
        w = W[i]
        if not _switching(w):
            continue
        lag = w[_LAG]
        theta, omega = _wheel(i, coef, lag, since, y, z, K, 0.0, span)
        here, fastest = sector(w, theta, omega, AHEAD), abs(omega)
        for k in range(1, 5):
            fastest = max(fastest, abs(_wheel(i, coef, lag, since, y, z, K, 0.25 * k, span)[1]))
        pitch, switch = w[_PITCH], (1.0 - w[_SHARE]) * w[_PITCH]
        whole = math.floor(0.5 * here)
        rigid = here > 2.0 * whole
        own = pitch - switch if rigid else switch
        ahead = min(_LOOK * own / max(fastest * span, 1e-300), 1.0 / _LOOKS)
        x, before = 0.0, omega
        while x < min(found, 1.0):
            within = theta - pitch * math.floor(theta / pitch)  # no edge is nearer than this:
            room = min(within, abs(within - switch), pitch - within)
            low, x = x, min(1.0, x + max(ahead, 0.5 * room / max(fastest * span, 1e-300)))
            high, was = x, theta
            theta, omega = _wheel(i, coef, lag, since, y, z, K, x, span)
            there, end = sector(w, theta, omega, _NUDGE), theta
            if there == here and omega * before < 0.0:  # it turned back in between: look there as well
                for _ in range(_HALVINGS):
                    mid = 0.5 * (low + high)
                    end, speed = _wheel(i, coef, lag, since, y, z, K, mid, span)
                    if speed * before > 0.0:
                        low = mid
                    else:
                        high = mid
                there, low = sector(w, end, before, _NUDGE), 0.0
            if there != here:
                edge = whole * pitch + (switch if rigid != (end > was) else 0.0)
                if rigid and end > was:
                    edge += pitch
                mid = 0.5 * (low + high)
                for _ in range(_HALVINGS):  # Newton's steps, halving where one leaves the bracket
                    end, speed = _wheel(i, coef, lag, since, y, z, K, mid, span)
                    if sector(w, end, speed, _NUDGE) != here:
                        high = mid
                        if abs(end - edge) < 0.1 * _NUDGE:
                            break
                    else:
                        low = mid
                    mid += (edge - end) / (speed * span)
                    if not (low < mid and mid < high):
                        mid = 0.5 * (low + high)
                found = min(found, high)
                break
            before = omega
    return found


#: A step is begun anew where a wheel's lag has to take up this share of its speed, 1 rad/s added [1].
FOLLOWS = 1e-3


@inner
def next_stop(
    W: Any, knots: Any, coef: Any, push: Any, edges: Any, t: float, place: Any
) -> tuple[float, bool]:
    """When the next knot or edge comes after t, and whether a wheel's speed, a force or friction jumps at t.

    A wheel that lags counts as well where its acceleration jumps.

    ``place`` holds the numbers of the wheels' piece, of the push's and of the first edge to come (−1, 0, 0
    before the first call) and receives those from t on.
    """
    last, was, pk, edge = len(knots) - 2, place[0], place[1], place[2]
    piece, jumps = max(was, 0), was < 0
    while piece < last and knots[piece + 1] <= t + SAME_S:
        piece += 1
    if 0 <= was < piece:
        for i in range(len(W)):
            lag = W[i, _LAG]
            _, before, rising = turn(coef[piece - 1, i], lag, knots[piece] - knots[piece - 1])
            _, after, rises = turn(coef[piece, i], lag, 0.0)
            jumps = jumps or abs(after - before) > 1e-9 * (1.0 + abs(after))
            # A wheel that begins to follow a new command is past it before a long step looks again.
            if coef[piece, i, 4] != 0.0:
                jumps = jumps or abs(rises - rising) * lag > FOLLOWS * (1.0 + abs(after))
    while pk < len(push) - 2 and push[pk + 1, 0] <= t + SAME_S:
        pk += 1
    stop = knots[piece + 1]
    while edge < len(edges) and edges[edge] <= t + SAME_S:
        jumps = jumps or edges[edge] >= t - SAME_S
        edge += 1
    if edge < len(edges):
        stop = min(stop, edges[edge])
    place[0], place[1], place[2] = piece, pk, edge
    return stop, jumps
