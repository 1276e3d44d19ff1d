"""Drives that do not answer small commands are found as what they are."""

from __future__ import annotations

from planting import Plant, commanded, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.command_dead_band import CommandDeadBand


def test_a_dead_band_is_found() -> None:
    """Creep stiffness over the slip ratio came first among the leads, and nothing was found."""
    plant = Plant(name="dead", traces=(Trace.ACTUATION,), effects=(CommandDeadBand(dead_band_rad_s=1.5),))
    data = commanded(smooth_kiwi(), plant, 3, count=8, duration_s=2.5, rate_hz=100.0)
    found = diagnose(data, seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "command_dead_band" and finding.traced_to is Trace.ACTUATION
    (band,) = finding.parameters
    assert band.low < 1.5 < band.high and band.high - band.low < 0.2
    assert found.before.chi > 2.0 and found.after.chi < 1.1
