"""Probes: dependences that no candidate writes, as velocities that come on top of the predicted motion.

A probe has no law that could be simulated.  It is a body-frame velocity disturbance, linear in its
coefficients, that is added up along the predicted path, or a shift of the pose as it is seen, and stands in
the screened list beside the tangents of the candidates: it can lead to a variable, and is never claimed.  A
push acts on the velocity until the wheels have caught the robot again, so that forces are low-passed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.odometry import bridged, wheel_angles
from slipmargin.diagnosis.fit import Fit
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.tangents import Columns
from slipmargin.effects import Trace
from slipmargin.model import Model
from slipmargin.physics.frames import to_body, to_floor
from slipmargin.physics.kinematics import integrated
from slipmargin.physics.sectors import pitch
from slipmargin.physics.terms import basis_values
from slipmargin.physics.variables import Basis

#: Step of the difference quotient: as far as the noise, root mean square.
_STEP = 1.0
#: Gaussian prior of every coefficient [1 / such steps]: it matters only where no trial has been.
_PRIOR = 1.0 / 30.0


class _Motion:
    """Times (T,), pose (T, 3) predicted, wheel speeds (T, N) and angles (T, N or None) of one trial."""

    def __init__(self, problem: Problem, row: int, pose: Array) -> None:
        trial = problem.trials[row]
        self.t_s = trial.t_s
        self.since = trial.record.since_s
        self.step_s = float(np.median(np.diff(trial.t_s)))
        self.pose = pose[: len(trial.t_s)]
        record = trial.record
        speeds = record.omega_cmd if problem.commanded else record.omega
        if speeds is None and record.theta is not None:
            self.speed = np.gradient(bridged(trial.t_s, record.theta), trial.t_s, axis=0)
        else:
            assert speeds is not None, f"{trial.name} has no wheel speeds"
            self.speed = bridged(trial.t_s, speeds)
        angle = wheel_angles(trial.t_s, record.theta, record.omega)
        self.angle = None if record.theta is None else angle

    def floor_force(self, phi: Array) -> Array:
        """Velocity by a force with floor axes, and by a moment, of each function (T, P): (T, 3, 3 P)."""
        x = np.stack([*to_body(self.pose[:, 2], 1.0, 0.0), np.zeros(len(phi))], axis=1)
        y = np.stack([*to_body(self.pose[:, 2], 0.0, 1.0), np.zeros(len(phi))], axis=1)
        turn = np.tile([0.0, 0.0, 1.0], (len(phi), 1))
        parts = [np.einsum("tc,tp->tcp", axis, phi) for axis in (x, y, turn)]
        return self._kept(np.concatenate(parts, axis=2))

    def body_force(self, phi: Array) -> Array:
        """The same with body axes."""
        return self._kept(np.einsum("tp,ac->tacp", phi, np.eye(3)).reshape(len(phi), 3, -1))

    def _kept(self, values: Array) -> Array:
        """What is left of ``values`` (T, ...): y_k = keep y_{k−1} + (1 − keep) v_k."""
        from scipy.linalg import solve_banded

        keep = float(np.exp(-self.step_s / SETTINGS.probe_memory_s))
        bands = np.array([[1.0], [-keep]]) * np.ones(len(values))
        flat = (1.0 - keep) * values.reshape(len(values), -1)
        return np.asarray(solve_banded((1, 0), bands, flat, check_finite=False).reshape(values.shape))

    def added_up(self, velocity: Array) -> Array:
        """How far (T, 3, P) a body-frame velocity (T, 3, P) moves the robot from its predicted path."""
        x, y = to_floor(self.pose[:, 2, None], velocity[:, 0], velocity[:, 1])
        turn = integrated(self.t_s, velocity[:, 2])
        rate = np.gradient(self.pose, self.t_s, axis=0)
        along = x - turn * rate[:, 1:2], y + turn * rate[:, 0:1]
        return np.stack([*(integrated(self.t_s, r) for r in along), turn], axis=1)

    def seen_through_a_lens(self) -> Array:
        """Shifts (T, 3, 18) along x and y by every product x^i y^j, 1 ≤ i + j ≤ 3, of the place [m]."""
        x, y = self.pose[:, :1], self.pose[:, 1:2]
        powers = np.concatenate([x**i * y**j for i in range(4) for j in range(4 - i) if i + j], axis=1)
        nothing = np.zeros_like(powers)
        along = [(powers, nothing), (nothing, powers)]
        return np.concatenate([np.stack([*pair, nothing], axis=1) for pair in along], axis=2)


def probes(problem: Problem, base: Fit) -> list[Columns]:
    """Every probe on the trials of ``base``, in the view of ``problem``."""
    pose = problem.predict([base.effects], [base.trials])[0]
    motions = [_Motion(problem, int(row), p) for row, p in zip(base.trials, pose, strict=True)]
    found = []
    for trace, label, velocity in _velocities(motions, problem.model(base.effects), problem.commanded):
        moved = [m.added_up(velocity(m)) for m in motions]
        if moved[0].shape[2]:
            found.append(_columns(problem, base, pose, moved, trace, label))
    lens = [m.seen_through_a_lens() for m in motions]
    return [
        *found,
        _columns(problem, base, pose, lens, Trace.MEASUREMENT, "pose over the place, as by a lens"),
    ]


def _columns(
    problem: Problem, base: Fit, pose: Array, moved: list[Array], trace: Trace, label: str
) -> Columns:
    many = moved[0].shape[2]
    size = np.sqrt(np.mean([np.mean((m / problem.sigma[:, None]) ** 2, axis=(0, 1)) for m in moved], axis=0))
    here = problem.gaps(pose, base.trials)[1]
    columns = np.zeros((*base.residual.shape, many))
    for j in range(many):
        if size[j] <= 0.0:
            continue
        there = pose.copy()
        for row, m in zip(there, moved, strict=True):
            row[: len(m)] += _STEP * m[:, :, j] / size[j]
        change = (problem.gaps(there, base.trials)[1] - here) / _STEP
        columns[:, :, j] = change.transpose(0, 2, 1).reshape(len(base.trials), -1)
    return Columns(
        trace=trace,
        label=label,
        columns=columns,
        prior=_PRIOR**2 * np.eye(many),
        low=np.full(many, -np.inf),
        high=np.full(many, np.inf),
    )


_Velocity = Callable[[_Motion], Array]


def _velocities(motions: list[_Motion], model: Model, commanded: bool) -> list[tuple[Trace, str, _Velocity]]:
    place = np.concatenate([m.pose[:, :2] for m in motions])
    corner, reach = place.min(axis=0), np.maximum(np.ptp(place, axis=0), 1e-3)
    clock = max(float(m.since[-1]) for m in motions)
    knots = max(4, round(clock / SETTINGS.probe_knot_s))
    roll = model.geometry.no_slip_map()
    period = pitch(np.asarray(model.grip.rollers, dtype=float))
    angles = all(m.angle is not None for m in motions)

    def cells(m: _Motion) -> Array:
        z = (m.pose[:, :2] - corner) / reach
        x, y = (basis_values(Basis.HATS, np.array([0.0, 1.0]), SETTINGS.probe_cells, z[:, i]) for i in (0, 1))
        return m.floor_force(np.einsum("ti,tj->tij", x, y).reshape(len(z), -1))[:, :, : -(len(x[0]) ** 2)]

    def time(m: _Motion) -> Array:
        return basis_values(Basis.HATS, np.array([0.0, clock]), knots, m.since)

    def rolling(m: _Motion, wheel: int, rate: Array) -> Array:
        """Body twist of a wheel whose rolling errs by ``rate`` (T, P) [rad/s]."""
        return np.asarray(np.einsum("c,tp->tcp", roll[:, wheel], rate))

    def once_a(m: _Motion, turn: Array, orders: int) -> Array:
        assert m.angle is not None
        waves = [
            basis_values(Basis.FOURIER, np.array([turn[i], 0.0]), orders, a) for i, a in enumerate(m.angle.T)
        ]
        return np.concatenate([rolling(m, i, m.speed[:, i : i + 1] * w) for i, w in enumerate(waves)], axis=2)

    def wobble(m: _Motion) -> Array:
        """A wheel whose direction swings as it turns rolls by the share of its sideways motion."""
        assert m.angle is not None
        twist = m.speed @ roll.T
        drive = np.linalg.pinv(roll)
        parts = []
        for i, (x, y) in enumerate(model.geometry.position_m):
            push = drive[i, :2] / max(float(np.hypot(*drive[i, :2])), 1e-12)
            across = np.array([-push[1], push[0]])
            hub = np.stack([twist[:, 0] - twist[:, 2] * y, twist[:, 1] + twist[:, 2] * x], axis=1) @ across
            wave = basis_values(Basis.FOURIER, np.array([2.0 * np.pi, 0.0]), 2, m.angle[:, i])
            per_speed = float(np.hypot(*drive[i, :2]))
            parts.append(rolling(m, i, per_speed * hub[:, None] * wave))
        return np.concatenate(parts, axis=2)

    def play(m: _Motion) -> Array:
        """Each wheel stands still while its play is taken up, after it has changed its direction."""
        parts = []
        for i, speed in enumerate(m.speed.T):
            angle = integrated(m.t_s, speed)
            behind = np.zeros(len(angle))
            at = angle[0]
            for k, now in enumerate(angle):
                at = min(max(at, now - 0.5 * SETTINGS.probe_play_rad), now + 0.5 * SETTINGS.probe_play_rad)
                behind[k] = (at - now) / SETTINGS.probe_play_rad
            parts.append(rolling(m, i, np.gradient(behind, m.t_s)[:, None]))
        return np.concatenate(parts, axis=2)

    full = np.full(len(period), 2.0 * np.pi)
    found: list[tuple[Trace, str, _Velocity]] = [
        (Trace.POSITION, "force over the place", cells),
        (Trace.TIME, "push at a time", lambda m: m.floor_force(time(m))),
        (Trace.TIME, "push at a time, fixed to the robot", lambda m: m.body_force(time(m))),
    ]
    if not commanded:
        found.append((Trace.ACTUATION, "play between encoder and wheel", play))
    if angles:
        found += [
            (Trace.WHEEL_ANGLE, "rolling once and twice a turn", lambda m: once_a(m, full, 4)),
            (Trace.WHEEL_ANGLE, "rolling once a roller", lambda m: once_a(m, period, 4)),
            (Trace.WHEEL_ANGLE, "direction of a wheel once a turn", wobble),
        ]
    return found
