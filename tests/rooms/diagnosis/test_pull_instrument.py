"""Pull tests that are wrong themselves: what one number explains is said before a name is believed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from planted_pulls import data_set, planted, pulled, robot

import slipmargin.diagnosis.pull_diagnosis as room
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.pull_candidates import pull_candidates
from slipmargin.diagnosis.pull_instrument import faults
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.result import Verdict

SIGMA_N = 0.06
#: What is wrong, what is said of it, and its number.
WRONG: dict[str, tuple[Callable[[Pulls], Pulls], str, float]] = {
    "gain": (lambda p: replace(p, force_N=1.08 * p.force_N), "a scale that reads 1.", 0.08),
    "tare": (lambda p: replace(p, force_N=p.force_N + 0.3), "a scale that reads 0.", 0.3 / 5.93),
    "zero": (lambda p: replace(p, phi_rad=p.phi_rad + 0.12), "a zero of the orientations", 0.12),
    "drift": (
        lambda p: replace(p, force_N=p.force_N * np.linspace(1.0, 0.9, len(p.force_N))),
        "a force that falls",
        -0.1,
    ),
}


@pytest.mark.parametrize("kind", WRONG)
def test_each_is_found_with_its_size(kind: str) -> None:
    wrong, said, share = WRONG[kind]
    pulls = wrong(pulled(robot(), seed=3))
    best, *others = faults(PullProblem.of(robot(), "paper", pulls, SIGMA_N, noise_known=True))
    assert best.said.startswith(said) and best.share == pytest.approx(share, abs=0.01)
    assert best.cost < 1.5 * len(pulls.force_N) and best.cost < min(f.cost for f in others)


def told(monkeypatch: pytest.MonkeyPatch, pulls: Pulls, *names: str) -> tuple[Verdict, list[str]]:
    """The verdict of a search over few names, and what is to be ruled out first.

    Of a finding that is what cannot be told from it, too.
    """

    def some(problem: PullProblem) -> list[Candidate]:
        return [c for c in pull_candidates(problem) if c.name in names]

    monkeypatch.setattr(room, "pull_candidates", some)
    found = room.diagnose_pulls(data_set(robot(), replace(pulls, sigma_N=SIGMA_N)))
    beside = [label for f in found.findings for label in f.confused_with]
    first = [said for said in found.remarks if said.endswith("rule that out first.")]
    assert not found.findings or [said[1:].split(" explains")[0] for said in first] == [b[1:] for b in beside]
    return found.verdict, first


def test_a_turned_zero_is_said_beside_the_tilt_that_stands_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Orientations 7° off were called a tilt of the floor of 1.4°, found in five of five searches."""
    wrong, said, _ = WRONG["zero"]
    verdict, first = told(monkeypatch, wrong(pulled(robot())), "floor_tilt")
    assert verdict is Verdict.EFFECT_FOUND
    assert len(first) == 1 and first[0].startswith(f"A{said[1:]}")
    assert "explains these pulls as well as floor_tilt" in first[0]


def test_wear_is_said_where_nothing_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    verdict, first = told(monkeypatch, WRONG["drift"][0](pulled(robot())), "wheel_loads")
    assert verdict is Verdict.UNEXPLAINED
    assert len(first) == 1 and "from the first row to the last (as a floor wears) explains these" in first[0]


def test_nothing_is_said_of_the_test_where_the_robot_explains_more(monkeypatch: pytest.MonkeyPatch) -> None:
    real = robot().with_effects(planted("floor_tilt", tilt_x_rad=0.03, tilt_y_rad=-0.02))
    verdict, first = told(monkeypatch, pulled(real), "floor_tilt")
    assert verdict is Verdict.EFFECT_FOUND and not first
    assert told(monkeypatch, pulled(robot()), "floor_tilt") == (Verdict.NO_MISSING_EFFECT, [])
