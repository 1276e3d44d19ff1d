"""What the printed results leave open, on a tenth of the runs; the whole study: benchmarks/paper.py."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from slipmargin.paper.identify import STEPS, identifiability
from slipmargin.plots.reproduction import identifiability_figure
from slipmargin.report.reproduction import studies_report, study_lines

KEPT = Path(__file__).resolve().parents[3] / "benchmarks" / "results" / "paper.json"


@pytest.fixture(scope="module")
def found():
    calls = []
    done = identifiability(seed=3, runs=0.04, advance=lambda: calls.append(1))
    assert len(calls) == STEPS
    return done


def test_a_valley_of_equal_misfit(found) -> None:
    """A review of the first release found it: a valley from (0.075 m, 0.4) to (0.1025 m, 1.7)."""
    first, *_, last = found.ridge
    assert (first.radius_m, last.radius_m) == (0.075, 0.1025)
    assert first.beta == pytest.approx(0.4, abs=0.02) and last.beta == pytest.approx(1.7, abs=0.15)
    assert all(p.initial < 0.7 for p in found.ridge)
    assert np.median(found.misfit) > 2.0  # away from the valley it is worse


def test_the_sign_on_carpet_stays(found) -> None:
    """A review of the first release: draws of r, β, angles in [−1.35, −0.27]; the others at most +0.08."""
    draws, *single, at_once = found.signs
    assert -1.35 <= draws.low_rad <= draws.high_rad <= -0.27
    assert all(s.high_rad <= 0.08 for s in single)
    assert at_once.high_rad < 0.558 / 4.0


def test_it_is_drawn_and_told(found) -> None:
    identifiability_figure(found).draw_without_rendering()
    assert len(study_lines(found)) == 2 + len(found.ridge) + len(found.signs)
    assert studies_report(found)["carpet_phi"][0]["runs"] == found.signs[0].runs


def test_the_kept_study_is_the_whole_one() -> None:
    kept = json.loads(KEPT.read_text(encoding="utf-8"))["identifiability"]
    draws, states, layouts, rear, at_once = kept["carpet_phi"]
    assert draws["runs"] == 2500 and layouts["runs"] == 3000 and states["runs"] == 8
    assert draws["low_rad"] >= -1.35 and draws["high_rad"] <= -0.27
    assert max(s["high_rad"] for s in (states, layouts, rear)) <= 0.08
    assert 0.08 < at_once["high_rad"] < 0.11  # varied all at once: a little more
