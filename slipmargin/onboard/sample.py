"""One sample of a slip monitor, compiled: filters, the motion of the wheels, and what the model makes of it.

:mod:`~slipmargin.onboard.signals` says what the numbers mean.  Nothing here creates an array.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.physics.compiled import inner, kernel, twin
from slipmargin.physics.grips import across_alone, left_beside
from slipmargin.physics.kinematics import at_centre

_across_alone, _left_beside, _at_centre = twin(across_alone), twin(left_beside), twin(at_centre)

#: What is added before a logarithm, so that a robot at rest has finite numbers [m/s, m/s², rad/s, A].
SLOW, CALM, STILL, FAINT = 2e-3, 0.05, 0.02, 0.02


@inner
def _dot(rows: Array, k: int, vector: Array) -> float:
    total = 0.0
    for j in range(vector.shape[0]):
        total += rows[k, j] * vector[j]
    return total


@kernel
def shares(
    law: int,
    coupling: float,
    wheel: Array,
    body: Array,
    lateral: Array,
    across: Array,
    viscous: Array,
    spread: Array,
    three: NDArray[np.intp],
    weight: Array,
    alone: Array,
    twist: Array,
    rate: Array,
    use: Array,
) -> float:
    """The largest share of its grip that the model gives a wheel; ``use[0]`` (N,) gets that of each.

    As :func:`~slipmargin.onboard.limiter.utilisation` on one level floor, for one state.  ``wheel`` (14, N):
    load at rest, its least, its change per acceleration along x and y, coefficient and slope of the least
    drag and the same of the coupled part of the grip, these four of the greatest drag, drive coefficient,
    drag that leaves nothing to drive.  ``body`` (10,): centre of mass, mass twice, inertia, external
    wrench, lightest load, least grip that is left.  Where the loads decide how wheels share a
    wrench, ``three`` (T, 3), ``weight`` and ``alone`` say how any three would
    (:func:`~slipmargin.onboard.table.threes`), else they are empty.  ``use`` (3, N) is worked in.
    """
    n = use.shape[1]
    wz = twist[2]
    px, py = rate[0] - wz * twist[1], rate[1] + wz * twist[0]
    ax, ay = _at_centre(body[0], body[1], wz, px, py, rate[2])
    fx = ax * body[2] - body[5] - _dot(viscous, 0, twist)
    fy = ay * body[3] - body[6] - _dot(viscous, 1, twist)
    moment = rate[2] * body[4] - body[7] - _dot(viscous, 2, twist)
    for i in range(n):
        moved = wheel[2, i] * ax + wheel[3, i] * ay
        load = max(wheel[0, i] + moved, body[8])
        slip, drag = _dot(lateral, i, twist), 0.0
        for k in (4, 8):
            box, coupled = (wheel[k, i], wheel[k + 1, i]), (wheel[k + 2, i], wheel[k + 3, i])
            drag += 0.5 * _across_alone(law, coupling, slip, box, coupled)
        left = _left_beside(coupling, abs(drag) / wheel[13, i])
        use[0, i] = 0.0
        use[1, i] = max(wheel[12, i] * load * left, 1e-30)
        use[2, i] = max(wheel[1, i] + moved, body[8]) * max(left, body[9])
        drag *= load
        fx += across[0, i] * drag
        fy += across[1, i] * drag
        moment += across[2, i] * drag
    total = 0.0
    for t in range(three.shape[0]):
        part = use[2, three[t, 0]] * use[2, three[t, 1]] * use[2, three[t, 2]]
        total += part * weight[t]
        for k in range(3):
            own = alone[t, k]
            use[0, three[t, k]] += part * (own[0] * fx + own[1] * fy + own[2] * moment)
    most = 0.0
    for i in range(n):
        if three.shape[0] > 0:
            force = use[0, i] / total
        else:
            force = spread[i, 0] * fx + spread[i, 1] * fy + spread[i, 2] * moment
        use[0, i] = abs(force) / use[1, i]
        most = max(most, use[0, i])
    return most


@kernel
def sample(
    k: float,
    tau: float,
    rim: float,
    omega: Array,
    commanded: Array,
    gyro: float,
    current: Array,
    to_twist: Array,
    null: Array,
    wheels: Array,
    slow: Array,
    motion: Array,
    out: Array,
) -> int:
    """Filter a sample and write its numbers but the first to ``out``; how many there are.

    ``k`` is the part of a filter's gap that closes; ``wheels`` (3, N) holds the filtered speeds, their rate
    and the currents' size, ``slow`` (4,) the roughness, the residual, what is behind the command, and the yaw
    rate of the gyro over that of the wheels; ``motion`` (3, 3) gets the twist of the filtered wheels, its
    rate, and the twist of the wheels now.  A channel that is not logged has no entries, a gyro NaN.
    """
    n = omega.shape[0]
    rough = 0.0
    for i in range(n):
        off = omega[i] - wheels[0, i]
        wheels[0, i] += k * off
        wheels[1, i] += k * (off / tau - wheels[1, i])
        left = off - tau * wheels[1, i]
        rough += left * left
    slow[0] += k * (rough - slow[0])
    for j in range(3):
        motion[0, j] = motion[1, j] = motion[2, j] = 0.0
        for i in range(n):
            motion[0, j] += to_twist[j, i] * wheels[0, i]
            motion[1, j] += to_twist[j, i] * wheels[1, i]
            motion[2, j] += to_twist[j, i] * omega[i]
    vx, vy, wz = motion[0, 0], motion[0, 1], motion[0, 2]
    speed = math.sqrt(vx * vx + vy * vy)
    px, py = motion[1, 0] - wz * vy, motion[1, 1] + wz * vx
    out[1] = math.log(CALM + math.sqrt(px * px + py * py))
    out[2] = math.log(CALM + abs(motion[1, 2]))
    out[3] = math.log(SLOW + math.sqrt(slow[0]) * rim)
    out[4] = speed
    out[5] = math.log(STILL + abs(wz))
    at = 6
    if null.shape[0] > 0:
        apart = 0.0
        for j in range(null.shape[0]):
            part = _dot(null, j, omega) * rim
            apart += part * part
        slow[1] += k * (apart - slow[1])
        out[at] = math.log(SLOW + math.sqrt(slow[1]))
        at += 1
    if commanded.shape[0] > 0:
        behind = 0.0
        for i in range(n):
            part = (commanded[i] - omega[i]) * rim
            behind += part * part
        slow[2] += k * (behind - slow[2])
        out[at] = math.log(SLOW + math.sqrt(slow[2]))
        at += 1
    if not math.isnan(gyro):
        slow[3] += k * (gyro - motion[2, 2] - slow[3])
        out[at] = math.log(STILL + abs(slow[3]))
        at += 1
    if current.shape[0] > 0:
        total, power = 0.0, 0.0
        for i in range(n):
            wheels[2, i] += k * (abs(current[i]) - wheels[2, i])
            total += wheels[2, i]
            power += wheels[2, i] * abs(wheels[0, i])
            out[at + i] = math.log(FAINT + wheels[2, i])
        at += n
        out[at] = math.log(FAINT + total)
        out[at + 1] = math.log((FAINT + power * rim) / (SLOW + speed + abs(wz) * 0.1))
        at += 2
    return at
