"""Runs whose truth is known, for a slip monitor: simulated ones, and those of a data set with poses."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, real
from slipmargin.data.odometry import body_velocity
from slipmargin.errors import InputError
from slipmargin.onboard.signals import TAU_S
from slipmargin.physics.frames import rotate_rows
from slipmargin.work import TRAINING_STEPS, allow

if TYPE_CHECKING:
    from slipmargin.model import Model
    from slipmargin.onboard.likelihood import LabelledRun
    from slipmargin.onboard.signals import Channels
    from slipmargin.onboard.table import LimitTable

#: Simulated training: length of a run [s], time between samples [s].
_LENGTH_S, _STEP_S = 2.0, 0.01
#: A wanted velocity is held for one of these times [steps]: short ones make rough motions, long ones reach
#: the speeds at which a robot drives along a path.
_HELD = (25, 50, 100, 200)
#: Standard deviation of a wanted velocity where no motor limits it [m/s]; a run takes from this part of it.
_FASTEST_M_S, _SLOWEST = 3.0, 0.05
#: The same where a motor does [share of its top speed].
_OF_TOP = 0.7
#: Part of the grip's acceleration that a run may take, from the least to the most [1].
_LEAST, _MOST = 0.1, 2.0
#: Runs: this over the false-alarm rate, so that a threshold is sure to keep it (up to 8.5 are needed, as runs
#: grip for unequal times), within these bounds.
_PER_RATE, _LEAST_RUNS, _MOST_RUNS = 10.0, 100, 2000
#: A wheel slips where it uses more than this share of its grip in simulation, and grips below the other [1].
_SLIPS, _GRIPS = 0.97, 0.93
#: Steps after which a run is left out; the built-in robots need up to 1 300 [1].
_MOST_STEPS = 5_000
#: Runs after which it is estimated how long all of them take; if none of them reaches its end, no other is
#: waited for.
_FIRST_RUNS = 10
#: Noise of simulated sensors: wheel speed [share of its rms], gyro [rad/s], current [share].
_NOISE, _GYRO_NOISE, _CURRENT_NOISE = 0.01, 0.02, 0.05
#: Half the window of measured velocities [s]; how far they may be from the wheels' and still be grip:
#: an offset [m/s] for the noise of the pose and a share of the wheels' velocity [1].
_WINDOW_S, _APART_M_S, _APART = 0.1, 0.02, 0.2


def simulated(
    model: Model,
    table: LimitTable,
    channels: Channels,
    seed: int,
    torque_per_ampere_N_m: float | None,
    false_alarm_rate: float,
) -> list[LabelledRun]:
    """Runs of the robot's own model that ask for a tenth to twice the grip's acceleration."""
    from slipmargin.onboard.likelihood import LEAST, labelled
    from slipmargin.sim.batch import Batch, Ending
    from slipmargin.sim.pack import pack
    from slipmargin.sim.signal import linear
    from slipmargin.sim.simulate import REASONS, as_run

    if channels.current and torque_per_ampere_N_m is None:
        raise InputError(
            "torque_per_ampere_N_m",
            "is missing, and the log has currents",
            "give the torque at the wheel per ampere [N m/A], or logged runs with poses for training",
        )
    per_ampere = real(
        "torque_per_ampere_N_m",
        1.0 if torque_per_ampere_N_m is None else torque_per_ampere_N_m,
        above=0.0,
        cure="give newton metres per ampere",
    )
    rng = np.random.default_rng(seed)
    ticks = round(_LENGTH_S / _STEP_S)
    t = np.asarray(_STEP_S * np.arange(ticks + 1), dtype=np.float64)
    out, packed, steps, early = [], pack(model), 0, Counter[Ending]()
    runs = round(min(max(_PER_RATE / false_alarm_rate, _LEAST_RUNS), _MOST_RUNS))
    for number, twist in enumerate(_twists(model, table, rng, ticks, runs), start=1):
        omega = model.geometry.wheel_speeds(twist)
        batch = Batch([linear(t, omega)], [t])
        outcome = batch.run(
            packed, np.zeros(3), start_twist=twist[0], tell=True, rtol=1e-5, max_steps=_MOST_STEPS
        )
        steps += int(outcome.steps.sum())
        if number >= _FIRST_RUNS:
            cure = "train on logged runs with poses, or accept more false alarms"
            each = model.count * steps / number
            allow("training", each * runs, TRAINING_STEPS, "wheel steps of simulated runs", cure)
        if outcome.ending[0] != Ending.DONE:
            early[Ending(int(outcome.ending[0]))] += 1
            if number == _FIRST_RUNS == early.total():
                break
            continue
        run = as_run(model, t, outcome, 0)
        body = rotate_rows(run.pose[:, 2], run.velocity, inverse=True)
        used = np.max(run.utilisation, axis=1)
        body[~_settled(used)] = np.nan
        noise = _NOISE * float(np.sqrt(np.mean(omega**2)))
        torque = np.abs(run.force[..., 0]) * model.geometry.radius_m / per_ampere
        given = np.where(np.isfinite(body[:, 2]), body[:, 2], run.velocity[:, 2])
        out.append(
            labelled(
                table,
                channels,
                t,
                omega + noise * rng.normal(size=omega.shape),
                body,
                used > _SLIPS,
                commanded=omega if channels.commanded else None,
                gyro_rad_s=given + _GYRO_NOISE * rng.normal(size=len(t)) if channels.gyro else None,
                current_A=torque * (1.0 + _CURRENT_NOISE * rng.normal(size=torque.shape))
                if channels.current
                else None,
            )
        )
    slipping, gripping = sum(np.sum(r.slips) for r in out), sum(np.sum(~r.slips) for r in out)
    if early and min(slipping, gripping) < LEAST:
        why, _ = REASONS[early.most_common(1)[0][0]]
        cure = "train on logged runs with poses, or correct the robot file"
        said = f"{early.total()} of {number} simulated runs do not reach their end: {why}"
        raise InputError("training", said, cure)
    return out


def _twists(model: Model, table: LimitTable, rng: np.random.Generator, ticks: int, runs: int) -> Array:
    """Body twists (runs, ticks + 1, 3) towards wanted velocities, with a part of the grip's acceleration."""
    per = np.array([1.0, 1.0, 1.0 / float(np.mean(np.abs(table.along[2])))])
    top = model.drives.max_speed_rad_s
    fastest = _FASTEST_M_S if top is None else _OF_TOP * top * float(np.min(model.geometry.radius_m))
    part = rng.permutation(np.geomspace(_LEAST, _MOST, runs))
    held, size = rng.choice(_HELD, size=runs), rng.uniform(_SLOWEST, 1.0, size=runs)
    # As many whatever is held, and to the right and forward: a robot trains alike in either convention.
    drawn = rng.normal(size=(runs, ticks // min(_HELD) + 2, 3)) * fastest * size[:, None, None] * per
    drawn[..., 0], drawn[..., 1] = model.convention.from_right_forward(
        drawn[..., 0].copy(), drawn[..., 1].copy()
    )
    twists = np.zeros((runs, ticks + 1, 3))
    twists[::4, 0] = drawn[::4, -1]  # a quarter begins at speed, so that speed is no sign of slip
    for k in range(ticks):
        turn, now = k // held, twists[:, k]
        wish = np.where((turn % 4 == 3)[:, None], 0.0, drawn[np.arange(runs), turn])
        step = (wish - now) / (part[:, None] * table.pull_m_s2 * per * _STEP_S)
        twists[:, k + 1] = now + (wish - now) / np.maximum(1.0, np.linalg.norm(step, axis=1))[:, None]
    return twists


def _settled(used: Array) -> NDArray[np.bool_]:
    """Samples (T,) that grip or slip clearly, and have done so for as long as the filters remember."""
    slips, grips = used > _SLIPS, used < _GRIPS
    remembered = round(2.0 * TAU_S / _STEP_S)
    last = np.arange(len(used)) + 1
    first = np.maximum(last - 1 - remembered, 0)
    counted = [np.concatenate([[0], np.cumsum(part)]) for part in (grips, slips)]
    gripped, slipped = ((sums[last] - sums[first]) / (last - first) for sums in counted)
    return np.asarray(((gripped == 1.0) | (slipped > 0.6)) & (slips | grips))


def from_data_set(
    model: Model, table: LimitTable, channels: Channels, folder: Path | str
) -> tuple[list[LabelledRun], tuple[str, ...]]:
    """The runs of a data set, and a warning where they are of another floor than the model.

    A wheel slips where the pose says other velocities than the wheels.

    What the data set's robot file says of its camera is undone.

    Raises
    ------
    InputError
        Where the data set is in another convention or for another number of wheels, lacks a channel that is
        announced, or has a camera that cannot be undone.
    """
    from slipmargin.diagnosis.sense import true_pose
    from slipmargin.io.data_set import read_data_set
    from slipmargin.onboard.likelihood import labelled

    found, out = read_data_set(folder), []
    axes, sensing = found.recipe.robot.convention, found.recipe.build(found.surface).measurement
    if axes is not model.convention:
        problem = f"is {axes.value}, the robot's is {model.convention.value}"
        raise InputError("convention", problem, "give robot and runs in one convention", str(folder))
    for trial in found.trials:
        place = f"trials/{trial.name}.csv"
        for name, wanted, given in (
            ("omega", True, trial.omega),
            ("omega_cmd", channels.commanded, trial.omega_cmd),
            ("current", channels.current, trial.current),
        ):
            if wanted and (given is None or not np.all(np.isfinite(given))):
                raise InputError(
                    f"{place}: {name}", "is missing", "train on runs that log every channel", str(folder)
                )
        assert trial.omega is not None
        if trial.omega.shape[1] != table.count:
            raise InputError(place, "is of a robot with other wheels", "give this robot's runs", str(folder))
        half = max(2, round(_WINDOW_S / float(np.median(np.diff(trial.t_s)))))
        try:
            pose = true_pose(sensing, trial.t_s, trial.pose)
        except InputError as fault:
            raise fault.in_file(str(folder)) from None
        truth, wheels = _velocities(table, trial.t_s, pose, trial.omega, half)
        size = np.array([1.0, 1.0, float(np.mean(np.abs(table.along[2])))])
        apart = np.linalg.norm((truth - wheels) * size, axis=1)
        slips = apart > _APART_M_S + _APART * np.linalg.norm(wheels * size, axis=1)
        out.append(
            labelled(
                table,
                channels,
                trial.t_s,
                trial.omega,
                truth,
                slips,
                commanded=trial.omega_cmd if channels.commanded else None,
                gyro_rad_s=_filled(truth[:, 2]) if channels.gyro else None,
                current_A=trial.current if channels.current else None,
            )
        )
    if found.surface == model.surface:
        return out, ()
    return out, (
        f"the runs to train on are of surface {found.surface!r}; the shares of the grip that they are "
        f"learned by are those of {model.surface!r}",
    )


def _velocities(table: LimitTable, t: Array, pose: Array, omega: Array, half: int) -> tuple[Array, Array]:
    """Body twists (T, 3) by the pose and by the wheels over the same samples; NaN at the ends."""
    truth, wheels = np.full(pose.shape, np.nan), np.full(pose.shape, np.nan)
    if len(t) > 2 * half:
        truth[half:-half] = body_velocity(t, pose, half)
        turned = np.concatenate([np.zeros((1, omega.shape[1])), np.cumsum(omega, axis=0)])
        mean = (turned[2 * half + 1 :] - turned[: -2 * half - 1]) / (2 * half + 1)
        wheels[half:-half] = mean @ np.linalg.pinv(table.rolling).T
    return truth, wheels


def _filled(values: Array) -> Array:
    """Values with their gaps and ends filled by the nearest that are there."""
    there = np.flatnonzero(np.isfinite(values))
    if not len(there):
        return np.zeros_like(values)
    return np.asarray(np.interp(np.arange(len(values)), there, values[there]))
