"""Where a search begins: not at all in quiet runs, with few trials, in pieces where whole runs bend."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from spoilt import good

from slipmargin.checks import Array
from slipmargin.data.noise import LastingNoise
from slipmargin.diagnosis.bends import bends
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.held_out import errors_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import fitted
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, quiet
from slipmargin.diagnosis.telling import enough


@pytest.fixture(scope="module")
def problem() -> Problem:
    return problem_of(good(3))


@pytest.fixture(scope="module")
def state(problem: Problem) -> State:
    every = np.arange(len(problem.trials), dtype=np.int64)
    return fitted(problem, (), np.zeros(0), every, every.tolist())


def louder(state: State, factor: Array) -> State:
    """Each run's residual times a factor (R,)."""
    residual = state.fit.residual * factor[:, None]
    fit = replace(state.fit, residual=residual)
    return replace(state, fit=fit, scores=np.sum(residual**2, axis=1))


def test_runs_with_nothing_but_noise_are_quiet(state: State) -> None:
    assert quiet(state)


def test_runs_that_are_all_a_little_too_loud_are_not_quiet(state: State) -> None:
    assert not quiet(louder(state, np.full(len(state.scores), 1.1 * SETTINGS.quiet_chi)))


def test_one_run_far_above_its_noise_is_not_quiet_though_all_together_are(state: State) -> None:
    factor = np.full(len(state.scores), 0.9)
    factor[0] = 1.4
    loud = louder(state, factor)
    assert loud.chi < SETTINGS.quiet_chi and not quiet(loud)


def test_errors_larger_than_noise_are_not_quiet_however_long_that_lasts(problem: Problem) -> None:
    """Noise that lasts takes up what is missing; the errors themselves tell."""
    every = np.arange(len(problem.trials), dtype=np.int64)
    lasting = LastingNoise(share=np.full(3, 0.7), time_s=np.full(3, 0.2))
    sigma = problem.sigma / np.sqrt(0.3)
    slow = replace(problem, lasting=lasting, sigma=sigma)
    assert quiet(fitted(slow, (), np.zeros(0), every, every.tolist()))
    way = np.sin(np.linspace(0.0, np.pi, problem.measured.shape[1]))[:, None] * 8.0 * sigma * (1.0, 1.0, 0.0)
    off = fitted(replace(slow, measured=problem.measured + way), (), np.zeros(0), every, every.tolist())
    errors = errors_of(off.view, every, *off.view.compare([()], [every])[0])
    assert off.chi <= SETTINGS.quiet_chi and errors.size(sigma) > SETTINGS.noise_size
    assert not quiet(off)


@pytest.mark.parametrize(("knots", "many"), [(10.0, 8), (400.0, 5), (2000.0, 4)])
def test_fewer_trials_are_searched_where_each_has_more_samples(knots: float, many: int) -> None:
    seen = np.arange(3, 20, dtype=np.int64)
    some = enough(seen, knots)
    assert len(some) == many and some[0] == 3 and some[-1] == 19 and np.isin(some, seen).all()


def test_few_trials_are_all_searched() -> None:
    seen = np.array([1, 4, 5], dtype=np.int64)
    np.testing.assert_array_equal(enough(seen, 10.0), seen)


def test_runs_bend_where_they_miss_much_of_their_way_or_of_their_heading(problem: Problem) -> None:
    every = np.arange(len(problem.trials), dtype=np.int64)
    assert not bends(problem, every, ())
    share = np.linspace(0.0, 1.0, problem.measured.shape[1])[None, :, None]
    way = float(np.median(np.ptp(problem.measured[:, :, 0], axis=1)))
    for off, astray in (([0.3 * way, 0.0, 0.0], True), ([0.0, 0.0, 0.4], True), ([0.0, 0.0, 0.01], False)):
        there = replace(problem, measured=problem.measured + share * np.array(off))
        assert bends(there, every, ()) is astray
