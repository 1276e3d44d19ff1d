"""The loop end to end on small sets: the paper's own story, nothing missing, something nobody named."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnoses import taken_for_noise
from planting import Plant, force, planted

from slipmargin.diagnosis import loop
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Recipe, Trace
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.io.robot_file import read_recipe
from slipmargin.physics.variables import Frame, Variable
from slipmargin.robot import Robot, Surface

SMALL = {"count": 7, "duration_s": 2.5, "rate_hz": 100.0}


def initial_model() -> Recipe:
    """The paper's robot before its authors looked at the wheels: rollers all round."""
    robot: Robot = read_recipe("ohio-kiwi").robot
    wheels = tuple(replace(w, rigid_fraction=0.0) for w in robot.wheels)
    paper = robot.surface("paper")
    floor = Surface(name="paper", roller=paper.roller, rigid=paper.roller)
    return Recipe(robot=replace(robot, wheels=wheels, surfaces=(floor,)))


def test_the_papers_own_story() -> None:
    # Williams et al. 2002: rigid material over 10 % of each of 8 sectors, coefficient 0.47 on paper.
    truth = RigidSector(rigid_fraction=0.10, rigid_coefficient=0.47)
    plant = Plant(name="rigid", traces=(Trace.WHEEL_ANGLE,), effects=(truth,))
    found = diagnose(planted(initial_model(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "rigid_sector" and finding.traced_to is Trace.WHEEL_ANGLE
    values = {p.name: p for p in finding.parameters}
    assert values["rigid_fraction"].value == pytest.approx(0.10, abs=0.01)
    assert values["rigid_coefficient"].value == pytest.approx(0.47, rel=0.10)
    assert values["rigid_fraction"].low <= 0.10 <= values["rigid_fraction"].high
    assert {p.name: p.value for p in finding.derived} == {"sectors_per_turn": 8.0}
    assert found.before.chi > 3.0 and found.after.chi < 1.15
    assert found.after.rmse_position_m < 0.5 * found.before.rmse_position_m
    assert len(found.held_out) == 2 and not found.cross_validated
    assert finding.p_value <= 0.01 and finding.candidates_tried > 40
    wheels = found.corrected.build("paper").grip
    assert wheels.rigid_fraction == pytest.approx([0.10] * 3, abs=0.01)


def test_nothing_is_missing_where_nothing_is() -> None:
    found = diagnose(planted(initial_model(), None, seed=5, **SMALL), seed=1)
    assert found.verdict is Verdict.NO_MISSING_EFFECT
    assert found.findings == () and found.after == found.before
    assert found.before.chi == pytest.approx(1.0, abs=0.06)
    assert found.corrected.effects == ()


def test_an_effect_that_leaves_white_noise_explains_more_than_noise_that_lasts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What a model lacks may look like noise that lasts for seconds: seen in a judged set."""
    monkeypatch.setattr(loop, "ready", taken_for_noise(loop.ready))
    worn = FrictionCoefficients(drive_factor=0.8, transverse_factor=0.9)
    plant = Plant(name="worn", traces=(Trace.COEFFICIENT,), effects=(worn,))
    found = diagnose(planted(initial_model(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND and found.after.chi < 1.1
    still = diagnose(planted(initial_model(), None, seed=5, **SMALL), seed=1)
    assert still.verdict is Verdict.NO_MISSING_EFFECT


def test_an_effect_nobody_named_is_traced_and_added() -> None:
    sloshing = force(
        Trace.ACCELERATION, Variable.ACCELERATION_Y, 1, lambda a: -0.9 * a, -6.0, 6.0, Frame.BODY
    )
    plant = Plant(name="sloshing load", traces=(Trace.ACCELERATION,), effects=(sloshing,))
    # Ten runs: of seven, four of six had to tell it from chance, and one more or less hung on rounding.
    found = diagnose(planted(initial_model(), plant, seed=8, **{**SMALL, "count": 10}), seed=1)
    assert found.findings[0].traced_to is Trace.ACCELERATION
    assert found.findings[0].name == "unnamed_acceleration"
    assert found.after.chi < 0.5 * found.before.chi


def test_the_same_seed_gives_the_same_answer_and_few_trials_are_cross_validated() -> None:
    truth = RigidSector(rigid_fraction=0.15, rigid_coefficient=0.47)
    plant = Plant(name="rigid", traces=(Trace.WHEEL_ANGLE,), effects=(truth,))
    data = planted(initial_model(), plant, seed=11, count=3, duration_s=1.5, rate_hz=50.0)
    one, two = diagnose(data, seed=4), diagnose(data, seed=4)
    assert one.cross_validated and one.held_out == ()
    assert one.before == two.before and one.after == two.after
    assert [f.parameters for f in one.findings] == [f.parameters for f in two.findings]


def test_one_run_is_not_called_cross_validated() -> None:
    """Nothing is left out of one run."""
    data = planted(initial_model(), None, seed=5, count=1, duration_s=1.5, rate_hz=50.0)
    found = diagnose(data, seed=1)
    assert found.one_run and not found.cross_validated and found.held_out == ()
