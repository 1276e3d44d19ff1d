"""How wheels with prescribed speeds creep together (docs/theory.md, section 4, four wheels and more).

All wheels share one creep twist ε (velocity of the centre of mass, yaw rate): the slips are u_W = b_i·ε
and u_T = u_T0 + t_i·ε.  At rest in the moving frame ε solves

    r(ε) = Σ_i b_i c_i σ(k b_i·ε) + Σ_i t_i d_i σ(k (u_T0 + t_i·ε)) + (M a − w_loss) = 0,

the gradient of a convex potential, with c_i = μ_W N_i, d_i = μ_T N_i and σ the model's friction law.  A
wheel's *use* is |σ(k b_i·ε)|.  :mod:`slipmargin.limits.creep_states` follows ε from one rest to the next.

**Open loop.** Where nothing corrects the pose, the creep itself turns the robot: it moves with v + ε_v
and ω + ε_ω, and must be accelerated by m [(ω + ε_ω) ẑ×(v + ε_v) − ω ẑ×v] more (the wheels prescribe the
velocity in the body frame).

Then r is no gradient, and other creeps may satisfy r(ε) = 0 at which the turning pulls harder than the wheels
resist: the robot leaves those, as a pencil leaves its tip.  Only a creep counts that it settles to
(det ∂r/∂ε ≥ 0) and that the one rest of the held pose grows into; where there is none the creep runs away.

**Beyond the limit.** σ stops at 1, so no ε exists outside the wrench set.  Above the share 0.98 σ is
continued by a straight line of slope 0.02 per unit of k u: the use then exceeds 1 and says by how much,
and below 0.98 nothing is changed.
"""

from __future__ import annotations

import math

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.compiled import inner, spliced, twin
from slipmargin.physics.friction_laws import law_inverse, law_share, law_slope

#: Share up to which the friction law is used as it stands [1].
FAITHFUL = 0.98
#: Slope of the continuation above it, per unit of k·u [1].
BEYOND = 0.02
#: Use of a wheel where no steady creep is found: far outside the wrench set, or the creep runs away [1].
RUNAWAY = 1.5
#: Newton's method ends at this size of the residual, as a share of the wrench to compare with; a creep whose
#: residual is above the second has not been found [1].
EXACT, FOUND = 1e-11, 1e-8
#: Where no wheel uses more, a rest that the neighbouring state leads to is taken for the only one: others
#: have been seen from 0.93 up [1].
ALONE = 0.92
#: Stages from a held pose to an open loop: 8 and 32 of them led equally far [1].
STAGES = 8
#: Share of the largest slope that stands in for none: a creep that no wheel resists then stays small [1].
UNRESISTED = 1e-12
#: Columns of a wheel: c, k along ĝ, d, k along f̂, u_T0, and k b_i·ε where it was last looked at.  What the
#: wheels are asked for: M a − w_loss (3), (m, v_x, v_y, ω) and a wrench to compare with (3).  Tables that
#: compiled code works on: it compiles twice as fast where it creates none.
GRIP, STEEP, DRAG, STEEP_ACROSS, SLIDE, SLIP, WHEEL = range(7)
NEED, CARRIED, SCALE, ASKED = 0, 3, 7, 10
TABLES = (6, 3, 3)
_law_share, _law_slope = twin(law_share), twin(law_slope)


@spliced
def continued(law: int, knee: float, z: float) -> tuple[float, float]:
    """σ(z), beyond ``knee`` = σ⁻¹(0.98) continued by a straight line, and its slope."""
    if abs(z) <= knee:
        return _law_share(law, z), _law_slope(law, z)
    return math.copysign(FAITHFUL + BEYOND * (abs(z) - knee), z), BEYOND


@spliced
def slip(A: Array, k: float, eps: Array, i: int) -> float:
    """k b_i·ε of wheel i."""
    return float(k * (A[0, i] * eps[0] + A[1, i] * eps[1] + A[2, i] * eps[2]))


@inner
def residual(
    law: int, knee: float, A: Array, wheels: Array, ask: Array, eps: Array, out: Array, H: Array
) -> float:
    """r(ε) and its Jacobian; returns the size of r as a share of the wrench to compare with.

    A (6, N): wrench of a unit force along ĝ, then along f̂; wheels (N, WHEEL); ask (ASKED).
    """
    m, w = ask[CARRIED], ask[CARRIED + 3] + eps[2]
    vx, vy = ask[CARRIED + 1] + eps[0], ask[CARRIED + 2] + eps[1]
    r0 = ask[NEED] - m * (w * vy - ask[CARRIED + 3] * ask[CARRIED + 2])
    r1 = ask[NEED + 1] + m * (w * vx - ask[CARRIED + 3] * ask[CARRIED + 1])
    r2 = ask[NEED + 2]
    h00, h01, h02 = 0.0, 0.0, 0.0
    h11, h12, h22 = 0.0, 0.0, 0.0
    for i in range(len(wheels)):
        wheel = wheels[i]
        wheel[SLIP] = slip(A, wheel[STEEP], eps, i)
        for side in range(2):
            size, k = wheel[2 * side], wheel[2 * side + 1]
            if size == 0.0:
                continue
            a, b, c = A[3 * side, i], A[3 * side + 1, i], A[3 * side + 2, i]
            z = wheel[SLIP] if side == 0 else k * (wheel[SLIDE] + a * eps[0] + b * eps[1] + c * eps[2])
            share, slope = continued(law, knee if side == 0 else math.inf, z)
            f, h = size * share, size * k * slope
            r0, r1, r2 = r0 + a * f, r1 + b * f, r2 + c * f
            ha, hb = h * a, h * b
            h00, h01, h02 = h00 + ha * a, h01 + ha * b, h02 + ha * c
            h11, h12, h22 = h11 + hb * b, h12 + hb * c, h22 + h * c * c
    out[0], out[1], out[2] = r0, r1, r2
    H[0, 0], H[0, 1], H[0, 2] = h00, h01 - m * w, h02 - m * vy
    H[1, 0], H[1, 1], H[1, 2] = h01 + m * w, h11, h12 + m * vx
    H[2, 0], H[2, 1], H[2, 2] = h02, h12, h22
    x, y, turn = out[0] / ask[SCALE], out[1] / ask[SCALE + 1], out[2] / ask[SCALE + 2]
    return math.sqrt(x * x + y * y + turn * turn)


@spliced
def solve3(H: Array, b: Array, x: Array) -> None:
    """x = H⁻¹ b by elimination; H is positive semidefinite but for the turning of the frame.

    Along a creep that no wheel resists H is singular: the least of slopes stands in (:data:`UNRESISTED`).
    """
    least0 = UNRESISTED * (H[0, 0] + H[1, 1]) + 1e-300
    h00, h22 = H[0, 0] + least0, H[2, 2] * (1.0 + UNRESISTED) + 1e-300
    p, q = H[1, 0] / h00, H[2, 0] / h00
    h11, h12, b1 = H[1, 1] + least0 - p * H[0, 1], H[1, 2] - p * H[0, 2], b[1] - p * b[0]
    h21, h22, b2 = H[2, 1] - q * H[0, 1], h22 - q * H[0, 2], b[2] - q * b[0]
    r = h21 / h11
    x[2] = (b2 - r * b1) / (h22 - r * h12)
    x[1] = (b1 - h12 * x[2]) / h11
    x[0] = (b[0] - H[0, 1] * x[1] - H[0, 2] * x[2]) / h00


@inner
def balance(
    law: int, knee: float, A: Array, wheels: Array, ask: Array, eps: Array, exact: float, tables: Array
) -> float:
    """The creep at which r(ε) = 0, by damped Newton from ``eps``, in place; returns the size of r there.

    It ends where that is at most ``exact``.
    """
    H, other, rows = tables[0], tables[1], tables[2]
    out, step, trial = rows[0], rows[1], rows[2]
    miss = residual(law, knee, A, wheels, ask, eps, out, H)
    for _ in range(100):
        if miss <= exact:
            break
        solve3(H, out, step)
        size, less = 1.0, math.inf
        while size > 1e-9:
            for r in range(3):
                trial[r] = eps[r] - size * step[r]
            less = residual(law, knee, A, wheels, ask, trial, out, other)
            if less < (1.0 - 1e-4 * size) * miss:
                break
            size *= 0.5
        if size <= 1e-9:
            break
        for r in range(3):
            eps[r] = trial[r]
            for q in range(3):
                H[r, q] = other[r, q]
        miss = less
    return miss


@spliced
def returns(H: Array) -> bool:
    """Whether a small departure from rest fades: det H ≥ 0, which changes its sign where two rests meet."""
    one, two = H[0, 0] * H[1, 1] * H[2, 2], H[0, 1] * H[1, 2] * H[2, 0]
    three, four = H[0, 2] * H[1, 0] * H[2, 1], H[0, 2] * H[1, 1] * H[2, 0]
    five, six = H[0, 1] * H[1, 0] * H[2, 2], H[0, 0] * H[1, 2] * H[2, 1]
    size = abs(one) + abs(two) + abs(three) + abs(four) + abs(five) + abs(six)
    return bool(one + two + three - four - five - six >= -UNRESISTED * size)


@inner
def _settles(
    law: int, knee: float, A: Array, wheels: Array, ask: Array, eps: Array, exact: float, tables: Array
) -> bool:
    """Whether :func:`balance` finds, from ``eps`` and in place, a creep to which the robot settles."""
    miss = balance(law, knee, A, wheels, ask, eps, exact, tables)
    return bool(miss <= max(FOUND, exact) and (ask[CARRIED] == 0.0 or returns(tables[0])))


@inner
def _lead(
    law: int, knee: float, A: Array, wheels: Array, ask: Array, eps: Array, exact: float, tables: Array
) -> bool:
    """Whether the one rest of the held pose grows towards that of an open loop, all stages but the last."""
    carried, led = ask[CARRIED], True
    for r in range(3):
        eps[r] = 0.0
    for stage in range(STAGES if carried != 0.0 else 0):
        ask[CARRIED] = carried * (stage / STAGES)
        led = _settles(law, knee, A, wheels, ask, eps, exact, tables)
        if not led:
            break
    ask[CARRIED] = carried
    return led


@inner
def at_rest(
    law: int,
    knee: float,
    A: Array,
    wheels: Array,
    ask: Array,
    eps: Array,
    exact: float,
    tables: Array,
    use: Array,
) -> bool:
    """Whether a creep is found to which the robot settles, from ``eps`` and else from a held pose, in place.

    ``use`` (N,) is taken there; where none is found the wheel that was worst uses ``RUNAWAY``.
    """
    found, led, worst = False, True, 0
    afresh = not math.isfinite(eps[0] + eps[1] + eps[2])
    while True:
        if afresh:
            led = _lead(law, knee, A, wheels, ask, eps, exact, tables)
        found = _settles(law, knee, A, wheels, ask, eps, exact, tables) and led
        worst = 0
        for i in range(len(wheels)):
            use[i] = abs(continued(law, knee, slip(A, wheels[i, STEEP], eps, i))[0])
            if use[i] > use[worst]:
                worst = i
        if afresh or (found and (ask[CARRIED] == 0.0 or use[worst] <= ALONE)):
            break
        afresh = True
    if not found:
        use[worst] = max(use[worst], RUNAWAY)
    return found


def knee(law: int) -> float:
    """k u above which a law is continued by a straight line."""
    return float(law_inverse(law, FAITHFUL))


def continued_share(law: int, z: Array) -> Array:
    """σ(z), above the share 0.98 continued by a straight line."""
    top = knee(law)
    beyond = np.copysign(FAITHFUL + BEYOND * (np.abs(z) - top), z)
    return np.asarray(np.where(np.abs(z) <= top, law_share(law, z), beyond))
