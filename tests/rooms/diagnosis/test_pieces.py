"""The last fit of what stays far above the noise: in pieces, since what a model lacks adds up along a run."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.fit import fit
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import fitted, longer, longest_piece_s
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Trace
from slipmargin.effects.wheel_loads import WheelLoads

SIGMA = np.array([5e-4, 5e-4, 2e-3])
SHIFT = np.array([0.012, -0.008])
EVERY = np.arange(6)


@pytest.fixture(scope="module")
def problem() -> Problem:
    truth = WheelLoads(shift_x_m=SHIFT[0], shift_y_m=SHIFT[1], com_share=1.0)
    plant = Plant(name="loads", traces=(Trace.WHEEL_LOAD,), effects=(truth,))
    data = planted(smooth_kiwi(), plant, seed=2, count=6, duration_s=15.0, rate_hz=50.0)
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    return Problem.of(data.recipe, data.surface, trials, SIGMA, False)


def wandering(problem: Problem, seed: int, rate: float) -> Problem:
    """Each run pushed about by what no model holds: a random walk of ``rate`` metres a root second."""
    random = np.random.default_rng(seed)
    steps = rate * np.sqrt(0.02) * random.normal(size=problem.measured.shape) * np.array([1.0, 1.0, 3.0])
    return replace(problem, measured=problem.measured + np.cumsum(steps, axis=1))


def candidate(problem: Problem) -> Candidate:
    named = named_candidates(problem.nominal.geometry.names, False, ())
    return next(c for c in named if c.label == "wheel_loads")


def off(x: Array) -> float:
    return float(np.hypot(*(x - SHIFT)))


def test_what_wanders_is_fitted_better_in_pieces(problem: Problem) -> None:
    loads = candidate(problem)
    whole, last = [], []
    for seed in range(10):
        astray = wandering(problem, seed, 6e-3)
        assert fitted(astray, (), np.zeros(0), EVERY, EVERY).chi > SETTINGS.far_chi
        whole.append(off(fit(astray, (loads,), SHIFT, EVERY).x))
        last.append(off(fit(astray.in_pieces(SETTINGS.piece_s), (loads,), SHIFT, EVERY).x))
    assert np.sqrt(np.mean(np.square(last))) < 0.5 * np.sqrt(np.mean(np.square(whole)))


def test_pieces_grow_until_what_is_left_stands_out(problem: Problem) -> None:
    first = fitted(problem.in_pieces(0.1), (), np.zeros(0), EVERY, EVERY)
    assert first.chi < SETTINGS.far_chi
    grown = longer(problem, first, EVERY)
    assert grown.chi >= SETTINGS.far_chi and grown.view.piece_s < 7.5
    before = fitted(problem.in_pieces(0.5 * grown.view.piece_s), (), np.zeros(0), EVERY, EVERY)
    assert before.chi < SETTINGS.far_chi, "no longer than needed"
    right = fitted(problem.in_pieces(0.1), (candidate(problem),), SHIFT, EVERY, EVERY)
    assert longer(problem, right, EVERY).view.piece is None, "whole runs where they come near the noise"


def test_pieces_are_as_long_as_asked_while_a_run_has_two(problem: Problem) -> None:
    first = fitted(problem.in_pieces(0.1), (), np.zeros(0), EVERY, EVERY)
    enough = longer(problem, first, EVERY).view.piece_s
    asked = longer(problem, first, EVERY, 2.0 * enough).view.piece_s
    assert asked == pytest.approx(2.0 * enough, rel=0.1)
    most_s = 0.5 * problem.trials[0].t_s[-1]
    assert 0.5 * most_s < longer(problem, first, EVERY, 1e3).view.piece_s <= most_s


def test_a_clock_that_begins_late_makes_no_run_longer() -> None:
    """Half of the clock was taken for half a run."""
    late = SimpleNamespace(t_s=1e5 + np.arange(301) * 0.01)
    assert longest_piece_s(SimpleNamespace(trials=[late]), np.arange(1)) == pytest.approx(1.5)  # type: ignore[arg-type]
