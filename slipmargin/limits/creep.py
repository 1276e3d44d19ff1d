"""How wheels with prescribed speeds creep together (docs/theory.md, section 4, four wheels and more).

All wheels share one creep twist ε (velocity of the centre of mass, yaw rate): the slips are u_W = b_i·ε
and u_T = u_T0 + t_i·ε.  At rest in the moving frame ε solves

    r(ε) = Σ_i b_i c_i σ(k b_i·ε) + Σ_i t_i d_i σ(k (u_T0 + t_i·ε)) + (M a − w_loss) = 0,

the gradient of a convex potential, with c_i = μ_W N_i, d_i = μ_T N_i and σ the model's friction law.  A
wheel's *use* is |σ(k b_i·ε)|.  After a jump of the acceleration ε settles within milliseconds by
M dε/dt = −r(ε), and since the creep of some wheels settles sooner than that of others, a wheel may use
more on the way than before and after.

**Open loop.** Where nothing corrects the pose, the creep itself turns the robot: it moves with v + ε_v
and ω + ε_ω, and must be accelerated by m [(ω + ε_ω) ẑ×(v + ε_v) − ω ẑ×v] more (the wheels prescribe the
velocity in the body frame).

**Beyond the limit.** σ stops at 1, so no ε exists outside the wrench set.  Above the share 0.98 σ is
continued by a straight line of slope 0.02 per unit of k u: the use then exceeds 1 and says by how much,
and below 0.98 nothing is changed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.physics.compiled import fast, inner, twin
from slipmargin.physics.friction_laws import law_inverse, law_share, law_slope

#: Share up to which the friction law is used as it stands [1].
FAITHFUL = 0.98
#: Slope of the continuation above it, per unit of k·u [1].
BEYOND = 0.02
#: A jump that changes no wheel's use by this much is none [1].
NO_JUMP = 5e-3
#: Settling ends where every wheel's use is this close to what it comes to, or after so many steps [1].
SETTLED, SETTLING_STEPS = 1e-3, 400
#: The first step of the settling in units of the fastest time constant, and each further one's growth [1].
STEP, GROWTH = 0.2, 1.1
#: ROS2's γ that makes it L-stable [1].
GAMMA = 1.0 - math.sqrt(0.5)
#: Use of a wheel where no steady creep is found: far outside the wrench set, or the creep runs away [1].
RUNAWAY = 1.5
_law_share, _law_slope, _law_inverse = twin(law_share), twin(law_slope), twin(law_inverse)


@inner
def _share(law: int, z: float) -> tuple[float, float]:
    """Continued σ(z) and its slope."""
    knee = _law_inverse(law, FAITHFUL)
    if abs(z) <= knee:
        return _law_share(law, z), _law_slope(law, z)
    return math.copysign(FAITHFUL + BEYOND * (abs(z) - knee), z), BEYOND


@inner
def _residual(
    law: int,
    eps: Array,
    W: Array,
    T: Array,
    c: Array,
    kw: Array,
    d: Array,
    kt: Array,
    slide: Array,
    need: Array,
    carried: Array,
    scale: Array,
    out: Array,
    H: Array,
) -> float:
    """Residual and its Jacobian; ``carried`` is (m, v_x, v_y, ω), m = 0 where the pose is held."""
    n = W.shape[1]
    m, vx, vy, w = carried[0], carried[1] + eps[0], carried[2] + eps[1], carried[3] + eps[2]
    out[0] = need[0] - m * (w * vy - carried[3] * carried[2])
    out[1] = need[1] + m * (w * vx - carried[3] * carried[1])
    out[2] = need[2]
    H[:, :] = 0.0
    H[0, 1], H[0, 2], H[1, 0], H[1, 2] = -m * w, -m * vy, m * w, m * vx
    for i in range(n):
        g = W[0, i] * eps[0] + W[1, i] * eps[1] + W[2, i] * eps[2]
        f = slide[i] + T[0, i] * eps[0] + T[1, i] * eps[1] + T[2, i] * eps[2]
        sw, hw = _share(law, kw[i] * g)
        z = kt[i] * f
        st, ht = _law_share(law, z), _law_slope(law, z)
        for r in range(3):
            out[r] += W[r, i] * c[i] * sw + T[r, i] * d[i] * st
            for q in range(3):
                H[r, q] += W[r, i] * W[q, i] * c[i] * kw[i] * hw + T[r, i] * T[q, i] * d[i] * kt[i] * ht
    return math.sqrt((out[0] / scale[0]) ** 2 + (out[1] / scale[1]) ** 2 + (out[2] / scale[2]) ** 2)


@inner
def _solve3(H: Array, b: Array, x: Array) -> None:
    """x = H⁻¹ b by elimination; H is positive definite but for the turning of the frame."""
    p, q = H[1, 0] / H[0, 0], H[2, 0] / H[0, 0]
    h11, h12, b1 = H[1, 1] - p * H[0, 1], H[1, 2] - p * H[0, 2], b[1] - p * b[0]
    h21, h22, b2 = H[2, 1] - q * H[0, 1], H[2, 2] - q * H[0, 2], b[2] - q * b[0]
    r = h21 / h11
    x[2] = (b2 - r * b1) / (h22 - r * h12)
    x[1] = (b1 - h12 * x[2]) / h11
    x[0] = (b[0] - H[0, 1] * x[1] - H[0, 2] * x[2]) / H[0, 0]


@fast
def _creep(
    law: int,
    W: Array,
    T: Array,
    c: Array,
    kw: Array,
    d: Array,
    kt: Array,
    slide: Array,
    need: Array,
    carried: Array,
    scale: Array,
    twist: Array,
    use: Array,
) -> None:
    """Damped Newton over all samples, each from its neighbour and else from rest.

    Samples not found get the use ``RUNAWAY`` on the wheel that was worst.
    """
    samples, n = c.shape
    eps, step, trial = np.zeros(3), np.zeros(3), np.zeros(3)
    out, new, H, other = np.zeros(3), np.zeros(3), np.zeros((3, 3)), np.zeros((3, 3))
    for m in range(samples):
        for attempt in range(2):
            if attempt == 1 or not math.isfinite(eps[0] + eps[1] + eps[2]):
                eps[:] = 0.0
            miss = _residual(
                law, eps, W, T, c[m], kw[m], d[m], kt[m], slide[m], need[m], carried[m], scale, out, H
            )
            for _ in range(100):
                if miss <= 1e-11:
                    break
                _solve3(H, out, step)
                size = 1.0
                while size > 1e-9:
                    for r in range(3):
                        trial[r] = eps[r] - size * step[r]
                    less = _residual(
                        law,
                        trial,
                        W,
                        T,
                        c[m],
                        kw[m],
                        d[m],
                        kt[m],
                        slide[m],
                        need[m],
                        carried[m],
                        scale,
                        new,
                        other,
                    )
                    if less < (1.0 - 1e-4 * size) * miss:
                        break
                    size *= 0.5
                if size <= 1e-9:
                    break
                eps[:], out[:], H[:, :], miss = trial, new, other, less
            if miss <= 1e-8:
                break
        twist[m] = eps
        worst = 0
        for i in range(n):
            use[m, i] = abs(
                _share(law, kw[m, i] * (W[0, i] * eps[0] + W[1, i] * eps[1] + W[2, i] * eps[2]))[0]
            )
            if use[m, i] > use[m, worst]:
                worst = i
        if not miss <= 1e-8:
            use[m, worst] = max(use[m, worst], RUNAWAY)
            eps[:] = 0.0


@inner
def _fastest(H: Array, mass: Array) -> float:
    """No time constant of M dε/dt = −H ε is shorter [s]: Gershgorin's circles."""
    rate = 0.0
    for r in range(3):
        row = 0.0
        for q in range(3):
            row += abs(H[r, q]) / math.sqrt(mass[r] * mass[q])
        rate = max(rate, row)
    return 1.0 / rate


@fast
def _settle(
    law: int,
    W: Array,
    T: Array,
    c: Array,
    kw: Array,
    d: Array,
    kt: Array,
    slide: Array,
    need: Array,
    carried: Array,
    scale: Array,
    mass: Array,
    start: Array,
    finish: Array,
    jumps: Index,
    peak: Array,
) -> None:
    """Raise ``peak`` (M, N) to the largest use while ε goes from ``start`` (M, 3) to rest.

    Only for the samples ``jumps``, until the shares are ``finish`` (M, N), by the two-stage Rosenbrock
    method ROS2 (Verwer et al., SIAM J. Sci. Comput. 20, 1999): loaded wheels are forty times slower than
    idle ones.  Steps grow as the fast part fades.
    """
    n = c.shape[1]
    H, other, lhs = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    eps, at, out, one, two = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    for m in jumps:
        eps[:] = start[m]
        h = 0.0
        for _ in range(SETTLING_STEPS):
            off = 0.0
            for i in range(n):
                g = W[0, i] * eps[0] + W[1, i] * eps[1] + W[2, i] * eps[2]
                share = _share(law, kw[m, i] * g)[0]
                peak[m, i] = max(peak[m, i], abs(share))
                off = max(off, abs(share - finish[m, i]))
            if off <= SETTLED:
                break
            _residual(law, eps, W, T, c[m], kw[m], d[m], kt[m], slide[m], need[m], carried[m], scale, out, H)
            h = STEP * _fastest(H, mass) if h == 0.0 else GROWTH * h
            for r in range(3):
                for q in range(3):
                    lhs[r, q] = GAMMA * h * H[r, q] + (mass[r] if r == q else 0.0)
            _solve3(lhs, out, one)
            for r in range(3):
                at[r] = eps[r] - h * one[r]
            _residual(
                law, at, W, T, c[m], kw[m], d[m], kt[m], slide[m], need[m], carried[m], scale, out, other
            )
            for r in range(3):
                out[r] -= 2.0 * mass[r] * one[r]
            _solve3(lhs, out, two)
            for r in range(3):
                eps[r] -= h * (1.5 * one[r] + 0.5 * two[r])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Balance:
    """What M states ask of N wheels, all on known material.

    ``law`` is the friction law; ``along``, ``across`` (3, N): wrench of a unit force along ĝ and f̂; ``grip``,
    ``drag`` (M, N) c and d [N]; ``steep``, ``steep_across`` (M, N) k [s/m]; ``slide`` (M, N) u_T0 [m/s];
    ``need`` (M, 3) M a − w_loss; ``carried`` (M, 4) is (m, v_x, v_y, ω), m = 0 where the pose is held;
    ``scale`` (3,) a wrench to compare with.
    """

    law: int
    along: Array
    across: Array
    grip: Array
    drag: Array
    steep: Array
    steep_across: Array
    slide: Array
    need: Array
    carried: Array
    scale: Array

    def __post_init__(self) -> None:
        for one in fields(self):
            if one.name != "law":
                object.__setattr__(self, one.name, np.ascontiguousarray(getattr(self, one.name)))

    def rest(self) -> tuple[Array, Array]:
        """Creep twist ε (M, 3) [m/s, m/s, rad/s] at which r(ε) = 0, and the use (M, N) there."""
        twist, use = np.empty((len(self.grip), 3)), np.empty(self.grip.shape)
        _creep(
            self.law,
            self.along,
            self.across,
            self.grip,
            self.steep,
            self.drag,
            self.steep_across,
            self.slide,
            self.need,
            self.carried,
            self.scale,
            twist,
            use,
        )
        return twist, use

    def settling(self, start: Array, mass: Array) -> Array:
        """Largest use (M, N) on the way from creep ``start`` (M, 3) to rest; ``mass`` (3,) is (m, m, I)."""
        twists = start, self.rest()[0]
        begin, finish = (continued_share(self.law, self.steep * (twist @ self.along)) for twist in twists)
        peak = np.maximum(np.abs(begin), np.abs(finish))
        jumps = np.flatnonzero(np.max(np.abs(finish - begin), axis=1) >= NO_JUMP)
        _settle(
            self.law,
            self.along,
            self.across,
            self.grip,
            self.steep,
            self.drag,
            self.steep_across,
            self.slide,
            self.need,
            self.carried,
            self.scale,
            mass,
            start,
            finish,
            jumps,
            peak,
        )
        return peak


def continued_share(law: int, z: Array) -> Array:
    """σ(z), above the share 0.98 continued by a straight line."""
    knee = law_inverse(law, FAITHFUL)
    beyond = np.copysign(FAITHFUL + BEYOND * (np.abs(z) - knee), z)
    return np.asarray(np.where(np.abs(z) <= knee, law_share(law, z), beyond))
