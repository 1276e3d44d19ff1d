"""A simulator of its own: the motion of a wheeled robot with slip, and physics that can be planted.

It shares no code with :mod:`slipmargin.sim`: Newton's law is written in the floor frame, for the centre of
mass, and stepped by the classical Runge-Kutta method with a fixed step.  The wheel model is that of
docs/theory.md, section 1: the contact of wheel i slides with u = v + w×p + ρ ω ŝ, and the floor answers with
−N [f_W ĝ + f_T f̂].  What is planted stands in :class:`Physics`; its defaults do nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numba import njit

Array = np.ndarray[Any, np.dtype[np.float64]]
F = TypeVar("F", bound=Callable[..., Any])
GRAVITY = 9.81  #: [m/s²], as robot files are meant (slipmargin.physics.constants)
LAWS = ("atan", "tanh", "rational")
GRIPS = ("box", "disc-strip", "ellipse")


def _compiled(function: F) -> F:
    return njit(cache=True, error_model="numpy")(function)  # type: ignore[no-any-return]


class Machine(NamedTuple):
    """A robot on a floor; vectors in the body frame, (N, 2) where not said otherwise."""

    mass: float
    inertia: float
    com: Array  # (2,)
    com_height: float
    position: Array
    drive: Array  # direction in which a positive wheel speed moves the contact
    grip: Array
    free: Array
    radius: Array  # (N,)
    rollers: Array  # (N,)
    rigid_fraction: Array  # (N,)
    mu_drive: Array  # (N,)
    mu_transverse: Array  # (N,)
    mu_rigid: Array  # (N, 2): drive, transverse
    k: Array  # (N,)
    law: int
    shape: int
    coupling: float
    rest: Array  # (N,) loads at rest [N]
    per_acceleration: Array  # (N, 2) change of load per acceleration [kg]
    per_moment: Array  # (N, 2) change of load per height × horizontal force [1/m]


class Physics(NamedTuple):
    """Planted physics; every default does nothing.  Lengths in m, angles in rad, times in s."""

    # the whole body
    tilt_x: float = 0.0
    tilt_y: float = 0.0
    roll_coulomb: float = 0.0  # share of the weight
    roll_viscous: float = 0.0  # N s/m
    roll_yaw: float = 1.0  # size of the yaw part, relative
    tether_k: float = 0.0  # N/m
    tether_x: float = 0.0
    tether_y: float = 0.0
    tether_slack: float = 0.0  # length below which the cable does not pull
    push_at: float = 0.0
    push_width: float = 1.0
    push_x: float = 0.0  # N, floor frame
    push_y: float = 0.0
    push_moment: float = 0.0
    castor: float = 0.0  # Coulomb drag [N] of a point that slides along
    castor_x: float = 0.0
    castor_y: float = 0.0
    twist_moment: float = 0.0  # N m, always
    flex_rate: float = 0.0  # rad/s; above 0 the loads follow the acceleration as a mass on a spring
    flex_damping: float = 0.2
    # the floor under a wheel
    nap_x: float = 0.0
    nap_y: float = 0.0
    fourfold: float = 0.0
    fourfold_at: float = 0.0
    patch_x: float = 0.0
    patch_y: float = 0.0
    patch_radius: float = 1.0
    patch_change: float = 0.0  # relative change of friction inside
    seam_height: float = 0.0
    seam_width: float = 1.0
    seam_at: float = 0.0
    ramp_slope: float = 0.0
    ramp_from: float = 0.0
    ramp_to: float = 0.0
    across: float = 0.0  # direction that crosses seam or ramp
    # friction of a wheel
    stribeck: float = 1.0
    stribeck_speed: float = 1.0
    fade: float = 0.0
    fade_time: float = 1.0
    polish: float = 0.0
    polish_length: float = 1.0
    stick_wheel: float = -1.0
    stick_from: float = 0.0
    stick_width: float = 0.0
    stick_factor: float = 1.0
    # a wheel's shape: amplitude and phase over the wheel angle, wheel by wheel
    bent_wheel: float = -1.0
    bent: float = 0.0
    bent_phase: float = 0.0
    round_wheel: float = -1.0
    out_of_round: float = 0.0
    round_phase: float = 0.0
    # drives
    droop: float = 0.0  # rad/s per N m
    sag: float = 0.0  # relative speed lost per N m of all wheels together
    sag_time: float = 0.05


@_compiled
def _share(law: int, z: float) -> float:
    if law == 1:
        return float(np.tanh(z))
    if law == 2:
        return float(z / np.sqrt(1.0 + z * z))
    return float(np.arctan(z) * 2.0 / np.pi)


@_compiled
def _disc(law: int, x: float, z: float, mu: float, k: float) -> tuple[float, float]:
    s = np.sqrt(x * x + z * z)
    if s < 1e-14:
        return 0.0, 0.0
    f = mu * _share(law, k * s) / s
    return f * x, f * z


@_compiled
def _unit_force(
    law: int, shape: int, coupling: float, x: float, z: float, mw: float, mt: float, k: float
) -> tuple[float, float]:
    """Friction per load along grip and roller direction at sliding speeds x, z."""
    bw, bt = mw * _share(law, k * x), mt * _share(law, k * z)
    if shape == 0 or coupling == 0.0:
        return bw, bt
    if shape == 2:
        r = mt / mw
        cw, ct = _disc(law, x, r * z, mw, k)
        ct *= r
    else:
        cw, ct = _disc(law, x, z, mw, k)
        if abs(ct) > mt:  # the roller spins in its bearing: find the speed at which its drag is mt
            low, high, share = 0.0, abs(z), mt / mw
            middle = min(abs(x) * share / np.sqrt(1.0 - share * share) + share / k, 0.9 * high)
            for _ in range(40):  # Newton's steps with a slope by difference, kept inside the bracket
                miss = _disc(law, x, middle, mw, k)[1] - mt
                if miss > 0.0:
                    high = middle
                else:
                    low = middle
                if abs(miss) < 1e-7 * mt:
                    break
                d = 1e-4 * middle
                step = miss * d / (_disc(law, x, middle + d, mw, k)[1] - mt - miss)
                middle = middle - step
                if not low < middle < high:
                    middle = 0.5 * (low + high)
            cw = _disc(law, x, middle, mw, k)[0]
            ct = mt if z > 0.0 else -mt
    return coupling * cw + (1.0 - coupling) * bw, coupling * ct + (1.0 - coupling) * bt


@_compiled
def _rigid(m: Machine, i: int, theta: float) -> bool:
    """Whether wheel i at an angle stands on one of its rigid parts."""
    pitch = 2.0 * np.pi / m.rollers[i]
    return bool(theta - np.floor(theta / pitch) * pitch >= (1.0 - m.rigid_fraction[i]) * pitch)


@_compiled
def _switches(m: Machine, begin: Array, end: Array, cuts: Array) -> int:
    """How many parts a step has, in each of which no wheel gets on or off a rigid part.

    Into ``cuts`` go the shares of the step at which they begin and end, from 0 to 1.  Within a step wheels
    turn evenly but for 1e-6 rad.
    """
    count = 1
    cuts[0] = 0.0
    for i in range(len(begin)):
        pitch, way = 2.0 * np.pi / m.rollers[i], end[i] - begin[i]
        if m.rigid_fraction[i] <= 0.0 or way == 0.0:
            continue
        low, high = min(begin[i], end[i]), max(begin[i], end[i])
        for offset in (0.0, (1.0 - m.rigid_fraction[i]) * pitch):
            edge = np.ceil((low - offset) / pitch) * pitch + offset
            while edge < high and count < len(cuts) - 1:
                cuts[count] = (edge - begin[i]) / way
                count += 1
                edge += pitch
    cuts[count] = 1.0
    cuts[: count + 1].sort()
    return count


@_compiled
def _between(values: Array, x: float, out: Array) -> None:
    """Values (3, N) of a step's begin, middle and end at a share x of it, into out (N,)."""
    for i in range(values.shape[1]):
        out[i] = values[0, i] * (1.0 - x) * (1.0 - 2.0 * x) + x * (
            4.0 * values[1, i] * (1.0 - x) + values[2, i] * (2.0 * x - 1.0)
        )


@_compiled
def _coefficients(
    m: Machine, p: Physics, i: int, t: float, theta: float, rigid: bool, wx: float, wy: float, slid: float
) -> tuple[float, float]:
    """Both coefficients of wheel i at floor place (wx, wy), all but what depends on the sliding itself."""
    mw = m.mu_rigid[i, 0] if rigid else m.mu_drive[i]
    mt = m.mu_rigid[i, 1] if rigid else m.mu_transverse[i]
    if p.stick_wheel == i:
        turn = theta - p.stick_from
        turn -= np.floor(turn / (2.0 * np.pi)) * 2.0 * np.pi
        if turn < p.stick_width:
            mt *= p.stick_factor
    factor = 1.0
    if p.patch_change != 0.0:
        far = np.sqrt((wx - p.patch_x) ** 2 + (wy - p.patch_y) ** 2)
        factor *= 1.0 + p.patch_change * 0.5 * (1.0 - np.tanh((far - p.patch_radius) / 0.005))
    if p.fade != 0.0:
        factor *= 1.0 - p.fade * (1.0 - np.exp(-t / p.fade_time))
    if p.polish != 0.0:
        factor *= 1.0 - p.polish * (1.0 - np.exp(-slid / p.polish_length))
    return mw * factor, mt * factor


@_compiled
def _friction(
    m: Machine,
    p: Physics,
    i: int,
    phi: float,
    gx: float,
    gy: float,
    ux: float,
    uy: float,
    mw: float,
    mt: float,
) -> tuple[float, float]:
    """Friction per load (along ĝ, along f̂) at contact velocity (ux, uy), body frame; (gx, gy) is ĝ."""
    uw, ut = ux * gx + uy * gy, -ux * gy + uy * gx
    # f̂ is ĝ turned by +90 degrees or by −90: forces are odd in the velocity, so either will do
    if p.stribeck != 1.0:
        mw *= p.stribeck + (1.0 - p.stribeck) * np.exp(-((uw / p.stribeck_speed) ** 2))
    if p.nap_x != 0.0 or p.nap_y != 0.0:
        c, s = np.cos(phi), np.sin(phi)
        fx, fy = c * gx - s * gy, s * gx + c * gy
        sign = 1.0 if uw >= 0.0 else -1.0
        mw *= 1.0 + sign * (p.nap_x * fx + p.nap_y * fy)
        sign = 1.0 if ut >= 0.0 else -1.0
        mt *= 1.0 + sign * (-p.nap_x * fy + p.nap_y * fx)
    if p.fourfold != 0.0:
        beta = phi + np.arctan2(uy, ux)
        factor = 1.0 + p.fourfold * np.cos(4.0 * (beta - p.fourfold_at))
        mw *= factor
        mt *= factor
    return _unit_force(m.law, m.shape, m.coupling, uw, ut, mw, mt, m.k[i])


@_compiled
def _slope(p: Physics, x: float, y: float) -> float:
    """Rise of the floor per metre across seam or ramp at a floor place."""
    s = x * np.cos(p.across) + y * np.sin(p.across)
    rise = 0.0
    if p.seam_height != 0.0:
        z = (s - p.seam_at) / p.seam_width
        rise += -2.0 * p.seam_height * z / p.seam_width * np.exp(-z * z)
    if p.ramp_slope != 0.0:
        rise += p.ramp_slope * 0.5 * (np.tanh((s - p.ramp_from) / 0.01) - np.tanh((s - p.ramp_to) / 0.01))
    return rise


@_compiled
def _rates(
    m: Machine,
    p: Physics,
    t: float,
    y: Array,
    theta: Array,
    omega: Array,
    rigid: Array,
    dy: Array,
    out: Array,
) -> None:
    """Time derivative of the state; ``rigid`` (N,) says which wheels stand on their rigid parts.

    State: centre of mass x, y, φ, their velocities, bend of the chassis (2) and its rate (2), sag of
    the battery, then the way that each wheel has slid.  ``out`` gets the smallest load.
    """
    n = len(m.radius)
    c, s = np.cos(y[2]), np.sin(y[2])
    vx, vy, w = c * y[3] + s * y[4], -s * y[3] + c * y[4], y[5]
    # forces that are no wheel's, body frame, with the moment that shifts load
    ex, ey, ez, hx, hy, lift = 0.0, 0.0, p.twist_moment, 0.0, 0.0, 0.0
    weight = m.mass * GRAVITY
    floor_x, floor_y = 0.0, 0.0
    angle = np.sqrt(p.tilt_x**2 + p.tilt_y**2)
    if angle > 0.0:
        floor_x += weight * np.sin(angle) * p.tilt_x / angle
        floor_y += weight * np.sin(angle) * p.tilt_y / angle
        lift = weight * (1.0 - np.cos(angle))
        hx = m.com_height * (c * floor_x + s * floor_y)
        hy = m.com_height * (-s * floor_x + c * floor_y)
    if p.tether_k != 0.0:
        dx, dist_y = p.tether_x - y[0], p.tether_y - y[1]
        far = np.sqrt(dx * dx + dist_y * dist_y)
        if far > p.tether_slack:
            pull = p.tether_k * (far - p.tether_slack) / far
            floor_x += pull * dx
            floor_y += pull * dist_y
    if p.push_x != 0.0 or p.push_y != 0.0:
        z = (t - p.push_at) / p.push_width
        if 0.0 < z < 1.0:
            bell = np.sin(np.pi * z) ** 2
            floor_x += p.push_x * bell
            floor_y += p.push_y * bell
            ez += p.push_moment * bell
    ex += c * floor_x + s * floor_y
    ey += -s * floor_x + c * floor_y
    if p.roll_coulomb != 0.0 or p.roll_viscous != 0.0:
        speed = np.sqrt(vx * vx + vy * vy + 1e-6)
        reach = 0.0
        for i in range(n):
            reach += np.sqrt((m.position[i, 0] - m.com[0]) ** 2 + (m.position[i, 1] - m.com[1]) ** 2) / n
        size = p.roll_coulomb * weight / speed + p.roll_viscous
        ex -= size * vx
        ey -= size * vy
        for i in range(n):  # it acts through the axles, at the mean of the wheels' radii above the floor
            hx -= m.radius[i] / n * size * vx
            hy -= m.radius[i] / n * size * vy
        rim = w * reach
        ez -= (
            p.roll_yaw * reach * rim * (p.roll_coulomb * weight / np.sqrt(rim * rim + 1e-6) + p.roll_viscous)
        )
    if p.castor != 0.0:
        px, py = p.castor_x - m.com[0], p.castor_y - m.com[1]
        cx, cy = vx - w * py, vy + w * px
        speed = np.sqrt(cx * cx + cy * cy + 1e-5)
        ex -= p.castor * cx / speed
        ey -= p.castor * cy / speed
        ez -= p.castor * (px * cy - py * cx) / speed
    # wheels: force per load q, so that loads that follow the acceleration make a linear system
    ax = ay = az = 0.0
    jxx = jxy = jyx = jyy = jzx = jzy = 0.0
    torque = 0.0
    flex = p.flex_rate > 0.0
    out[0] = 1e9
    for i in range(n):
        rx, ry = m.position[i, 0] - m.com[0], m.position[i, 1] - m.com[1]
        gx, gy, dx, dyy = m.grip[i, 0], m.grip[i, 1], m.drive[i, 0], m.drive[i, 1]
        radius = m.radius[i]
        if p.bent_wheel == i:
            toe = p.bent * np.sin(theta[i] - p.bent_phase)
            ct, st = np.cos(toe), np.sin(toe)
            gx, gy = ct * gx - st * gy, st * gx + ct * gy
            dx, dyy = ct * dx - st * dyy, st * dx + ct * dyy
        if p.round_wheel == i:
            radius *= 1.0 + p.out_of_round * np.cos(theta[i] - p.round_phase)
        wx = y[0] + c * rx - s * ry
        wy = y[1] + s * rx + c * ry
        load = m.rest[i] * (1.0 - lift / weight) + m.per_moment[i, 0] * hx + m.per_moment[i, 1] * hy
        if flex:
            load += m.per_acceleration[i, 0] * y[6] + m.per_acceleration[i, 1] * y[7]
        mw, mt = _coefficients(m, p, i, t, theta[i], rigid[i], wx, wy, y[11 + i])
        hub_x, hub_y = vx - w * ry, vy + w * rx
        spin = omega[i] * (1.0 - p.sag * y[10])
        if p.droop > 0.0:  # ω = ω_asked − droop · torque(ω); the torque grows with ω: one root
            reach = p.droop * radius * load * (mw + mt)
            low, high = spin - reach, spin + reach
            for _ in range(45):
                middle = 0.5 * (low + high)
                ux, uy = hub_x + radius * middle * dx, hub_y + radius * middle * dyy
                fw, ft = _friction(m, p, i, y[2], gx, gy, ux, uy, mw, mt)
                delivered = radius * load * (fw * (gx * dx + gy * dyy) + ft * (-gy * dx + gx * dyy))
                if middle - spin + p.droop * delivered > 0.0:
                    high = middle
                else:
                    low = middle
            spin = 0.5 * (low + high)
        ux, uy = hub_x + radius * spin * dx, hub_y + radius * spin * dyy
        fw, ft = _friction(m, p, i, y[2], gx, gy, ux, uy, mw, mt)
        qx, qy = -(fw * gx - ft * gy), -(fw * gy + ft * gx)
        torque += abs(radius * load * (qx * dx + qy * dyy))
        dy[11 + i] = np.sqrt(ux * ux + uy * uy)
        rise = _slope(p, wx, wy)
        if rise != 0.0:
            fx, fy = -rise * np.cos(p.across), -rise * np.sin(p.across)
            qx += c * fx + s * fy
            qy += -s * fx + c * fy
        arm = rx * qy - ry * qx
        ax += load * qx
        ay += load * qy
        az += load * arm
        if not flex:
            px, py = m.per_acceleration[i, 0], m.per_acceleration[i, 1]
            jxx += qx * px
            jxy += qx * py
            jyx += qy * px
            jyy += qy * py
            jzx += arm * px
            jzy += arm * py
        out[0] = min(out[0], load)
    ax, ay = (ax + ex) / m.mass, (ay + ey) / m.mass
    jxx, jxy, jyx, jyy = 1.0 - jxx / m.mass, -jxy / m.mass, -jyx / m.mass, 1.0 - jyy / m.mass
    det = jxx * jyy - jxy * jyx
    bx, by = (jyy * ax - jxy * ay) / det, (jxx * ay - jyx * ax) / det
    az = (az + jzx * bx + jzy * by + ez) / m.inertia
    if not flex:
        for i in range(n):
            change = m.per_acceleration[i, 0] * bx + m.per_acceleration[i, 1] * by
            out[0] = min(out[0], m.rest[i] + change)
    dy[0], dy[1], dy[2] = y[3], y[4], w
    dy[3], dy[4], dy[5] = c * bx - s * by, s * bx + c * by, az
    rate = p.flex_rate
    dy[6], dy[7] = y[8], y[9]
    dy[8] = rate * rate * (bx - y[6]) - 2.0 * p.flex_damping * rate * y[8]
    dy[9] = rate * rate * (by - y[7]) - 2.0 * p.flex_damping * rate * y[9]
    dy[10] = (torque - y[10]) / p.sag_time


@_compiled
def _step(
    m: Machine,
    p: Physics,
    t: float,
    h: float,
    y: Array,
    theta: Array,
    omega: Array,
    rigid: Array,
    k: Array,
    out: Array,
) -> float:
    """In place: the state ``y`` a step later; returns the smallest load at the begin.

    ``theta`` and ``omega`` (3, N) are those at its begin, middle and end; ``k`` (5, S) is room to work in.
    """
    z = k[4]
    _rates(m, p, t, y, theta[0], omega[0], rigid, k[0], out)
    least = out[0]
    for stage, share in ((1, 0.5), (2, 0.5), (3, 1.0)):
        for d in range(len(y)):
            z[d] = y[d] + share * h * k[stage - 1, d]
        at = 2 if stage == 3 else 1
        _rates(m, p, t + share * h, z, theta[at], omega[at], rigid, k[stage], out)
    for d in range(len(y)):
        y[d] += h / 6.0 * (k[0, d] + 2.0 * k[1, d] + 2.0 * k[2, d] + k[3, d])
    return float(least)


@_compiled
def _march(
    m: Machine, p: Physics, start: Array, theta: Array, omega: Array, h: float, every: int
) -> tuple[Array, float]:
    """Poses of the origin after each ``every`` steps, and the smallest load met."""
    steps, n = theta.shape[0], theta.shape[2]
    y, k, out = np.zeros(11 + n), np.zeros((5, 11 + n)), np.zeros(1)
    y[0] = start[0] + np.cos(start[2]) * m.com[0] - np.sin(start[2]) * m.com[1]
    y[1] = start[1] + np.sin(start[2]) * m.com[0] + np.cos(start[2]) * m.com[1]
    y[2] = start[2]
    poses = np.empty((steps // every + 1, 3))
    poses[0] = start
    least, cuts, rigid = 1e9, np.zeros(8 * n), np.zeros(n, dtype=np.bool_)
    part_theta, part_omega = np.zeros((3, n)), np.zeros((3, n))
    for j in range(steps):
        parts = _switches(m, theta[j, 0], theta[j, 2], cuts)
        for part in range(parts):
            x, long = cuts[part], cuts[part + 1] - cuts[part]
            if long < 1e-9:
                continue
            for at in range(3):
                _between(theta[j], x + 0.5 * at * long, part_theta[at])
                _between(omega[j], x + 0.5 * at * long, part_omega[at])
            for i in range(n):
                rigid[i] = _rigid(m, i, part_theta[1, i])
            least = min(least, _step(m, p, (j + x) * h, long * h, y, part_theta, part_omega, rigid, k, out))
        if (j + 1) % every == 0:
            c, s = np.cos(y[2]), np.sin(y[2])
            row = (j + 1) // every
            poses[row, 0] = y[0] - c * m.com[0] + s * m.com[1]
            poses[row, 1] = y[1] - s * m.com[0] - c * m.com[1]
            poses[row, 2] = y[2]
    return poses, least


def step_of(machine: Machine) -> float:
    """The longest step [s] at which the creep of this robot's contacts is followed well."""
    slope = float(np.max(machine.k)) * (2.0 / np.pi if machine.law == 0 else 1.0)
    mu = max(
        float(np.max(machine.mu_drive)),
        float(np.max(machine.mu_rigid * (machine.rigid_fraction[:, None] > 0))),
    )
    reach = float(np.mean(np.sum((machine.position - machine.com) ** 2, axis=1)))
    rate = slope * mu * GRAVITY * max(1.0, machine.mass * reach / machine.inertia)
    return min(2.5e-4, 1.2 / rate)


def march(
    machine: Machine, physics: Physics, start: Array, theta: Array, omega: Array, h: float, every: int
) -> tuple[Array, float]:
    """Poses (R, 3) of the body frame's origin and the smallest wheel load [N].

    Parameters
    ----------
    start : (3,)
        Pose at the start; the robot is at rest.
    theta, omega : (S, 3, N)
        Wheel angles and speeds at the beginning, the middle and the end of each of S steps.
    h : float
        Step [s].
    every : int
        A pose is kept after so many steps.
    """
    return _march(machine, physics, start, theta, omega, h, every)


def sharing(position: Array) -> Array:
    """(N, 3): loads from the weight and its two moments; least change where wheels are more than three."""
    a = np.vstack([np.ones(len(position)), position.T])
    return np.asarray(a.T @ np.linalg.inv(a @ a.T))


def transfer(machine: Machine, height: float) -> Array:
    """(N, 2): change of load per acceleration of the centre of mass at a height [kg]."""
    return np.asarray(-machine.mass * height * sharing(machine.position)[:, 1:])
