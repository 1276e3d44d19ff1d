"""Pulls of unknown noise: whose noise it is, what time takes, and what evidence counts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from planted_pulls import FULL, QUARTER, data_set, planted, pulled, robot

import slipmargin as sm
import slipmargin.diagnosis.pull_diagnosis as room
from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis import watch as watches
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.pull_candidates import pull_candidates
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.watch import Watch
from slipmargin.report.pulls import summary_lines

NAMES = {"wheel_loads", "friction_coefficients", "floor_tilt"}


@pytest.fixture(autouse=True)
def few_candidates(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a test takes seconds."""

    def some(problem: PullProblem) -> list[Candidate]:
        return [c for c in pull_candidates(problem) if c.name in NAMES]

    monkeypatch.setattr(room, "pull_candidates", some)


def shifted() -> DataSet:
    """Orientations far apart, few of them pulled twice: the limit's own bends look like noise."""
    loads = planted("wheel_loads", shift_x_m=0.004, shift_y_m=0.01, com_share=1.0)
    phi = np.concatenate([FULL[::2], FULL[:6:2]])
    return data_set(robot(), pulled(robot().with_effects(loads), phi_rad=phi, repeats=1))


def test_noise_that_the_model_found_leaves_is_said_and_counted_as_such(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    freedoms = []
    judged = room.Unseen.of

    class Seen:
        @staticmethod
        def of(*args: object) -> object:
            freedoms.append(args[3])
            return judged(*args)  # type: ignore[arg-type]

    monkeypatch.setattr(room, "Unseen", Seen)
    found = sm.diagnose(shifted())
    assert found.to_dict()["noise_from"] == "residual"
    assert freedoms == [15 - 2]  # fifteen pulls, two parameters
    assert found.verdict == "effect-found"
    said = " ".join(found.lines())
    assert "neighbouring" not in said and "its chi is near 1, whatever it misses" in said
    found.write_folder(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "from what the model found leaves of all pulls" in page


@pytest.mark.parametrize("late", [False, True], ids=["time for a second search", "none"])
def test_a_new_noise_does_not_cost_what_was_found(monkeypatch: pytest.MonkeyPatch, late: bool) -> None:
    """The first search took its share; the second had nothing of it, and what was found was lost."""
    now, calls = [0.0], [0]
    monkeypatch.setattr(watches, "clock_s", lambda: now[0])
    searched = room.search

    def search(problem: PullProblem, groups: object, candidates: object, seed: int, watch: Watch) -> object:
        calls[0] += 1
        assert watch.until_s is not None
        if late and calls[0] == 2:
            now[0] = watch.until_s
        out = searched(problem, groups, candidates, seed, watch)  # type: ignore[arg-type]
        if calls[0] == 1:
            now[0] = watch.until_s
        return out

    monkeypatch.setattr(room, "search", search)
    found = room.diagnose_pulls(shifted(), budget_s=100.0)
    assert found.verdict is Verdict.EFFECT_FOUND and [f.name for f in found.findings] == ["wheel_loads"]
    assert found.sigma_N < 0.1 and found.after.chi < 1.5
    assert found.found_in == found.folds
    taken = next(t for t in found.steps[0].tried if t.label == "wheel_loads")
    assert taken.chi < 2.0 < found.steps[0].chi_before  # both of the new noise


def test_evidence_counts_alike_with_and_without() -> None:
    """Where wheels may stand on rigid material, what a state leaves is not all that a pull says."""
    tilt = planted("floor_tilt", tilt_x_rad=0.03, tilt_y_rad=-0.02)
    pulls = pulled(robot(0.1).with_effects(tilt), phi_rad=QUARTER, repeats=3, angles=False)
    found = sm.diagnose(data_set(robot(0.1), replace(pulls, sigma_N=0.06)))
    plain = found.to_dict()
    (effect,) = plain["effects"]
    step = plain["steps"][0]
    assert effect["evidence"]["chi_without"] == pytest.approx(step["chi_before"])
    own = next(t for t in step["tried"] if t["label"] == step["taken"])
    assert effect["evidence"]["chi_with"] == pytest.approx(own["chi"])
    assert step["chi_before"] != pytest.approx(plain["before"]["chi"])
    assert plain["leads"] and all(
        lead["evidence"]["chi_before"] == step["chi_before"] for lead in plain["leads"]
    )
    open_ = replace(found.diagnosis, verdict=Verdict.UNEXPLAINED)
    (first, *_) = (line for line in summary_lines(open_, found.change) if line.startswith("lead"))
    assert f"(chi {step['chi_before']:.3g} → " in first
