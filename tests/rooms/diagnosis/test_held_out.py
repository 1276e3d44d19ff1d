"""Errors of runs that were held out: where noise lasts, a sample counts for what is new in it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from spoilt import coloured, good

from slipmargin.diagnosis.conditions import held_runs_of, ready
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.held_out import held_out_runs, predicted, score, searched_runs


def test_chi_of_noise_that_lasts_is_that_of_whitened_gaps() -> None:
    data = good(4)
    assert data.sigma is not None
    data = ready(coloured(data, np.random.default_rng(4), 2.0 * data.sigma, 0.3)).data_set
    assert data.lasting is not None
    problem = problem_of(data)
    everyone = np.arange(len(problem.trials))
    errors = predicted(problem, everyone, data.trials, [()] * len(everyone), phased=False).errors
    found = score(errors, everyone)
    residual = problem.residuals([()], [everyone])[0]
    assert found.chi == pytest.approx(np.sqrt(np.sum(residual**2) / problem.seen.sum()), rel=1e-12)
    pose = problem.predict([()], [everyone])[0]
    off = np.where(problem.seen, problem.measured - pose, 0.0)[..., :2]
    samples = problem.seen[..., 0].sum()
    assert found.rmse_position_m == pytest.approx(np.sqrt(np.sum(off**2) / samples), rel=1e-12)


def test_the_noise_is_measured_on_runs_that_are_not_held_out() -> None:
    data = replace(good(4), sigma=None)
    held = ready(data, seed=3).held
    random = np.random.default_rng(0)
    trials = tuple(
        replace(t, pose=t.pose + 0.01 * random.standard_normal(t.pose.shape)) if i in held else t
        for i, t in enumerate(data.trials)
    )
    one = ready(data, seed=3).data_set
    two = ready(replace(data, trials=trials), seed=3, held=held).data_set
    assert one.sigma is not None and two.sigma is not None
    np.testing.assert_array_equal(two.sigma, one.sigma)
    assert sorted([*held, *searched_runs(len(data.trials), held)]) == list(range(len(data.trials)))


@pytest.mark.parametrize("seed", range(5))
def test_few_runs_that_show_it_are_on_both_sides(seed: int) -> None:
    misses = np.array([1.0, 9.0, 1.01, 0.99, 5.0, 1.02, 0.98, 1.0])
    held = held_out_runs(misses, seed)
    assert len(held) == 2 and 4 in held and 1 not in held
    assert {tuple(held_out_runs(np.linspace(9.0, 8.0, 20), s)) for s in range(5)} != {tuple(held)}
    assert len(held_out_runs(misses[:5], seed)) == 0
    near = np.array([1.0, 3.7, 1.01, 0.93, 0.96, 1.33, 1.11])
    assert 5 in held_out_runs(near, seed) and 1 not in held_out_runs(near, seed)


def test_outliers_make_no_quiet_run_a_loud_one() -> None:
    data = good(4)
    assert data.sigma is not None
    drifts = [
        replace(t, pose=t.pose + 0.3 * k * data.sigma * (t.t_s / t.t_s[-1])[:, None])
        for k, t in enumerate(data.trials)
    ]
    wrong = drifts[0].pose.copy()
    speed = np.hypot(*np.gradient(wrong[:, :2], axis=0).T)
    # The robot is fast there: by its own motion such a frame is not too far from those around it.
    wrong[np.flatnonzero(speed > 5.0 * data.sigma[0])[::12], 0] += 18.0 * data.sigma[0]
    quiet, loud = (
        replace(data, trials=(replace(drifts[0], pose=pose), *drifts[1:])) for pose in (drifts[0].pose, wrong)
    )
    first = np.zeros(1, dtype=np.int64)
    assert problem_of(loud).misses((), first)[0] > 1.4  # more than any other run
    for seed in range(5):
        np.testing.assert_array_equal(held_runs_of(loud, seed), held_runs_of(quiet, seed))
