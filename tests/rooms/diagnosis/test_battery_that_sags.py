"""Drives whose speed falls in the course of a run, as a weak battery makes them, are traced to the drives."""

from __future__ import annotations

from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace


def test_speed_that_falls_with_time_is_found() -> None:
    """No form wrote it: the answer was unexplained."""
    plant = Plant(
        name="sag",
        traces=(Trace.ACTUATION,),
        commands=lambda t, omega: omega * (1.0 - 0.08 * t / t[-1])[:, None],
    )
    found = diagnose(planted(smooth_kiwi(), plant, 3, count=8, duration_s=2.5, rate_hz=100.0), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    assert [f.traced_to for f in found.findings] == [Trace.ACTUATION]
    assert "speed over time" in found.findings[0].label
    assert found.before.chi > 2.0 and found.after.chi < 1.3
