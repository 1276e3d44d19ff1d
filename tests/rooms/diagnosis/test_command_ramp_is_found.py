"""Drives that ramp their commands are found as what they are."""

from __future__ import annotations

from planting import Plant, commanded, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.command_ramp import CommandRamp


def test_a_ramp_is_found() -> None:
    """Nothing was found, and actuation was not among the leads."""
    plant = Plant(name="ramp", traces=(Trace.ACTUATION,), effects=(CommandRamp(ramp_s2_per_rad=0.015),))
    data = commanded(smooth_kiwi(), plant, 3, count=8, duration_s=2.5, rate_hz=100.0)
    found = diagnose(data, seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "command_ramp" and finding.traced_to is Trace.ACTUATION
    (ramp,) = finding.parameters
    assert ramp.low < 0.015 < ramp.high < 0.016
    assert found.before.chi > 3.0 and found.after.chi < 1.1
    (fastest,) = finding.derived
    assert fastest.name == "fastest_rad_s2" and fastest.low < 1.0 / 0.015 < fastest.high
