"""Runs of which commands alone are known: some begin at rest, others in the middle of a drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import SIGMA, smooth_kiwi

from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.effects.recipe import with_effects
from slipmargin.model import nominal_model
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import held

T_S = np.arange(0.0, 2.0, 0.01)


def runs(lag: MotorLag, first: int) -> DataSet:
    """Six drives at a drawn speed that turn into another, their logs from row ``first`` on."""
    random, recipe = np.random.default_rng(4), smooth_kiwi()
    model = with_effects(nominal_model(recipe.robot, "paper"), (lag,))
    records = []
    for k in range(6):
        way = np.array([k, k + 2.5])
        twists = np.column_stack([0.3 * np.cos(way), 0.3 * np.sin(way), random.uniform(-1.0, 1.0, 2)])
        speeds = model.geometry.wheel_speeds(twists)
        asked = np.where(T_S[:, None] < 1.2, speeds[0], speeds[1])
        pose = Batch([held(T_S, asked)], [T_S], commanded=True).run(pack(model), np.zeros(3)).pose[0]
        seen = pose + SIGMA * random.standard_normal(pose.shape)
        rows = slice(first, None)
        records.append(
            Record(name=f"run{k}", t_s=T_S[rows] - T_S[first], pose=seen[rows], omega_cmd=asked[rows])
        )
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
    problem = problem_of(runs(lag, first))
    everyone = np.arange(6)
    true, without = (problem.misses(of, everyone) for of in ((lag,), ()))
    assert true.max() < 1.15 and without.mean() > true.mean() + 0.1


def test_what_a_run_begins_with_stays_when_its_wheels_are_interpolated_anew() -> None:
    problem = problem_of(runs(MotorLag(lag_s=0.1), 60))
    spins = [signal.spin_rad_s for signal in problem.signals]
    assert np.all(np.any(spins, axis=1))
    again = problem.rebuilt(problem.scheme)
    np.testing.assert_array_equal([signal.spin_rad_s for signal in again.signals], spins)
