"""Comparing whole runs and pieces of them: what moves with the start is no residual, the rest is."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Array, Index
from slipmargin.diagnosis import problem as module
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Trace
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.io.robot_file import read_recipe
from slipmargin.sim.batch import Ending, Outcome
from slipmargin.sim.pack import pack, stack

PIECE_S = 0.4


@pytest.fixture(scope="module")
def problem() -> Problem:
    data = planted(read_recipe("ohio-kiwi"), None, seed=2, count=3, duration_s=2.0, rate_hz=50.0)
    trials = tuple(clean(record, np.array([5e-4, 5e-4, 2e-3])) for record in data.trials)
    return Problem.of(data.recipe, data.surface, trials, np.array([5e-4, 5e-4, 2e-3]), False)


def predicted(problem: Problem) -> Array:
    return problem.predict([()], [np.arange(len(problem.trials))])[0]


def chi(problem: Problem) -> float:
    residual = problem.residuals([()], [np.arange(len(problem.trials))])[0]
    return float(np.sqrt(np.sum(residual**2) / problem.samples(np.arange(len(problem.trials)))))


def moved(pose: Array, turn: float, shift: tuple[float, float]) -> Array:
    """The poses turned about the floor's origin and shifted."""
    c, s = np.cos(turn), np.sin(turn)
    x, y = pose[..., 0], pose[..., 1]
    return np.stack([c * x - s * y + shift[0], s * x + c * y + shift[1], pose[..., 2] + turn], axis=-1)


def test_a_start_elsewhere_is_no_residual(problem: Problem) -> None:
    exact = replace(problem, measured=predicted(problem))
    assert chi(exact) < 1e-2
    assert chi(replace(exact, measured=moved(exact.measured, 1e-4, (0.02, -0.01)))) < 0.05
    twisted = exact.measured + np.array([0.0, 0.0, 0.1])  # another heading, the same path
    assert chi(replace(exact, measured=twisted)) > 5.0


def test_each_piece_may_lie_elsewhere_and_nothing_within_it(problem: Problem) -> None:
    exact = replace(problem, measured=predicted(problem))
    cut = exact.in_pieces(PIECE_S)
    assert cut.piece == 20
    broken = exact.measured.copy()
    for k, start in enumerate(range(0, broken.shape[1], 20)):
        part = broken[:, start : start + 20]
        broken[:, start : start + 20] = moved(part, 0.7 * np.sin(k + 1.0), (0.3 * k, -0.2))
    assert chi(replace(exact, measured=broken)) > 100.0
    assert chi(replace(cut, measured=broken)) < 0.05
    bent = exact.measured + 0.02 * np.sin(np.arange(broken.shape[1]))[:, None] * [1.0, 0.0, 0.0]
    assert chi(replace(cut, measured=bent)) > 5.0


def test_what_nobody_saw_does_not_count(problem: Problem) -> None:
    seen = problem.seen.copy()
    seen[:, 30:60] = False
    measured = np.where(seen, problem.measured, 1e3)
    for view in (problem, problem.in_pieces(PIECE_S)):
        assert chi(replace(view, seen=seen, measured=measured)) == pytest.approx(1.0, abs=0.15)


def test_turning_the_rotors_by_a_pitch_changes_nothing_by_half_a_pitch_does(problem: Problem) -> None:
    pitch = 2.0 * np.pi / problem.nominal.grip.rollers
    assert np.any(problem.nominal.grip.rigid_fraction > 0.0)
    whole, half = (chi(problem.with_wheel_phases(np.tile(f * pitch, (3, 1)))) for f in (1.0, 0.5))
    assert whole == pytest.approx(chi(problem), rel=1e-3)
    assert half > 1.5 * whole


def test_no_trial_outweighs_the_middle_one_of_those_that_are_missed(problem: Problem) -> None:
    everyone = np.arange(len(problem.trials))
    wave = np.sin(np.arange(problem.measured.shape[1]))[:, None] * [1.0, 0.0, 0.0]
    bent = predicted(problem) + np.array([0.002, 0.004, 0.4])[:, None, None] * wave
    plain = replace(problem, measured=bent)

    def of_runs(view: Problem) -> Array:
        return np.asarray(np.sqrt(np.mean(view.residuals([()], [everyone])[0] ** 2, axis=1)))

    low, middle, high = of_runs(plain)
    assert high > 50.0 * middle
    np.testing.assert_allclose(
        of_runs(plain.evened((), everyone)), [low, middle, SETTINGS.loudest * middle], rtol=1e-9
    )
    assert np.array_equal(
        plain.evened((), everyone).evened((), everyone).weights, plain.evened((), everyone).weights
    ), "weighed once"
    backwards = plain.evened((), everyone).residuals([()], [everyone[::-1]])[0]
    assert np.array_equal(backwards, plain.evened((), everyone).residuals([()], [everyone])[0][::-1])
    quiet = replace(problem, measured=predicted(problem))
    assert not len(quiet.evened((), everyone).weights), "nothing is missed, nothing is weighed"


def test_a_run_starts_where_all_of_its_frames_put_it() -> None:
    """A first frame 10 mrad off turned what a tilted floor does by as much."""
    tilt = FloorTilt(tilt_x_rad=0.03, tilt_y_rad=-0.02)
    plant = Plant(name="tilt", traces=(Trace.CONSTANT_FORCE,), effects=(tilt,))
    data = planted(smooth_kiwi(), plant, seed=2, count=3, duration_s=2.0, rate_hz=100.0)
    sigma = np.array([5e-4, 5e-4, 2e-3])
    trials = tuple(clean(record, sigma) for record in data.trials)
    exact = Problem.of(data.recipe, data.surface, trials, sigma, False)
    runs = np.arange(3)
    turned = replace(exact, starts=exact.starts + np.array([0.0, 0.0, 0.01]))
    again = turned.restarted((tilt,), runs)
    assert np.abs(again.starts - exact.restarted((tilt,), runs).starts).max() < 2e-3  # of 10 mrad
    cost = [float(np.sum(p.residuals([(tilt,)], [runs])[0] ** 2)) for p in (turned, again)]
    assert cost[1] < 0.98 * cost[0]
    assert turned.in_pieces(0.5).restarted((tilt,), runs).starts is turned.starts


def test_first_orders_that_grow_without_bound_are_simulated(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seen on a real robot's loaded runs: steep friction made them overflow, and a fit ended in an error."""
    everyone = np.arange(len(problem.trials))
    ways = [
        lambda part, x=x, y=y: (FloorTilt(tilt_x_rad=x * part, tilt_y_rad=y * part),)
        for x, y in ((0.01, 0.0), (0.0, 0.01), (-0.01, 0.0), (0.01, 0.01))
    ]
    simulated = Problem.simulated
    growing = iter((np.inf, 1e305, np.nan))

    def unstable(self: Problem, clock: float, rows: Array, runs: Index, **more: Any) -> Outcome:
        found = simulated(self, clock, rows, runs, **more)
        if found.change is not None:
            for other, factor in enumerate(growing):
                found.change[:, other] = factor
        return found

    monkeypatch.setattr(Problem, "simulated", unstable)
    told = problem.near((), ways, everyone)
    exact = problem.residuals([way(1.0) for way in ways], [everyone] * len(ways))
    for one, other in zip(told[:3], exact, strict=False):
        np.testing.assert_array_equal(one, other)
    assert np.isfinite(told[3]).all() and not np.array_equal(told[3], exact[3])


def test_a_run_that_takes_too_many_steps_is_told_more_coarsely(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It stayed where the steps ended: a contact twenty times as steep left 200 times the noise."""
    fine, coarse = replace(problem, rtol=1e-7), replace(problem, rtol=1e-5)
    everyone = np.arange(len(problem.trials))
    exact = predicted(fine)
    steps = coarse.simulated(1.0, stack([pack(coarse.model(()))]), everyone).steps.sum(axis=1)
    monkeypatch.setattr(module, "_MOST_STEPS", int(steps.max()) + 1)
    ended = fine.simulated(1.0, stack([pack(fine.model(()))]), everyone).ending
    assert set(ended.tolist()) == {Ending.TOO_LONG}
    np.testing.assert_allclose(predicted(fine), exact, atol=1e-4)
