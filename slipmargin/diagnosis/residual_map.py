"""The residual map: which measured variables the unexplained motion follows, before anything is simulated.

What the model did not predict is the velocity residual in the body frame: measured less predicted, each
rotated by its own heading, so that nothing adds up along a run and nothing can diverge.  For every variable
it is regressed on features that are linear in their coefficients: a force that depends on the variable,
friction that depends on it, or a wheel's rolling that does.  A push acts on the velocity until the wheels
have caught the robot again, so features of forces are low-passed.

The share of the residual that a variable explains is that on runs left out in turn.  Its significance
comes from permuting whole runs: each run's residual is set beside another run's variables.  A variable
that is the same in every run, time, has no such null; there whole runs change their sign instead.  The
probability is that of the best of all variables, so their number is counted in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.odometry import bridged, wheel_angles
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.prepare import Trial
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Trace
from slipmargin.model import Model
from slipmargin.physics.frames import to_body
from slipmargin.physics.sectors import pitch
from slipmargin.physics.terms import basis_values
from slipmargin.physics.variables import Basis

#: Ridge of the regression, as a share of the mean square of a feature over all runs.
_RIDGE = 0.02


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """What is measured of one trial at the map's instants.

    ``left`` (T, 3) velocity residual; ``pose``, ``twist``, ``asked`` (T, 3) measured pose, the wheels'
    no-slip twist and its rate; ``angle``, ``speed`` (T, N) of the wheels; all body frame but the pose;
    ``scale`` (3,) the residual's noise; ``step_s`` between instants.
    """

    t_s: Array
    left: Array
    pose: Array
    twist: Array
    asked: Array
    angle: Array | None
    speed: Array
    scale: Array
    step_s: float


def residual_map(problem: Problem, predicted: Array, runs: Sequence[int], seed: int) -> tuple[MapEntry, ...]:
    """The map of what ``predicted`` (R, T, 3) leaves of a problem's trials, strongest variable first.

    Parameters
    ----------
    runs : sequence of int
        The run that each trial is, or is cut from: they are left out and permuted together.
    seed : int
        Seed of the permutations.
    """
    model = problem.model(())
    motions = [
        motion(t, p[: len(t.t_s)], model, problem.sigma, problem.commanded)
        for t, p in zip(problem.trials, predicted, strict=True)
    ]
    arm = float(np.sqrt(model.inertia.inertia_kg_m2 / model.inertia.mass_kg))
    groups = [
        (trace, form, features) for trace, form, features in _features(motions, model) if features[0].shape[2]
    ]
    order, signs = _permutations(len(motions), seed)
    left = _weighted(motions, arm)
    real, null = [], []
    for trace, _, features in groups:
        weighted = [_stacked(f, m, arm) for f, m in zip(features, motions, strict=True)]
        shares = _shares(weighted, left, runs, order, signs if trace is Trace.TIME else None)
        real.append(shares[0])
        null.append(shares[1:])
    highest = np.max(null, axis=0)
    entries = [
        MapEntry(
            traced_to=trace,
            form=form,
            share=float(share),
            p_value=float((1 + np.sum(highest >= share)) / (1 + len(highest))),
        )
        for (trace, form, _), share in zip(groups, real, strict=True)
    ]
    best: dict[Trace, MapEntry] = {}
    for entry in sorted(entries, key=lambda e: -e.share):
        best.setdefault(entry.traced_to, entry)
    return tuple(best.values())


def motion(trial: Trial, predicted: Array, model: Model, sigma: Array, commanded: bool) -> Motion:
    """The velocity residual and the variables of one trial."""
    t = trial.t_s
    step = float(np.median(np.diff(t)))
    half = max(1, round(SETTINGS.map_span_s / 2.0 / step))
    every = max(1, round(SETTINGS.map_step_s / step))
    rows = np.arange(half, max(half + 1, len(t) - half), every)
    low, high = np.maximum(rows - half, 0), np.minimum(rows + half, len(t) - 1)
    span = (t[high] - t[low])[:, None]
    pose = np.nan_to_num(bridged(t, trial.pose))
    left = np.zeros((len(rows), 3))
    for values, sign in ((pose, 1.0), (predicted, -1.0)):
        rate = (values[high] - values[low]) / span
        middle = 0.5 * (values[high, 2] + values[low, 2])
        left[:, 0] += sign * to_body(middle, rate[:, 0], rate[:, 1])[0]
        left[:, 1] += sign * to_body(middle, rate[:, 0], rate[:, 1])[1]
        left[:, 2] += sign * rate[:, 2]
    ends = np.isfinite(trial.pose[low]).all(axis=1) & np.isfinite(trial.pose[high]).all(axis=1)
    left[~(ends & np.isfinite(left).all(axis=1))] = 0.0
    record = trial.record
    speeds = record.omega_cmd if commanded or record.omega is None else record.omega
    assert speeds is not None, f"{trial.name} has no wheel speeds"
    omega = bridged(t, speeds)
    twist = omega @ model.geometry.no_slip_map().T
    angle = wheel_angles(t, record.theta, record.omega)
    return Motion(
        t_s=t[rows] - t[0],
        left=left,
        pose=pose[rows],
        twist=twist[rows],
        asked=(twist[high] - twist[low]) / span,
        angle=None if angle is None or record.theta is None else angle[rows],
        speed=omega[rows],
        scale=np.sqrt(2.0) * np.asarray(sigma) / float(np.median(span)),
        step_s=every * step,
    )


def _features(motions: list[Motion], model: Model) -> list[tuple[Trace, str, list[Array]]]:
    """Groups of features: variable, form, and of each trial (T, 3, P) velocities."""
    place = np.concatenate([m.pose[:, :2] for m in motions])
    corner, reach = place.min(axis=0), np.maximum(np.ptp(place, axis=0), 1e-3)
    clock = max(float(m.t_s[-1]) for m in motions)
    knots = max(4, round(clock / SETTINGS.map_knot_s))
    roll = model.geometry.no_slip_map()
    period = pitch(np.asarray(model.grip.rollers, dtype=float))
    top = np.maximum(1e-6, np.max([np.quantile(np.abs(m.twist), 0.98, axis=0) for m in motions], axis=0))

    def cells(m: Motion) -> Array:
        z = (m.pose[:, :2] - corner) / reach
        x, y = (basis_values(Basis.HATS, np.array([0.0, 1.0]), SETTINGS.map_cells, z[:, i]) for i in (0, 1))
        return np.asarray(np.einsum("ti,tj->tij", x, y).reshape(len(z), -1))

    def heading(m: Motion) -> Array:
        return basis_values(Basis.FOURIER, np.array([2.0 * np.pi, 0.0]), 4, m.pose[:, 2])

    def time(m: Motion) -> Array:
        return basis_values(Basis.HATS, np.array([0.0, clock]), knots, m.t_s)

    def one(m: Motion) -> Array:
        return np.ones((len(m.t_s), 1))

    def drag(m: Motion) -> Array:
        z = m.twist / top
        rows = np.stack([z, z * np.abs(z), np.tanh(10.0 * z)], axis=2)
        return np.asarray(np.einsum("tab,ac->tcab", rows, np.eye(3)).reshape(len(z), 3, -1))

    def turning(m: Motion, orders: int, periods: Array) -> Array:
        if m.angle is None:
            return np.zeros((len(m.t_s), 3, 0))
        parts = [
            _kinematic(m, roll, i, basis_values(Basis.FOURIER, np.array([periods[i], 0.0]), orders, angle))
            for i, angle in enumerate(m.angle.T)
        ]
        return np.concatenate(parts, axis=2)

    def gripping(m: Motion) -> Array:
        if m.angle is None:
            return np.zeros((len(m.t_s), 3, 0))
        waves = [
            basis_values(Basis.FOURIER, np.array([period[i], 0.0]), 4, angle)
            for i, angle in enumerate(m.angle.T)
        ]
        return np.concatenate([_deficit(m, wave) for wave in waves], axis=2)

    full_turn = np.full(len(period), 2.0 * np.pi)
    return [
        (Trace.POSITION, "friction over the place", [_deficit(m, cells(m)) for m in motions]),
        (Trace.POSITION, "force over the place", [_floor_force(m, cells(m)) for m in motions]),
        (Trace.TIME, "force over time", [_floor_force(m, time(m)) for m in motions]),
        (Trace.TIME, "force over time, fixed to the robot", [_body_force(m, time(m)) for m in motions]),
        (Trace.HEADING, "force over heading", [_floor_force(m, heading(m)) for m in motions]),
        (Trace.HEADING, "friction over heading", [_deficit(m, heading(m)) for m in motions]),
        (
            Trace.CONSTANT_FORCE,
            "a constant force",
            [np.concatenate([_floor_force(m, one(m)), _body_force(m, one(m))], axis=2) for m in motions],
        ),
        (Trace.VELOCITY, "drag along each velocity", [drag(m) for m in motions]),
        (Trace.ACCELERATION, "proportional to acceleration", [_body_linear(m) for m in motions]),
        (Trace.WHEEL_ANGLE, "once and twice a turn", [turning(m, 4, full_turn) for m in motions]),
        (Trace.WHEEL_ANGLE, "once a roller, rolling", [turning(m, 4, period) for m in motions]),
        (Trace.WHEEL_ANGLE, "once a roller, gripping", [gripping(m) for m in motions]),
        (
            Trace.WHEEL,
            "rolling of each wheel",
            [
                np.concatenate([_kinematic(m, roll, i, one(m)) for i in range(roll.shape[1])], axis=2)
                for m in motions
            ],
        ),
    ]


def _kinematic(m: Motion, roll: Array, wheel: int, phi: Array) -> Array:
    """Body twist that a wheel adds if its rolling speed errs by the share φ: (T, 3, P)."""
    return np.asarray(np.einsum("c,t,tp->tcp", roll[:, wheel], m.speed[:, wheel], phi))


def _deficit(m: Motion, phi: Array) -> Array:
    """Velocity lost where the asked acceleration is missed by the share φ: (T, 3, P)."""
    return _low_passed(np.einsum("tc,tp->tcp", m.asked, phi), m.step_s)


def _body_linear(m: Motion) -> Array:
    moved = np.einsum("tb,ac->tacb", m.asked, np.eye(3)).reshape(len(m.t_s), 3, -1)
    return _low_passed(moved, m.step_s)


def _body_force(m: Motion, phi: Array) -> Array:
    moved = np.einsum("tp,ac->tacp", phi, np.eye(3)).reshape(len(m.t_s), 3, -1)
    return _low_passed(moved, m.step_s)


def _floor_force(m: Motion, phi: Array) -> Array:
    """Body-frame acceleration by a force with floor axes, and by a moment: (T, 3, 3 P)."""
    x = np.stack([*to_body(m.pose[:, 2], 1.0, 0.0), np.zeros(len(phi))], axis=1)
    y = np.stack([*to_body(m.pose[:, 2], 0.0, 1.0), np.zeros(len(phi))], axis=1)
    turn = np.tile([0.0, 0.0, 1.0], (len(phi), 1))
    moved = np.concatenate([np.einsum("tc,tp->tcp", axis, phi) for axis in (x, y, turn)], axis=2)
    return _low_passed(moved, m.step_s)


def _low_passed(values: Array, step_s: float) -> Array:
    """First-order low-pass along time: how long a push stays in the velocity."""
    from scipy.signal import lfilter

    keep = float(np.exp(-step_s / SETTINGS.map_memory_s))
    return np.asarray(lfilter([1.0 - keep], [1.0, -keep], values, axis=0))


def _weights(m: Motion, arm: float) -> tuple[Array, float]:
    """Units that make turning comparable with moving, and a weight so that no run outweighs all."""
    unit = np.array([1.0, 1.0, arm])
    size = np.mean(np.square(m.left * unit))
    noise = np.mean(np.square(m.scale * unit))
    return unit, float(1.0 / np.sqrt(size + noise))


def _weighted(motions: list[Motion], arm: float) -> list[Array]:
    out = []
    for m in motions:
        unit, weight = _weights(m, arm)
        out.append((m.left * unit * weight).ravel())
    return out


def _stacked(feature: Array, m: Motion, arm: float) -> Array:
    unit, weight = _weights(m, arm)
    return np.asarray((feature * unit[None, :, None] * weight).reshape(-1, feature.shape[2]))


def _permutations(count: int, seed: int) -> tuple[Array, Array]:
    """Orders (D, R) of the runs, the first as they are, and signs (D, R) likewise."""
    random = np.random.default_rng(seed)
    many = SETTINGS.map_permutations
    order = np.array([np.arange(count), *(random.permutation(count) for _ in range(many))])
    signs = np.vstack([np.ones(count), random.choice([-1.0, 1.0], size=(many, count))])
    return order, signs


def _shares(
    features: list[Array], left: list[Array], runs: Sequence[int], order: Array, signs: Array | None
) -> Array:
    """Share (D,) that features explain on left-out runs: the runs as they are, then permuted."""
    count = len(left)
    size = np.sqrt(np.mean([np.mean(f**2, axis=0) for f in features], axis=0))
    scaled = [f / np.maximum(size, 1e-12) for f in features]
    normal = np.array([f.T @ f for f in scaled])
    ridge = _RIDGE * np.eye(len(size)) * sum(len(f) for f in scaled)
    cross = np.zeros((count, count, len(size)))  # features of the first run, residual of the second
    square = np.zeros((count, count))
    for i, feature in enumerate(scaled):
        for j, values in enumerate(left):
            rows = min(len(values), len(feature))
            cross[i, j] = feature[:rows].T @ values[:rows]
            square[i, j] = float(values[:rows] @ values[:rows])
    everyone = np.arange(count)
    if signs is None:
        pulls = cross[everyone, order]  # (D, R, P)
        total = square[everyone, order]
    else:
        pulls = cross[everyone, everyone][None] * signs[:, :, None]
        total = np.tile(square[everyone, everyone], (len(signs), 1))
    missed = np.zeros(len(pulls))
    for part in np.unique(runs):
        own = np.flatnonzero(np.asarray(runs) == part)
        rest = np.setdiff1d(everyone, own)
        found = np.linalg.solve(normal[rest].sum(axis=0) + ridge, pulls[:, rest].sum(axis=1).T).T
        for at in own:
            missed += total[:, at] - 2.0 * np.einsum("dp,dp->d", found, pulls[:, at])
            missed += np.einsum("dp,pq,dq->d", found, normal[at], found)
    return np.asarray(1.0 - missed / np.maximum(total.sum(axis=1), 1e-300))
