"""The slow road: the same equations in plain NumPy, straight from a model's parts, by SciPy.

Written to be read and to check the compiled road; nothing of it is shared but the model.  Wheel
angles may switch sectors: events find the instants.  Equations as in :mod:`slipmargin.sim.body`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, nnls
from scipy.special import expit

from slipmargin.checks import Array
from slipmargin.model import Model
from slipmargin.physics.relief import Profile
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot import GripShape

#: θ(t), ω(t), ω̇(t) of all wheels, each (N,).
WheelMotion = Callable[[float], tuple[Array, Array, Array]]
#: Floor-frame force and moment on the centre of mass at a time, (3,).
PushOf = Callable[[float], Array]


def _turned(model: Model, toe: Array) -> Model:
    """The model with each wheel turned by ``toe`` (N,) about the vertical."""
    c, s = np.cos(toe), np.sin(toe)
    turn = np.moveaxis(np.array([[c, -s], [s, c]]), 2, 0)
    g = model.geometry
    drive, grip, free = (np.einsum("nij,nj->ni", turn, v) for v in (g.drive, g.grip, g.free))
    return replace(model, geometry=replace(g, drive=drive, grip=grip, free=free))


class _Instant:
    """Everything a variable may be read from, at one instant."""

    def __init__(self, model: Model, t: float, state: Array, wheels: tuple[Array, Array, Array]) -> None:
        self.t, self.straight = t, model.geometry
        self.theta, self.omega, self.alpha = wheels
        waves = np.column_stack([np.cos(self.theta), np.sin(self.theta)])
        self.model = model = _turned(model, np.sum(model.geometry.wobble * waves, axis=1))
        self.com, self.phi, self.twist = state[:2], state[2], state[3:]
        v, w = self.twist[:2], self.twist[2]
        c, com = model.geometry, model.inertia.com_m
        arm = c.position_m - com
        self.hub = v + w * np.column_stack([-arm[:, 1], arm[:, 0]])
        radius = c.radius_m * (1.0 + np.sum(c.runout * waves, axis=1))
        u = self.hub + (radius * self.omega)[:, None] * c.drive
        self.slip = np.stack([np.sum(u * c.grip, axis=1), np.sum(u * c.free, axis=1)])  # (2, N)
        self.turn = np.array([[np.cos(self.phi), -np.sin(self.phi)], [np.sin(self.phi), np.cos(self.phi)]])
        self.origin = self.com - self.turn @ com
        self.velocity = v - w * np.array([-com[1], com[0]])
        self.contact = self.com + arm @ self.turn.T  # (N, 2), floor frame

    def of_body(self, variable: Variable) -> float:
        c = self.straight  # what the wheels ask for is told from where they should point
        rows = np.column_stack(
            [c.grip, c.position_m[:, 0] * c.grip[:, 1] - c.position_m[:, 1] * c.grip[:, 0]]
        )
        asked = -np.linalg.pinv(rows) @ (c.radius_m * np.sum(c.drive * c.grip, axis=1) * self.alpha)
        values = {
            Variable.UNITY: 1.0,
            Variable.VELOCITY_X: self.velocity[0],
            Variable.VELOCITY_Y: self.velocity[1],
            Variable.YAW_RATE: self.twist[2],
            Variable.SPEED: float(np.hypot(*self.velocity)),
            Variable.ACCELERATION_X: asked[0],
            Variable.ACCELERATION_Y: asked[1],
            Variable.YAW_ACCELERATION: asked[2],
            Variable.HEADING: self.phi,
            Variable.POSITION_X: self.origin[0],
            Variable.POSITION_Y: self.origin[1],
            Variable.TIME: self.t,
        }
        return float(values[variable])

    def of_wheels(self, variable: Variable, side: int, load: Array, place: Array) -> Array:
        """The variable of every wheel (N,), seen along ĝ (side 0) or f̂ (side 1), and from a floor place."""
        c, u = self.model.geometry, self.slip[side]
        rolling = np.maximum(np.hypot(*self.hub.T), np.abs(c.radius_m * self.omega))
        if variable is Variable.WHEEL_ANGLE:
            return np.asarray(self.theta)
        if variable is Variable.WHEEL_LOAD:
            return np.asarray(load / (self.model.inertia.weight_N / c.count) - 1.0)
        if variable is Variable.SLIP_SPEED:
            return np.asarray(np.abs(u))
        if variable is Variable.SLIP_RATIO:
            return np.asarray(np.abs(u) / (rolling + 1e-3))
        if variable is Variable.SLIP_ANGLE:
            return np.asarray(np.arctan2(np.abs(self.slip[1]), np.abs(self.slip[0])))
        if variable is Variable.ROLLING_SPEED:
            return np.asarray(rolling)
        if variable is Variable.HUB_SPEED:
            return np.asarray(np.hypot(*self.hub.T))
        if variable is Variable.PASSING_SPEED:
            tread = self.hub - self.slip[0][:, None] * c.grip
            return np.asarray(np.hypot(*((1.0 - place[0]) * self.hub + place[0] * tread).T))
        if variable is Variable.SLIP_HEADING:
            axis = (c.grip, c.free)[side]
            return np.asarray(self.phi + np.arctan2(axis[:, 1], axis[:, 0]) + np.where(u < 0.0, np.pi, 0.0))
        if variable is Variable.SLIP_DIRECTION:
            slid = self.slip[0][:, None] * c.grip + self.slip[1][:, None] * c.free
            return np.asarray(self.phi + np.angle(slid @ np.array([1.0, 1j])))
        if variable is Variable.FROM_PLACE:
            return np.asarray(np.linalg.norm(self.contact - place[:2], axis=1))
        if variable is Variable.BEFORE_LINE:
            normal = np.array([np.cos(place[2]), np.sin(place[2])])
            return np.asarray((place[:2] - self.contact) @ normal)
        return np.full(c.count, self.of_body(variable))


def _functions(basis: Basis, shape: Array, count: int, v: float) -> Array:
    """All functions of a family at v (count,), written out again from what :class:`Basis` says of them."""
    (a, b), order = shape, np.arange(1, count + 1)
    if basis is Basis.CONSTANT:
        return np.ones(count)
    if basis is Basis.POLYNOMIAL:
        return np.asarray(np.power(v / a, order))
    if basis is Basis.FOURIER:
        turns = np.exp(2j * np.pi * v / a * ((order + 1) // 2))
        return np.where(order % 2 == 1, turns.real, turns.imag)
    if basis is Basis.HATS:
        knots = np.linspace(a, b, count)
        return np.array([np.interp(v, knots, row) for row in np.eye(count)])
    if basis is Basis.DECAY:
        return np.full(count, np.expm1(-np.power(abs(v) / a, b)))
    if basis is Basis.RECIPROCAL:
        return np.full(count, (a - b - v) / (v + b))
    if basis is Basis.WINDOW:
        return np.full(count, float(a <= v < b))
    if basis is Basis.ODD:
        powers = np.sign(v) * np.power(abs(v), order - 1.0)
        return np.append(2.0 / np.pi * np.arctan2(v, a), powers[1:])
    if basis is Basis.LOBE:
        half = (1.0 - np.cos(v - a)) / (1.0 - np.cos(0.5 * b))
        return np.full(count, 1.0 / (1.0 + np.power(half, 16.0)))
    assert basis is Basis.STEP, basis
    return np.full(count, 1.0 / (1.0 + np.exp((v - a) / b)))


def _saturation(law: int, x: Array | float) -> Array:
    """The three friction laws, written out again."""
    x = np.asarray(x, dtype=float)
    if law == 1:
        return np.asarray(-np.expm1(-2.0 * np.abs(x)) / (1.0 + np.exp(-2.0 * np.abs(x))) * np.sign(x))
    return np.asarray(x / np.hypot(1.0, x) if law == 2 else 2.0 / np.pi * np.arctan(x))


def _coefficients(at: _Instant, rigid: Array, load: Array) -> tuple[Array, Array]:
    """μ (2, N) and k (2, N) after every modulation."""
    grip = at.model.grip
    mu = np.where(rigid[:, None], grip.rigid, grip.roller).T.copy()
    k = np.full_like(mu, grip.k_s_per_m)
    for m in grip.multipliers:
        for side in (0, 1):
            factor = _factor(m, at, side, load)
            if m.target is Target.STIFFNESS or int(m.target) == 4 + side:
                k[side] *= factor
            elif m.target is Target.BOTH or int(m.target) == side:
                mu[side] *= factor
    return mu, k


def _factor(m: Multiplier, at: _Instant, side: int, load: Array) -> Array:
    values = at.of_wheels(m.variable, side, load, m.place)
    sums = [m.coefficients @ _functions(m.basis, m.shape, len(m.coefficients), float(v)) for v in values]
    return np.maximum(0.0, 1.0 + m.wheels * np.array(sums))


def _law(law: int, shape: GripShape, coupling: float, u: Array, mu: Array, k: Array) -> Array:
    """(f_W, f_T) per unit of load of one wheel."""
    boxed = mu * _saturation(law, k * u)
    if shape is GripShape.BOX or coupling == 0.0 or mu[0] <= 0.0:
        return np.asarray(boxed)
    if shape is GripShape.ELLIPSE:
        e = (mu[1] / mu[0]) ** 2
        s = np.sqrt(u[0] ** 2 + e * u[1] ** 2)
        coupled = (
            mu[0] * _saturation(law, k[0] * s) * np.array([u[0], e * u[1]]) / s if s > 0.0 else np.zeros(2)
        )
    else:
        coupled = _disc_strip(law, u, mu, k[0])
    return np.asarray((1.0 - coupling) * boxed + coupling * coupled)


def _disc_strip(law: int, u: Array, mu: Array, k: float) -> Array:
    def disc(z: float) -> Array:
        s = float(np.hypot(u[0], z))
        return (
            np.asarray(mu[0] * _saturation(law, k * s) * np.array([u[0], z]) / s) if s > 0.0 else np.zeros(2)
        )

    full = disc(u[1])
    if abs(full[1]) <= mu[1]:
        return full
    if mu[1] == 0.0:
        return disc(0.0)
    z = brentq(lambda x: disc(x)[1] - mu[1], 0.0, abs(u[1]), xtol=1e-18, rtol=8.9e-16)
    return np.array([disc(z)[0], np.copysign(mu[1], u[1])])


def _push_of_terms(at: _Instant) -> tuple[Array, Array, float]:
    """Of all force terms: wrench (3,) in the body frame, Σ height × force (2,), upward force."""
    total, tilting, lift = np.zeros(3), np.zeros(2), 0.0
    for term in at.model.external.terms:
        v = at.of_body(term.variable)
        w = term.coefficients @ _functions(term.basis, term.shape, term.coefficients.shape[1], v)
        if term.frame is Frame.FLOOR:
            w = np.append(at.turn.T @ w[:2], w[2])
        elif term.frame in (Frame.AGAINST_MOTION, Frame.AT_PLACE):
            here = at.velocity + at.twist[2] * np.array([-term.place_m[1], term.place_m[0]])
            d = here / np.sqrt(here @ here + 1e-6)
            left = np.array([-d[1], d[0]])
            rate = at.twist[2] / np.sqrt(at.twist[2] ** 2 + 1e-4)
            w = np.append(-w[0] * d + w[1] * left, -w[2] * rate)
            if term.frame is Frame.AT_PLACE:
                w[2] += np.linalg.det([term.place_m - at.model.inertia.com_m, w[:2]])
        total += w
        height = at.model.inertia.com_height_m if term.height_m is None else term.height_m
        tilting += height * w[:2]
        lift += term.lift_N
    return total, tilting, lift


def _slopes(model: Model, contact: Array) -> Array:
    """∇h (N, 2) of the floor under contacts (N, 2): of heights written out again, by a complex step."""
    total = np.zeros_like(contact)
    for r in model.external.reliefs:
        if r.profile is Profile.BUMP:
            for axis in range(2):
                z = contact - np.array(r.place) + 1e-30j * np.eye(2)[axis]
                high = r.size * 0.5 ** (4.0 * np.sum(z**2, axis=1) / r.extent_m**2)
                total[:, axis] += np.imag(high) / 1e-30
            continue
        normal = np.array([np.cos(r.place[1]), np.sin(r.place[1])])
        d = contact @ normal - r.place[0] + 1e-30j
        if r.profile is Profile.RAMP:
            steep = r.size * (expit(d.real / r.edge_m) - expit((d.real - r.extent_m) / r.edge_m))
        else:
            steep = np.imag(r.size * 0.5 ** ((2.0 * d / r.extent_m) ** 2)) / 1e-30
        total = total + steep[:, None] * normal
    return total


def acceleration(
    model: Model,
    t: float,
    state: Array,
    wheels: tuple[Array, Array, Array],
    rigid: Array,
    push: Array,
    push_height_m: float = 0.0,
    guess: Array | None = None,
) -> tuple[Array, Array, Array, Array]:
    """(a_x, a_y, ω̇) in body axes, slip (2, N), force on the wheels (2, N), loads (N,).

    The loads follow the acceleration: the fixed point N = N0 + P a is found by Newton's method on a,
    from ``guess``.
    Forces at a height shift the loads N0: the least change δ with Σ δ_i = 0 and Σ δ_i p_i = Σ h_k F_k.
    Where a wheel would be pulled down, :func:`pressing` says what each carries.
    """
    at = _Instant(model, t, state, wheels)
    model = at.model
    arm = model.geometry.position_m - model.inertia.com_m
    outside, tilting, lift = _push_of_terms(at)
    pushed = at.turn.T @ push[:2]
    outside, tilting = outside + np.append(pushed, push[2]), tilting + push_height_m * pushed
    balance = np.vstack([np.ones(model.count), model.geometry.position_m.T])
    shifted = np.linalg.lstsq(balance, np.append(0.0, tilting), rcond=None)[0]
    still = model.loads.rest_N * (1.0 - lift / model.loads.rest_N.sum()) + shifted
    viscous = model.grip.viscous_N_s_per_m[:, None] * at.slip
    hill = _slopes(model, at.contact) @ at.turn

    def result(a: Array) -> tuple[Array, Array, Array]:
        load = pressing(balance.T, still + model.loads.per_acceleration_kg @ a)
        mu, k = _coefficients(at, rigid, load)
        f = np.array(
            [
                _law(model.grip.law, model.grip.shape, model.grip.coupling, at.slip[:, i], mu[:, i], k[:, i])
                for i in range(model.count)
            ]
        ).T
        force = -(load * f) - viscous
        xy = force[0][:, None] * model.geometry.grip + force[1][:, None] * model.geometry.free
        xy = xy - load[:, None] * hill
        total = outside + np.append(xy.sum(axis=0), np.sum(arm[:, 0] * xy[:, 1] - arm[:, 1] * xy[:, 0]))
        return total / np.array([model.inertia.mass_kg] * 2 + [model.inertia.inertia_kg_m2]), force, load

    a = np.zeros(2) if guess is None else np.array(guess)
    for _ in range(50):
        out, force, load = result(a)
        if not model.loads.per_acceleration_kg.any():
            break
        miss = out[:2] - a
        if np.max(np.abs(miss)) <= 1e-13 * (1.0 + np.max(np.abs(a))):
            break
        d = 1e-4
        slope = np.column_stack([(result(a + d * e)[0][:2] - out[:2]) / d for e in np.eye(2)])
        a = a + np.linalg.solve(np.eye(2) - slope, miss)
    else:
        raise ArithmeticError(f"Newton's steps did not end: {miss} m/s² are left at t = {t} s")
    return out, at.slip, force, load


def pressing(plane: Array, load: Array) -> Array:
    """The loads N ≥ 0 nearest to ``load`` that have its sum and moments, by trying every set of wheels.

    ``plane`` (N, 3) rows 1, x, y.  Where no loads do (it tips), the floor pulls
    as little as would keep the robot upright, and the wheels that press there carry the weight.
    """
    if np.min(load) >= 0.0:
        return load
    found = []
    for count in range(3, len(load)):
        for touch in map(list, itertools.combinations(range(len(load)), count)):
            left = plane.T @ load - plane[touch].T @ load[touch]
            step, _, rank, _ = np.linalg.lstsq(plane[touch].T, left, rcond=1e-9)
            trial = np.zeros_like(load)
            trial[touch] = load[touch] + step
            if rank == 3 and np.min(trial) >= -1e-12 * np.sum(np.abs(load)):
                found.append(np.maximum(trial, 0.0))
    if found:
        return min(found, key=lambda trial: float(np.sum((trial - load) ** 2)))
    each, exact, loose = len(load), 1e6, 1e-6  # a wheel in the air is held by a spring this weak
    springs = np.diag(np.append(np.full(each, np.sqrt(loose)), np.ones(each)))
    rows = np.vstack([exact * np.hstack([plane.T, -plane.T]), springs])
    wanted = np.concatenate([exact * (plane.T @ load), np.sqrt(loose) * load, -loose * load])
    both = nnls(rows, wanted)[0]
    return both[:each] * (np.sum(load) / np.sum(both[:each]))


def reference_motion(
    model: Model,
    wheels: WheelMotion,
    knots_s: Array,
    times_s: Array,
    *,
    start: Array | None = None,
    push: PushOf | None = None,
    push_height_m: float = 0.0,
    rtol: float = 1e-11,
    atol: float = 1e-13,
    edges_s: Array | None = None,
    method: str = "LSODA",
) -> Array:
    """Pose (T, 3) of the body frame's origin at ``times_s``.

    Parameters
    ----------
    wheels : function of time
        Wheel motion, smooth between ``knots_s``.
    start : array (6,), optional
        Origin pose and body-frame velocity of the centre of mass at the first knot.
    edges_s : array, optional
        Further instants at which a force jumps or kinks.
    """
    push_of = push or (lambda t: np.zeros(3))
    y = np.zeros(6) if start is None else np.array(start, dtype=float)
    turn = np.array([[np.cos(y[2]), -np.sin(y[2])], [np.sin(y[2]), np.cos(y[2])]])
    y[:2] += turn @ model.inertia.com_m
    stops = _all_stops(model, wheels, knots_s, edges_s)
    poses = np.empty((len(times_s), 3))
    for low, high in itertools.pairwise(stops):
        inside = slice(low, high)
        rigid = _rigid(model, wheels(0.5 * (low + high))[0])

        def rhs(t: float, y: Array, rigid: Array = rigid, inside: slice = inside) -> Array:
            t = min(max(t, np.nextafter(inside.start, np.inf)), np.nextafter(inside.stop, -np.inf))
            acc = acceleration(model, t - knots_s[0], y, wheels(t), rigid, push_of(t), push_height_m)[0]
            c, s, w = np.cos(y[2]), np.sin(y[2]), y[5]
            return np.array(
                [c * y[3] - s * y[4], s * y[3] + c * y[4], w, acc[0] + w * y[4], acc[1] - w * y[3], acc[2]]
            )

        asked = np.flatnonzero((times_s >= low) & (times_s <= high))
        when = np.append(times_s[asked], high)
        done = solve_ivp(rhs, (low, high), y, method=method, t_eval=np.unique(when), rtol=rtol, atol=atol)
        assert done.success, done.message
        for j in asked:
            state = done.y[:, np.argmin(np.abs(done.t - times_s[j]))]
            c, s = np.cos(state[2]), np.sin(state[2])
            poses[j] = np.append(state[:2] - np.array([[c, -s], [s, c]]) @ model.inertia.com_m, state[2])
        y = done.y[:, -1]
    return poses


def played(wheels: WheelMotion, knots_s: Array, play_rad: Array) -> tuple[WheelMotion, Array]:
    """What wheels do behind whole plays (N,) for what their motors do, and all instants at which that kinks.

    From rest in the middle: the sequence of clips on a fine grid, its changes made sharp by bisection.
    """
    half, grid = 0.5 * play_rad, np.linspace(knots_s[0], knots_s[-1], 4001)
    motor = np.array([wheels(t)[0] for t in grid])
    rest, sense = motor[0].copy(), np.where(half > 0.0, 0, 1)
    rows: list[list[tuple[float, int, float]]] = [
        [(grid[0], int(s), float(r))] for s, r in zip(sense, rest, strict=True)
    ]
    for low, high in itertools.pairwise(grid):
        for i in np.flatnonzero(half):
            start, s, at = rows[i][-1]
            inner = [low, high]
            if wheels(low)[1][i] * wheels(high)[1][i] < 0.0:
                inner.insert(1, brentq(lambda t, i=i: wheels(t)[1][i], low, high, xtol=1e-15))
            for a, b in itertools.pairwise(inner):
                up = np.sign(wheels(b)[0][i] - wheels(a)[0][i])
                if s == -up and s:
                    s, at = 0, wheels(a)[0][i] + up * half[i]
                    rows[i].append((a, 0, at))
                if s == 0 and up and up * (wheels(b)[0][i] - at) > half[i]:

                    def gap(t: float, i: int = i, goal: float = at + up * half[i]) -> float:
                        return float(wheels(t)[0][i] - goal)

                    s, start = int(up), a if gap(a) * up >= 0.0 else brentq(gap, a, b, xtol=1e-15)
                    rows[i].append((start, s, 0.0))

    def behind(t: float) -> tuple[Array, Array, Array]:
        theta, omega, alpha = (np.array(x) for x in wheels(t))
        for i, changes in enumerate(rows):
            _, s, at = [c for c in changes if c[0] <= t][-1]
            theta[i] = theta[i] - s * half[i] if s else at
            omega[i], alpha[i] = omega[i] * bool(s), alpha[i] * bool(s)
        return theta, omega, alpha

    return behind, np.unique([*knots_s, *(c[0] for changes in rows for c in changes)])


def _rigid(model: Model, theta: Array) -> Array:
    pitch = 2.0 * np.pi / model.grip.rollers
    return np.asarray(np.mod(theta, pitch) >= (1.0 - model.grip.rigid_fraction) * pitch)


def _all_stops(model: Model, wheels: WheelMotion, knots_s: Array, edges_s: Array | None) -> Array:
    """Knots, edges and sector switches; switches are bracketed on a fine grid, then found by bisection."""
    found = [*knots_s, *([] if edges_s is None else edges_s)]
    pitch = 2.0 * np.pi / model.grip.rollers
    for low, high in itertools.pairwise(knots_s):
        grid = np.linspace(low, high, 400)
        theta = np.array(
            [wheels(min(max(t, np.nextafter(low, np.inf)), np.nextafter(high, -np.inf)))[0] for t in grid]
        )
        for i in range(model.count):
            for share in (0.0, 1.0 - model.grip.rigid_fraction[i]):
                wave = np.sin(np.pi * (theta[:, i] / pitch[i] - share))  # zero at each edge
                for k in np.flatnonzero(wave[:-1] * wave[1:] < 0.0):

                    def edge(t: float, i: int = i, share: float = share) -> float:
                        return float(np.sin(np.pi * (wheels(t)[0][i] / pitch[i] - share)))

                    found.append(brentq(edge, grid[k], grid[k + 1], xtol=1e-15, rtol=8.9e-16))
    stops = np.unique(np.array(found))
    return np.asarray(stops[np.append(True, np.diff(stops) > 1e-11)])
