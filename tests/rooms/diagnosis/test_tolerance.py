"""A search simulates as coarsely as what it compares allows, and no coarser."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import planted

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.fit import fit, misfit_of
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import FINE_RTOL, Problem
from slipmargin.diagnosis.tolerance import eased, fitted_finely
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.io.robot_file import read_recipe

SIGMA = np.array([5e-4, 5e-4, 2e-3])
EVERYONE = np.arange(3)


@pytest.fixture(scope="module")
def problem() -> Problem:
    data = planted(read_recipe("ohio-kiwi"), None, seed=2, count=3, duration_s=2.0, rate_hz=50.0)
    trials = tuple(clean(record, SIGMA) for record in data.trials)
    return Problem.of(data.recipe, data.surface, trials, SIGMA, False)


def error(problem: Problem, residual: Array, effects: tuple[FrictionCoefficients, ...]) -> float:
    exact = replace(problem, rtol=1e-8).residuals([effects], [EVERYONE])[0]
    return float(np.sqrt(np.mean((residual - exact) ** 2)))


def test_a_search_simulates_as_finely_as_its_noise_asks(problem: Problem) -> None:
    """Friction at the edge of slipping made one tolerance wrong by a quarter of the noise on some robots."""
    chosen = []
    for times in (100.0, 1.0, 0.01):
        case = replace(problem, sigma=times * problem.sigma)
        view = eased(case, EVERYONE)
        chosen.append(view.rtol)
        if times >= 1.0:
            assert error(case, view.residuals([()], [EVERYONE])[0], ()) < 0.05
    assert chosen == sorted(chosen, reverse=True) and chosen[0] > chosen[2]


def test_a_fit_is_simulated_as_finely_as_what_it_leaves(problem: Problem) -> None:
    """A droop needed a tolerance a hundred times finer than the model as it is, and lost its name."""
    candidates = named_candidates(problem.nominal.geometry.names, False, (), {"body": 0.1})
    factor = next(c for c in candidates if c.label == "friction_coefficients")
    less = FrictionCoefficients(drive_factor=0.8, transverse_factor=1.0)
    measured = replace(problem, rtol=1e-8).predict([(less,)], [EVERYONE])[0]
    sharp = replace(problem, measured=measured, sigma=0.05 * problem.sigma, rtol=1e-3)
    rough = fit(sharp, (factor,), factor.starts[0], EVERYONE)
    assert error(sharp, rough.residual, rough.effects) > 0.4 * np.sqrt(misfit_of(rough.residual))
    view, found = fitted_finely(sharp, (factor,), factor.starts[0], EVERYONE)
    assert FINE_RTOL <= view.rtol < sharp.rtol
    assert error(view, found.residual, found.effects) < 0.35 * np.sqrt(misfit_of(found.residual))
    assert fitted_finely(view, (factor,), found.x, EVERYONE)[0] is view, "it is fine enough"
