"""Runs of another floor differ from end to end, not only where they cross a place."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray
from spoilt import good

from slipmargin.diagnosis import other_floor
from slipmargin.diagnosis.problem import Problem


@pytest.mark.parametrize(("left", "apart"), [(1.0, True), (1.2, True), (4.4, False)])
def test_runs_that_another_friction_does_not_explain_are_no_other_floor(
    monkeypatch: pytest.MonkeyPatch, left: float, apart: bool
) -> None:
    """A slick patch that two of eight runs crossed was left out as another floor, and not found."""
    data = good()
    crossed = np.arange(len(data.trials)) < 2

    def cost(problem: Problem, frictions: tuple[float, ...], runs: NDArray[np.int64]) -> NDArray[np.float64]:
        off = np.array(frictions)[:, None] - np.where(crossed[runs], 0.8, 1.0)
        return np.where(crossed[runs], left, 1.0) + (60.0 * off) ** 2

    monkeypatch.setattr(other_floor, "_cost", cost)
    kept, said = other_floor.one_floor(data)
    assert [r.kind for r in said] == ["other_floor"] * apart
    assert len(kept.trials) == len(data.trials) - 2 * apart


def test_beside_something_else_that_is_missing_few_runs_are_no_other_floor(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A robot of 1.7 times its file's inertia gripped less in the runs that turned: those were left out."""
    data = good()
    crossed = np.arange(len(data.trials)) < 2
    usual = np.concatenate([[1.0, 1.0], np.linspace(1.0, 40.0, len(data.trials) - 2)])

    def cost(problem: Problem, frictions: tuple[float, ...], runs: NDArray[np.int64]) -> NDArray[np.float64]:
        off = np.array(frictions)[:, None] - np.where(crossed[runs], 0.6, 1.0)
        return np.where(crossed[runs], 25.0, usual[runs]) + (150.0 * off) ** 2

    monkeypatch.setattr(other_floor, "_cost", cost)
    kept, said = other_floor.one_floor(data)
    assert not said and kept is data


def test_a_short_run_counts_by_what_was_seen_of_it() -> None:
    """Beside runs five times as long its error was read as a fifth: another floor was not looked for."""
    residual = np.array([[3.0, -3.0, 0.0, 0.0, 0.0, 0.0], [3.0, 3.0, -3.0, 3.0, -3.0, 3.0]])
    stand_in = SimpleNamespace(
        nominal=SimpleNamespace(count=3), residuals=lambda effects, runs: [residual[r] for r in runs]
    )
    assert other_floor._cost(stand_in, (1.0,), np.arange(2)).tolist() == [[9.0, 9.0]]  # type: ignore[arg-type]
