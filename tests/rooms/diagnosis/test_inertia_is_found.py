"""A yaw inertia other than the file's: found as what it is, and it counts wherever the robot turns."""

from __future__ import annotations

from dataclasses import replace

from planting import Plant, planted, smooth_kiwi

import slipmargin as sm
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.yaw_inertia import YawInertia

SMALL = {"count": 8, "duration_s": 2.5, "rate_hz": 100.0}


def test_a_yaw_inertia_is_found() -> None:
    """It was a form without a name, or runs that turned were taken for another floor's."""
    plant = Plant(name="inertia", traces=(Trace.ACCELERATION,), effects=(YawInertia(inertia_factor=1.7),))
    found = diagnose(planted(smooth_kiwi(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "yaw_inertia" and finding.traced_to is Trace.ACCELERATION
    (factor,) = finding.parameters
    assert factor.low < 1.7 < factor.high < 1.75
    (own,) = finding.derived
    assert own.name == "inertia_kg_m2" and own.value > 1.6 * smooth_kiwi().robot.body.inertia_kg_m2
    assert found.before.chi > 3.0 and found.after.chi < 1.06


def test_it_counts_in_limits_as_the_files_own_inertia_does() -> None:
    recipe = smooth_kiwi()
    body = replace(recipe.robot.body, inertia_kg_m2=1.7 * recipe.robot.body.inertia_kg_m2)
    one = sm.bounds(recipe.with_effects(YawInertia(inertia_factor=1.7)), "paper", step_deg=45.0)
    two = sm.bounds(replace(recipe, robot=replace(recipe.robot, body=body)), "paper", step_deg=45.0)
    plain = sm.bounds(recipe, "paper", step_deg=45.0)
    assert one.to_json() == two.to_json() != plain.to_json()
