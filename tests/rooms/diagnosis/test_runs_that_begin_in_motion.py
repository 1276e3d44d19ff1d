"""Runs of which commands alone are known: some begin at rest, others in the middle of a drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import SIGMA, smooth_kiwi

from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.effects import AnyEffect
from slipmargin.effects.command_saturation import CommandSaturation
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.effects.recipe import with_effects
from slipmargin.effects.speed_droop import SpeedDroop
from slipmargin.model import nominal_model
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import held

T_S = np.arange(0.0, 2.0, 0.01)
Effects = tuple[AnyEffect, ...]


def runs(effects: Effects, first: int, every: int = 1, missing: int = 0, then: float = 1.0) -> DataSet:
    """Six drives at a drawn speed that turn into ``then`` times another, their logs from row ``first`` on.

    The camera sees every so many rows of a log, and not the ``missing`` first ones.
    """
    random, recipe = np.random.default_rng(4), smooth_kiwi()
    model = with_effects(nominal_model(recipe.robot, "paper"), effects)
    records = []
    for k in range(6):
        way = np.array([k, k + 2.5])
        twists = np.column_stack([0.3 * np.cos(way), 0.3 * np.sin(way), random.uniform(-1.0, 1.0, 2)])
        speeds = model.geometry.wheel_speeds(twists)
        asked = np.where(T_S[:, None] < 1.2, speeds[0], then * speeds[1])
        pose = Batch([held(T_S, asked)], [T_S], commanded=True).run(pack(model), np.zeros(3)).pose[0]
        seen = pose + SIGMA * random.standard_normal(pose.shape)
        rows = slice(first, None)
        dark = np.arange(len(T_S) - first) % every > 0
        dark[:missing] = True
        poses = np.where(dark[:, None], np.nan, seen[rows])
        records.append(Record(name=f"run{k}", t_s=T_S[rows] - T_S[first], pose=poses, omega_cmd=asked[rows]))
    return DataSet(
        name="drives",
        recipe=recipe,
        surface="paper",
        trials=tuple(replace(r, commands_held=True) for r in records),
        sigma=SIGMA,
        wheel_signal=WheelSignal.COMMANDED,
    )


@pytest.mark.parametrize(
    "lag", [MotorLag(lag_s=0.03), MotorLag(lag_s=0.1), MotorLag(lag_s=0.05, delay_s=0.04)]
)
@pytest.mark.parametrize("first", [0, 60], ids=["from rest", "in motion"])
def test_the_true_lag_leaves_noise(lag: MotorLag, first: int) -> None:
    """Wheels always began at rest: a run cut out of a drive stood still until they had caught up."""
    problem = problem_of(runs((lag,), first))
    everyone = np.arange(6)
    true, without = (problem.misses(of, everyone) for of in ((lag,), ()))
    assert true.max() < 1.15 and without.mean() > true.mean() + 0.1


SLOWER = (SpeedDroop(droop_rad_s_per_N_m=0.0, speed_factor=0.7), MotorLag(lag_s=0.1))


@pytest.mark.parametrize(
    ("effects", "every", "missing"),
    [
        ((), 4, 0),
        ((MotorLag(lag_s=0.1),), 5, 0),
        ((MotorLag(lag_s=0.1),), 10, 0),
        ((MotorLag(lag_s=0.1),), 1, 5),
        (SLOWER, 1, 0),
        ((CommandSaturation(saturation_s_per_rad=0.25), MotorLag(lag_s=0.1)), 1, 0),
    ],
    ids=["25 Hz", "20 Hz", "10 Hz", "begins unseen", "slower than asked", "at its top speed"],
)
@pytest.mark.parametrize("first", [0, 60], ids=["from rest", "in motion"])
def test_the_truth_leaves_noise_whatever_the_camera_and_the_pace(
    effects: Effects, every: int, missing: int, first: int
) -> None:
    """A slow camera, a first pose that is missing, and a robot slower than asked stood still at first."""
    left = problem_of(runs(effects, first, every, missing)).misses(effects, np.arange(6))
    assert left.max() < 1.25, left


def test_what_a_run_begins_with_stays_when_its_wheels_are_interpolated_anew() -> None:
    problem = problem_of(runs((MotorLag(lag_s=0.1),), 60))
    spins = [signal.spin_rad_s for signal in problem.signals]
    assert np.all(np.any(spins, axis=1))
    again = problem.rebuilt(problem.scheme)
    np.testing.assert_array_equal([signal.spin_rad_s for signal in again.signals], spins)


def test_what_is_cut_where_the_wheels_have_stopped_slides_on() -> None:
    """It stood still at once (3.5): a run that begins with no wheel turning was taken to begin at rest.

    How fast it slides at first is told by few poses, so more than noise is left.
    """
    whole = runs((), 0, then=0.0)
    cut = tuple(record.part(slice(122, None)) for record in whole.trials)
    assert problem_of(whole, cut).misses((), np.arange(6)).max() < 2.0
