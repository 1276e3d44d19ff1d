"""Wheels that hang in the air (compiled).

Springs of equal stiffness press or let go, they never pull: N_i = max(0, N_i + l + l_x x_i + l_y y_i) with
the plane by which the body sinks, so that the loads keep their sum and both moments.  These are the loads
N ≥ 0 nearest to those of :mod:`slipmargin.physics.loads` (docs/theory.md, section 3).  Which wheels touch is
found together with the acceleration that the loads follow.

Where no three wheels that touch span an area the robot begins to tip: no loads balance the moments.  Those
that touch then carry the weight between them, and what the floor would have to pull to keep the robot upright
is told: this model knows no turn about a horizontal axis, so a run ends where that lasts or grows.

Of a robot far too tall, friction may press a wheel down harder the harder it rubs, so that no acceleration
agrees with its own loads (as of a chalk that stutters over a board: Painlevé's paradox).  Where none is
found that is told, and a run ends: such a robot jams.  What was measured did go on: a prediction of it
(an infinite ``held_down``) keeps the loads at rest from there to the signal's next knot.

A wheel in the air has no friction, and a floor that rises under it does not push it; viscous friction,
which does not know the load, stays.
"""

from __future__ import annotations

from typing import Any

from slipmargin.physics import loads
from slipmargin.physics.compiled import inner, spliced, twin
from slipmargin.sim import layout as at
from slipmargin.sim.balance import accelerate
from slipmargin.sim.columns import (
    AIR,
    JAMMED,
    LOAD,
    PULLED,
    SHARED,
    SHARED_X,
    SHARED_Y,
    STILL,
    UP,
)

_SHARE, _AX, _AY, _LX, _LY = at.SHARE, at.ARM_X, at.ARM_Y, at.LOAD_X, at.LOAD_Y
_sinking, _spread = twin(loads.sinking), twin(loads.spread)

#: A load below zero by more than rounding: the wheel has lifted [m g/N].
LIFTED = 1e-9
#: Stiffness of a wheel in the air against one that touches while it is sought which do [1]: it decides what
#: a robot does that no three wheels carry.  Rounding over it, 1e-10, is what such loads are wrong by.
_GLUE = 1e-6
#: Wheels span an area if their :func:`~slipmargin.physics.loads.spread` is this share of all wheels' [1].
_AREA = 1e-8
#: Searches for the wheels that touch end by themselves after two or three turns.  One that goes to and fro
#: takes half steps after so many, and stops after so many.
_WHOLE, _TURNS = 6, 40
#: Which wheels touch at the acceleration that follows from it is found in as many turns, or not at all: where
#: the robot tips, and where it jams because friction presses the wheel down that rubs.
_SEARCH = 12
#: It was not found where a wheel in the air would press, or one that touches is pulled, by more than this
#: [m g/N]: where the search ends it is some 1e-10 by rounding, where it does not nearly the whole load.
_AGREED = 1e-6


@spliced
def lifts(P: Any, C: Any) -> bool:
    """Whether the floor would have to pull some wheel down."""
    least, found = -LIFTED * P[_SHARE], False
    for i in range(len(C)):
        if C[i, LOAD] < least:
            found = True
    return found


@inner
def _stiffness(W: Any, C: Any, glue: float) -> tuple[float, float, float, float, float, float]:
    """Sums of the wheels' stiffness times 1, x, y, x², x y, y², those in the air being this stiff."""
    n, x, y, xx, xy, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(W)):
        k, p, q = 1.0 + C[i, AIR] * (glue - 1.0), W[i, _AX], W[i, _AY]
        n, x, y, xx, xy, yy = n + k, x + k * p, y + k * q, xx + k * p * p, xy + k * p * q, yy + k * q * q
    return n, x, y, xx, xy, yy


@inner
def _share(W: Any, C: Any, glue: float) -> None:
    """What each wheel carries, without and per acceleration, those in the air being this stiff."""
    n, x, y, xx, xy, yy = _stiffness(W, C, glue)
    for r in range(3):
        b, bx, by = 0.0, 0.0, 0.0
        for i in range(len(W)):
            if C[i, AIR] > 0.0:
                lost = (1.0 - glue) * (C[i, STILL] if r == 0 else W[i, _LX + r - 1])
                b, bx, by = b + lost, bx + lost * W[i, _AX], by + lost * W[i, _AY]
        l, lx, ly = _sinking(n, x, y, xx, xy, yy, b, bx, by)
        for i in range(len(W)):
            own = C[i, STILL] if r == 0 else W[i, _LX + r - 1]
            part = own + l + lx * W[i, _AX] + ly * W[i, _AY]
            C[i, SHARED + r] = (glue if C[i, AIR] > 0.0 else 1.0) * part


@inner
def _changes(C: Any) -> bool:
    """Whether other wheels hang in the air than those for which the loads were found."""
    found = False
    for i in range(len(C)):
        found = found or (C[i, LOAD] < 0.0) != (C[i, AIR] > 0.0)
    return found


@inner
def _carry(W: Any, C: Any, ax: float, ay: float, glue: float) -> None:
    """The loads at an acceleration, those in the air being this stiff."""
    _share(W, C, glue)
    for i in range(len(W)):
        C[i, LOAD] = C[i, SHARED] + C[i, SHARED_X] * ax + C[i, SHARED_Y] * ay


@inner
def _settle(W: Any, C: Any, ax: float, ay: float) -> None:
    """Which wheels hang in the air at an acceleration, by Newton's steps, and the loads there."""
    _carry(W, C, ax, ay, _GLUE)
    for _ in range(_TURNS):
        if not _changes(C):
            break
        for i in range(len(W)):
            C[i, AIR] = 1.0 if C[i, LOAD] < 0.0 else 0.0
        _carry(W, C, ax, ay, _GLUE)


@inner
def _agree(P: Any, C: Any) -> bool:
    """Whether loads, those in the air being as stiff as glue, press where wheels touch and nowhere else."""
    agree = True
    for i in range(len(C)):
        wrong = C[i, LOAD] / _GLUE if C[i, AIR] > 0.0 else -C[i, LOAD]
        agree = agree and wrong <= _AGREED * P[_SHARE]
    return agree


@inner
def hang(P: Any, W: Any, C: Any, B: Any, acc: Any) -> None:
    """Acceleration and loads with wheels in the air, where one :func:`lifts`; the friction in C stays."""
    ax, ay, part = acc[0], acc[1], 1.0
    for i in range(len(W)):
        C[i, AIR] = 0.0
    for turn in range(_SEARCH):
        _settle(W, C, ax, ay)
        accelerate(P, W, C, B, acc)
        if not _changes(C):
            break
        if turn >= _WHOLE:
            part = 0.5
        ax, ay = ax + part * (acc[0] - ax), ay + part * (acc[1] - ay)
    B[UP], B[PULLED], B[JAMMED] = 0.0, 0.0, 0.0
    for i in range(len(W)):
        B[UP] += C[i, AIR]
    if _spread(*_stiffness(W, C, 0.0)) > _AREA * _spread(*_stiffness(W, C, 1.0)):
        _share(W, C, 0.0)
        accelerate(P, W, C, B, acc)
        _carry(W, C, acc[0], acc[1], _GLUE)
        if not _agree(P, C):
            B[JAMMED] = 1.0
        _carry(W, C, acc[0], acc[1], 0.0)
        for i in range(len(W)):
            C[i, LOAD] = max(0.0, C[i, LOAD])
    else:
        _tip(P, W, C, B, acc)


@inner
def _tip(P: Any, W: Any, C: Any, B: Any, acc: Any) -> None:
    """Acceleration and loads where no loads balance the moments: the wheels that touch carry the weight."""
    ax, ay = acc[0], acc[1]
    B[JAMMED] = 1.0
    for turn in range(_TURNS):
        _settle(W, C, ax, ay)
        agree = _agree(P, C)
        weight, pressing, x, y, pull = 0.0, 0.0, 0.0, 0.0, 0.0
        for i in range(len(W)):
            weight += C[i, LOAD]
            pull = max(pull, -C[i, LOAD])
            if C[i, LOAD] > 0.0:
                pressing, x, y = pressing + C[i, LOAD], x + C[i, SHARED_X], y + C[i, SHARED_Y]
        for i in range(len(W)):  # N weight / Σ N of those that touch, and its slope
            load, own, px, py = C[i, LOAD], 0.0, 0.0, 0.0
            if load > 0.0:
                own = weight / pressing
                px = own * (C[i, SHARED_X] - load * x / pressing)
                py = own * (C[i, SHARED_Y] - load * y / pressing)
            C[i, SHARED], C[i, SHARED_X], C[i, SHARED_Y] = own * load - px * ax - py * ay, px, py
        accelerate(P, W, C, B, acc)
        B[PULLED] = pull
        if abs(acc[0] - ax) + abs(acc[1] - ay) <= 1e-12 * (1.0 + abs(ax) + abs(ay)):
            B[JAMMED] = 0.0 if agree else 1.0
            break
        part = 1.0 if turn < _WHOLE else 0.5
        ax, ay = ax + part * (acc[0] - ax), ay + part * (acc[1] - ay)
