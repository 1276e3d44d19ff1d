"""Stopping: shortest within the margin, driven in simulation, refused where no braking keeps it."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status
from strategies import high_kiwi

import slipmargin as sm
from slipmargin.errors import InputError, NoSolution
from slipmargin.robot import Coefficients, Surface

BUILT_IN = [("ohio-kiwi", "paper"), ("mecanum4", "floor"), ("robotino", "gray"), ("omni4", "floor")]


@pytest.mark.parametrize("named", BUILT_IN, ids=lambda n: n[0])
def test_simulated_stops_keep_the_margin_and_the_distance(named: tuple[str, str]) -> None:
    found = sm.stop(*named, step_deg=45.0)
    assert found.verified and np.max(found.use) > 0.85  # and it brakes as hard as the margin allows
    np.testing.assert_allclose(found.simulated_m, found.distance_m, rtol=0.06)


def test_braking_at_the_golden_limit() -> None:
    """docs/theory.md, section 4: along +X the paper's robot brakes with 1.6388 m/s², all of its grip."""
    found = sm.stop("ohio-kiwi", "paper", speeds_m_s=[1.0], margin=0.0, step_deg=90.0, verify=False)
    assert found.braking.deceleration[0, -1] == pytest.approx(1.6388, rel=2e-3)
    assert 1.0 / (2.0 * 1.6388) < found.distance_m[0, 0] < 1.02 / (2.0 * 1.6388)


def test_a_high_centre_of_mass_makes_stops_longer() -> None:
    low = sm.read_robot("mecanum4")
    tall, taller = (
        replace(low, robot=replace(low.robot, body=replace(low.robot.body, com_height_m=h)))
        for h in (0.3, 0.6)
    )
    far = [
        sm.stop(r, "floor", speeds_m_s=[1.0], step_deg=90.0, verify=False).distance_m.max()
        for r in (tall, taller)
    ]
    assert far[1] > 1.02 * far[0]


def test_the_command_writes_what_it_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told, out = tmp_path / "stop.json", tmp_path / "stop.csv"
    words = ["stop", "robotino", "--surface", "gray", "--speed", "0.5", "--speed", "0.2", "--step", "90"]
    assert status([*words, "--json", str(told), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert said.startswith("longest") and "keeps the margin" in said
    data = json.loads(told.read_text(encoding="utf-8"))
    assert data["speed_m_s"] == [0.2, 0.5] and data["verified"] is True
    assert len(out.read_text(encoding="utf-8").splitlines()) == 1 + 4 * 2


def test_the_last_digit_does_not_choose_among_equal_directions() -> None:
    found = sm.stop("mecanum4", "floor", speeds_m_s=[1.0], step_deg=45.0, verify=False)
    for digit in (1.0 - 1e-15, 1.0 + 1e-15):  # four directions are equal: one of them a little longer
        far = found.distance_m * np.where(np.arange(8) == 3, digit, 1.0)[:, None]
        told = replace(found, distance_m=far)
        assert told.longest == 1 and told.shortest == 0
        assert "towards 45°" in told.lines()[0]


def test_refusals(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["stop", "mecanum4", "--surface", "floor", "--speed", "9"]) == 2
    assert "the motors allow" in capsys.readouterr().err
    with pytest.raises(InputError, match="give speeds above 0"):
        sm.stop("robotino", "gray", speeds_m_s=[0.0])


def test_a_stop_that_takes_longer_than_ten_minutes_is_none() -> None:
    """Simulated, one of years asked for terabytes; not simulated, it was told as a result."""
    with pytest.raises(NoSolution, match=r"takes .* s: at .* m/s only .* m/s² keep the margin"):
        sm.stop("robotino", "gray", speeds_m_s=[1.0], step_deg=90.0, margin=1.0 - 1e-12)


def test_a_safety_scanner_is_given_the_longest_stop_that_was_seen() -> None:
    """The simulated stops are a little longer than the computed ones: the page named the shorter number."""
    found = sm.stop("mecanum4", "floor", speeds_m_s=[0.8], step_deg=45.0)
    longest = max(float(np.max(found.distance_m)), float(np.max(found.simulated_m)))
    assert f"Give a safety scanner {longest:.3g} m" in found.page_text(None).replace("\xa0", " ")
    apart = 100.0 * (found.simulated_m / found.distance_m - 1.0)
    said = f"distances differ by {np.min(apart):+.1f} to {np.max(apart):+.1f} %"
    assert any(said in line for line in found.lines())


def test_a_stop_that_tips_in_simulation_is_told_beside_the_others() -> None:
    """One of 72 stops tipped, and the whole table was lost."""
    found = sm.stop(high_kiwi(), "floor", speeds_m_s=[0.25], step_deg=15.0)
    early = np.isnan(found.simulated_m)
    assert 0 < len(found.ended) == np.count_nonzero(early) < early.size and not found.verified
    assert all("it tips" in why for why in found.ended) and np.all(np.isfinite(found.distance_m))
    said = found.lines()[-1]
    assert said.startswith(f"{len(found.ended)} of them do not reach their end: from 0.25 m/s towards ")
    assert len(found.to_dict()["simulations_ended_early"]) == len(found.ended)
    assert f"{len(found.ended)} of 24 end early" in found.page_text()


def test_a_wheel_that_lifts_is_not_told_as_grip_that_is_used_up() -> None:
    """Every stop kept the margin, and the page said that one used more grip than that."""
    found = sm.stop("mecanum4", "floor", speeds_m_s=[0.5], step_deg=90.0)
    up = replace(found, in_air_s=np.where(np.arange(4) == 1, 0.05, 0.0)[:, None])
    assert found.verified and not up.verified
    line = next(line for line in up.lines() if line.startswith("simulated 4 stops: "))
    assert line.startswith("simulated 4 stops: keeps the margin, but wheels lift, uses at most 0.9")
    said = up.page().lead
    assert said.endswith("In simulation a wheel lifts in 1 of 4 stops: do not rely on these distances.")
    over = replace(up, use=found.use + 0.2)
    assert any("does NOT keep the margin, uses at most 1.1" in line for line in over.lines())
    assert "In simulation a stop used more grip than that" in over.page().lead
    assert "simulation" not in found.page().lead and up.page().lead_kind == "attention"


def test_the_speed_that_is_said_to_be_possible_is() -> None:
    """A start at 0.014 m/s was refused with the cure 'ask for a lower speed', which no one could tell."""
    bare = high_kiwi()
    grip = Coefficients(drive=0.4, transverse=0.35)
    rough = replace(bare, surfaces=(Surface(name="floor", roller=grip, rigid=grip),))
    with pytest.raises(NoSolution, match="no braking keeps the margin") as refused:
        sm.stop(rough, "floor", speeds_m_s=[1.0], step_deg=30.0)
    most = float(re.search(r"ask for ([\d.]+) m/s", str(refused.value))[1])  # type: ignore[index]
    assert sm.stop(rough, "floor", speeds_m_s=[most], step_deg=30.0, verify=False).distance_m.max() > 0.0


def test_every_sentence_gives_the_longest_stop_that_was_seen() -> None:
    """The command printed the planned distance where its summary had the simulated one."""
    found = sm.stop("ohio-kiwi", "paper", speeds_m_s=[0.5], step_deg=45.0)
    longest = f"{found.farthest_m:.4g} m"
    assert found.farthest_m == np.max(found.simulated_m) > np.max(found.distance_m)
    assert longest in found.summary() and f"({longest} in simulation)" in found.lines()[0]
    page = " ".join(re.sub(r"<[^>]*>", " ", found.page_text(None).replace("\xa0", " ")).split())
    assert f"Longest stop {longest}" in page
