"""What the base model shows of the data before any search: clocks, floors, noise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, commanded, force, planted, smooth_kiwi
from real_logs import EXCERPT, logs
from spoilt import (
    camera_clock,
    coloured,
    each,
    good,
    heavy_tails,
    noise_stated,
    other_floor,
    random_walk,
    swapped,
    turned_wheel,
)

import slipmargin as sm
from slipmargin.api.diagnose import check_sense
from slipmargin.data.checks import check_data_set
from slipmargin.data.data_set import DataSet
from slipmargin.data.odometry_match import arrangements, mismatch, pieces
from slipmargin.data.record import Record
from slipmargin.diagnosis.conditions import Ready, ready, spins
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.effects import Trace
from slipmargin.errors import InputError
from slipmargin.physics.variables import Frame, Variable

RANDOM = np.random.default_rng


def kinds(found: Ready) -> list[str]:
    return [r.kind for r in found.repairs]


def chi(data_set: DataSet) -> float:
    """Root mean square of the base model's whitened residual."""
    problem = problem_of(data_set)
    residual = problem.residuals([()], [np.arange(len(problem.trials))])[0]
    return float(np.sqrt(np.sum(residual**2) / problem.seen.sum()))


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_good_data_are_left_alone(seed: int) -> None:
    data = good(seed)
    found = ready(data)
    assert found.repairs == () and not found.noise_estimated
    assert np.array_equal(found.data_set.sigma, data.sigma) and found.data_set.lasting is None
    assert chi(found.data_set) == pytest.approx(1.0, abs=0.05)


def test_noise_that_nobody_states_is_measured() -> None:
    found = ready(replace(good(), sigma=None))
    assert found.noise_estimated and found.repairs == ()
    np.testing.assert_allclose(found.data_set.sigma, good().sigma, rtol=0.08)  # type: ignore[arg-type]


@pytest.mark.parametrize("factor", [0.2, 5.0])
def test_noise_stated_wrong_is_replaced(factor: float) -> None:
    found = ready(noise_stated(good(), factor))
    assert kinds(found) == ["stated_noise"] and found.noise_estimated
    np.testing.assert_allclose(found.data_set.sigma, good().sigma, rtol=0.08)  # type: ignore[arg-type]
    assert found.repairs[0].size == pytest.approx(1.0 / factor, rel=0.1)


def test_heavy_tails_make_the_noise_larger_and_nothing_else() -> None:
    found = ready(heavy_tails(good(), RANDOM(0)))
    assert set(kinds(found)) == {"lone_outliers", "stated_noise"}
    assert chi(found.data_set) < 1.12


def test_a_pose_with_one_number_far_off_is_missing_altogether() -> None:
    data = good()
    assert data.sigma is not None
    pose = np.array(data.trials[2].pose)
    pose[60, 0] += 7.5 * data.sigma[0]  # less than what is seen without a model
    wrong = replace(data.trials[2], pose=pose)
    found = ready(replace(data, trials=(*data.trials[:2], wrong, *data.trials[3:])))
    assert kinds(found) == ["lone_outliers"] and found.repairs[0].size == 1.0
    assert np.isnan(found.data_set.trials[2].pose[60]).all()


@pytest.mark.parametrize("factor", [0.985, 1.02])
def test_a_camera_with_a_clock_of_its_own(factor: float) -> None:
    found = ready(camera_clock(good(), RANDOM(0), factor))
    assert kinds(found)[0] == "camera_clock"
    assert found.repairs[0].size == pytest.approx(factor - 1.0, abs=0.002)
    assert chi(found.data_set) < 1.12


def test_a_real_robot_that_slips_evenly_has_no_clock_of_its_own() -> None:
    """On the smooth table it falls behind by a tenth, however it drives; it stops when its wheels stop."""
    found = ready(sm.import_logs(logs(EXCERPT / "table_0.1"), "robotino", "robotino", "table").data_set)
    assert "camera_clock" not in kinds(found) and chi(found.data_set) > 20.0


def test_two_runs_on_another_floor_are_left_out_by_name() -> None:
    found = ready(other_floor(good(), {1, 4}))
    assert kinds(found) == ["other_floor"]
    assert found.repairs[0].runs == ("trial01", "trial04")
    assert found.repairs[0].size == pytest.approx(0.7, abs=0.03)
    assert len(found.data_set.trials) == 6 and chi(found.data_set) < 1.1


@pytest.mark.parametrize("seed", [4, 5])
@pytest.mark.parametrize(("sd", "time_s"), [(2.0, 0.05), (2.0, 0.3)])
def test_noise_that_lasts_is_whitened(seed: int, sd: float, time_s: float) -> None:
    data = good(seed)
    assert data.sigma is not None
    found = ready(coloured(data, RANDOM(seed), sd * data.sigma, time_s))
    assert "lasting_noise" in kinds(found) and found.data_set.lasting is not None
    assert chi(found.data_set) == pytest.approx(1.0, abs=0.1)
    np.testing.assert_allclose(found.data_set.sigma, np.sqrt(1.0 + sd**2) * data.sigma, rtol=0.3)


@pytest.mark.parametrize("seed", [4, 5, 6])
def test_a_random_walk_is_noise(seed: int) -> None:
    found = ready(random_walk(good(seed), RANDOM(seed), np.array([0.002, 0.002, 0.004])))
    assert "lasting_noise" in kinds(found)
    assert chi(found.data_set) < 1.25


def test_a_missing_force_is_no_fault_of_the_data() -> None:
    drag = force(Trace.VELOCITY, Variable.VELOCITY_Y, 1, lambda v: -2.0 * v, -1.0, 1.0, Frame.BODY)
    data = planted(
        smooth_kiwi(), Plant(name="drag", traces=(Trace.VELOCITY,), effects=(drag,)), 3, count=8,
        duration_s=2.5, rate_hz=100.0,
    )  # fmt: skip
    assert chi(data) > 3.0
    found = ready(data)
    assert found.repairs == () and not found.noise_estimated


def test_commands_hold_from_row_to_row_where_that_is_what_was_done() -> None:
    data = commanded(smooth_kiwi(), Plant(name="none", traces=()), 3, count=4, duration_s=2.0, rate_hz=30.0)
    assert not ready(data).data_set.trials[0].commands_held  # these ran straight from row to row


@pytest.mark.parametrize("hold", [True, False])
def test_commands_that_hold_are_no_lag_of_the_motors_where_noise_hides_most_of_it(hold: bool) -> None:
    """Half a row of 5 ms at a noise of 2 mm was called a motor that lags, in three sets of a hundred."""
    data = commanded(smooth_kiwi(), Plant(name="none", traces=()), 3, count=8, duration_s=3.5, rate_hz=200.0)
    sigma = np.array([2e-3, 2e-3, 8e-3])
    told = replace(data, sigma=sigma, trials=tuple(replace(t, commands_held=hold) for t in data.trials))
    random, everyone = RANDOM(1), np.arange(8)
    noisy = [
        p + sigma * random.standard_normal(p.shape) for p in problem_of(told).predict([()], [everyone])[0]
    ]
    data = replace(
        data, sigma=sigma, trials=tuple(replace(t, pose=p) for t, p in zip(data.trials, noisy, strict=True))
    )
    found = ready(data)
    assert found.data_set.trials[0].commands_held is hold
    assert chi(found.data_set) == pytest.approx(1.0, abs=0.03)
    straight = problem_of(data).misses((), everyone)
    assert np.sqrt(np.mean(straight**2)) < 1.1  # near enough to the noise to be overlooked


@pytest.mark.parametrize(
    ("fault", "words"), [(turned_wheel, "Wheel 2 turning"), (swapped, "Columns of wheels 1 and 2")]
)
def test_two_runs_that_are_wired_otherwise(fault: Callable[[Record], Record], words: str) -> None:
    data = good()
    found = ready(each(data, fault, {2, 5}))
    (repair,) = found.repairs
    assert repair.kind == "wheel_columns" and repair.runs == ("trial02", "trial05")
    assert words in repair.sentence and repair.sentence.endswith(".")
    for mended, right in zip(found.data_set.trials, data.trials, strict=True):
        np.testing.assert_array_equal(mended.theta, right.theta)
        np.testing.assert_array_equal(mended.omega, right.omega)


def test_half_of_the_runs_decide_nothing() -> None:
    assert "wheel_columns" not in kinds(ready(each(good(), turned_wheel, {0, 1, 2, 3})))


def spinning(data: DataSet, run: Record, wheels_rad_s: list[float], seed: int = 0) -> Record:
    """A run in which all wheels slip."""
    ramp = np.clip(np.minimum(run.t_s, run.t_s[-1] - run.t_s) / 0.3, 0.0, 1.0)
    omega = ramp[:, None] * np.array(wheels_rad_s)
    theta = np.cumsum(omega, axis=0) * np.gradient(run.t_s)[:, None]
    turning = replace(run, omega=omega, theta=theta)
    (pose,) = problem_of(data, (turning,)).predict([()], [np.arange(1)])
    assert data.sigma is not None
    return replace(turning, pose=pose[0] + RANDOM(seed).normal(size=pose[0].shape) * data.sigma)


SPINS = [
    ([42.9, 28.2, 20.2], "wheel 3 turning the other way"),
    ([-23.3, -50.7, 24.4], "columns of wheels 1 and 3 swapped"),
    ([-30.9, -7.8, 17.7], "columns of wheels 1 and 2 swapped"),
]


@pytest.mark.parametrize(("wheels_rad_s", "seems"), SPINS)
def test_wheels_that_spin_on_the_spot_are_wired_as_the_others(wheels_rad_s: list[float], seems: str) -> None:
    """Where all wheels slip, other columns match the robot's motion far better than the right ones."""
    data = good()
    run = spinning(data, data.trials[2], wheels_rad_s)
    geometry = data.recipe.build(data.surface).geometry
    part = pieces(run, data.wheel_signal)
    assert part is not None
    others = [a for a in arrangements(geometry.names) if a.parts == 1 and a.view == 0]
    best = min(others, key=lambda a: mismatch(part, a, geometry))
    assert best.words.startswith(seems)
    assert mismatch(part, best, geometry) < 0.2 < 0.45 < mismatch(part, None, geometry)
    assert "wheel_columns" not in kinds(ready(each(data, lambda _: run, {2})))


def test_a_robot_that_spins_in_every_run_is_not_refused() -> None:
    data = good()
    runs = tuple(spinning(data, r, SPINS[2][0], k) for k, r in enumerate(data.trials))
    (fault,) = check_data_set(replace(data, trials=runs))
    assert fault.arrangement is not None and spins(replace(data, trials=runs), fault.arrangement)
    check_sense(replace(data, trials=runs), "spinning")
    with pytest.raises(InputError, match="wheel 2 turning the other way"):
        check_sense(each(data, turned_wheel), "wired otherwise")
