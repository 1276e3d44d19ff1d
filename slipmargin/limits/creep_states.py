"""The creep of many states at rest, on the way from one rest to the next, and along a whole motion.

After a jump of the acceleration the creep ε of :mod:`slipmargin.limits.creep` settles within milliseconds by
M dε/dt = −r(ε), and since that of some wheels settles sooner than that of others, a wheel may use more on the
way than before and after.  Where k falls with the speed, it may take as long as the motion: then
M dε/dt = −r(ε, t) is followed from its start (docs/theory.md, section 5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.limits.creep import (
    EXACT,
    RUNAWAY,
    STEEP,
    TABLES,
    at_rest,
    continued,
    continued_share,
    knee,
    residual,
    slip,
    solve3,
)
from slipmargin.physics.compiled import inner, kernel

#: A jump that changes no wheel's use by this much is none [1].
NO_JUMP = 5e-3
#: Settling ends where every wheel's use is this close to what it comes to, or after so many steps [1].
SETTLED, SETTLING_STEPS = 1e-3, 400
#: The first step of the settling in units of the fastest time constant, and each further one's growth [1].
STEP, GROWTH = 0.2, 1.1
#: ROS2's γ that makes it L-stable [1].
GAMMA = 1.0 - math.sqrt(0.5)


@kernel
def _creep(
    law: int,
    knee: float,
    A: Array,
    wheels: Array,
    asks: Array,
    tables: Array,
    twist: Array,
    use: Array,
) -> None:
    """Damped Newton over all samples, each from its neighbour and else from the held pose."""
    eps = tables[3, 0]
    for m in range(len(wheels)):
        found = at_rest(law, knee, A, wheels[m], asks[m], eps, EXACT, tables, use[m])
        for r in range(3):
            twist[m, r] = eps[r]
            if not found:
                eps[r] = 0.0


@inner
def _fastest(H: Array, mass: Array) -> float:
    """No time constant of M dε/dt = −H ε is shorter [s]: Gershgorin's circles."""
    rate = 0.0
    for r in range(3):
        row = 0.0
        for q in range(3):
            row += abs(H[r, q]) / math.sqrt(mass[r] * mass[q])
        rate = max(rate, row)
    return 1.0 / max(rate, 1e-300)


@kernel
def _settle(
    law: int,
    knee: float,
    A: Array,
    wheels: Array,
    asks: Array,
    tables: Array,
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
    H, other, lhs = tables[0], tables[1], tables[2]
    eps, at, out = tables[3, 0], tables[3, 1], tables[3, 2]
    one, two = tables[4, 0], tables[4, 1]
    for m in jumps:
        h = 0.0
        for r in range(3):
            eps[r] = start[m, r]
        for _ in range(SETTLING_STEPS):
            off, most = 0.0, 0.0
            for i in range(wheels.shape[1]):
                share = continued(law, knee, slip(A, wheels[m, i, STEEP], eps, i))[0]
                peak[m, i] = max(peak[m, i], min(abs(share), RUNAWAY))
                off, most = max(off, abs(share - finish[m, i])), max(most, abs(share))
            if off <= SETTLED or not most < RUNAWAY:
                break
            residual(law, knee, A, wheels[m], asks[m], eps, out, H)
            h = STEP * _fastest(H, mass) if h == 0.0 else GROWTH * h
            for r in range(3):
                for q in range(3):
                    lhs[r, q] = GAMMA * h * H[r, q] + (mass[r] if r == q else 0.0)
            solve3(lhs, out, one)
            for r in range(3):
                at[r] = eps[r] - h * one[r]
            residual(law, knee, A, wheels[m], asks[m], at, out, other)
            for r in range(3):
                out[r] -= 2.0 * mass[r] * one[r]
            solve3(lhs, out, two)
            for r in range(3):
                eps[r] -= h * (1.5 * one[r] + 0.5 * two[r])


@inner
def _euler(
    law: int,
    knee: float,
    A: Array,
    wheels: Array,
    ask: Array,
    tables: Array,
    mass: Array,
    h: float,
    eps: Array,
) -> None:
    """One linearly implicit Euler step (M + h H) Δε = −h r(ε), in place."""
    H, lhs, out, step = tables[0], tables[1], tables[4, 0], tables[4, 1]
    residual(law, knee, A, wheels, ask, eps, out, H)
    for r in range(3):
        for q in range(3):
            lhs[r, q] = h * H[r, q] + (mass[r] if r == q else 0.0)
    solve3(lhs, out, step)
    for r in range(3):
        eps[r] -= h * step[r]


@kernel
def _follow(
    law: int,
    knee: float,
    A: Array,
    wheels: Array,
    asks: Array,
    tables: Array,
    mass: Array,
    time: Array,
    between: Array,
    asked: Array,
    twist: Array,
    use: Array,
) -> None:
    """ε (M, 3) and shares (M, N) along samples in time, from no creep at the first.

    ``between`` and ``asked`` are the wheels and what is asked half way to the next sample.

    Linearly implicit Euler, extrapolated from one step and two halves between samples: of second order, and
    what settles faster than that is at rest (Deuflhard, SIAM Review 27, 1985).
    """
    one, two = tables[3, 0], tables[3, 1]
    for r in range(3):
        twist[0, r] = 0.0
    for m in range(len(wheels)):
        if m > 0:
            h = time[m] - time[m - 1]
            for r in range(3):
                one[r] = two[r] = twist[m - 1, r]
            if h > 0.0:
                _euler(law, knee, A, wheels[m], asks[m], tables, mass, h, one)
                _euler(law, knee, A, between[m - 1], asked[m - 1], tables, mass, 0.5 * h, two)
                _euler(law, knee, A, wheels[m], asks[m], tables, mass, 0.5 * h, two)
            for r in range(3):
                twist[m, r] = 2.0 * two[r] - one[r]
        for i in range(wheels.shape[1]):
            share = continued(law, knee, slip(A, wheels[m, i, STEEP], twist[m], i))[0]
            use[m, i] = min(abs(share), RUNAWAY)


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

    def rest(self) -> tuple[Array, Array]:
        """Creep twist ε (M, 3) [m/s, m/s, rad/s] to which the robot settles, and the use (M, N) there.

        Where there is none a wheel uses ``RUNAWAY`` or more.
        """
        twist, use = np.empty((len(self.grip), 3)), np.empty(self.grip.shape)
        _creep(*self._packed(), twist, use)
        return twist, use

    def settling(self, before: Balance, mass: Array) -> Array:
        """Largest use (M, N) while the creep goes from rest as ``before`` to rest; ``mass`` (3,): m, m, I.

        A creep that runs away on the way uses ``RUNAWAY``; where one of both has no rest, the larger of what
        they use stands.
        """
        (start, used), (end, use) = before.rest(), self.rest()
        peak = np.maximum(used, use)
        begin, finish = (
            continued_share(self.law, self.steep * (twist @ self.along)) for twist in (start, end)
        )
        far = np.max(np.abs(finish - begin), axis=1) >= NO_JUMP
        jumps = np.flatnonzero(far & (np.max(peak, axis=1) < RUNAWAY))
        _settle(*self._packed(), np.array(mass), start, finish, jumps, peak)
        return peak

    def followed(self, time_s: Array, mass: Array) -> tuple[Array, Array]:
        """Creep twist ε (M, 3) and use (M, N) where these states follow each other at ``time_s`` (M,)."""
        twist, use = np.empty((len(self.grip), 3)), np.empty(self.grip.shape)
        packed = self._packed()
        between, asked = (0.5 * (each[1:] + each[:-1]) for each in packed[3:5])
        _follow(*packed, np.array(mass), np.array(time_s), between, asked, twist, use)
        return twist, use

    def _packed(self) -> tuple[int, float, Array, Array, Array, Array]:
        """Law, knee, wrenches of unit forces (6, N), wheels (M, N, WHEEL), what they are asked, tables."""
        columns = [self.grip, self.steep, self.drag, self.steep_across, self.slide, np.zeros(self.grip.shape)]
        wheels = np.stack(columns, axis=2)
        scale = np.broadcast_to(self.scale, (len(wheels), 3))
        asks = np.concatenate([self.need, self.carried, scale], axis=1)
        forces = np.concatenate([self.along, self.across])
        return self.law, knee(self.law), forces, wheels, asks, np.zeros(TABLES)
