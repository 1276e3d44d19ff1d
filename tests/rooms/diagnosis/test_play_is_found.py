"""Play between motors and wheels: found without being told, and not where there is none."""

from __future__ import annotations

from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.wheel_play import WheelPlay

SMALL = {"count": 7, "duration_s": 2.5, "rate_hz": 100.0}


def test_play_is_found_and_its_interval_holds_the_truth() -> None:
    plant = Plant(name="play", traces=(Trace.ACTUATION,), effects=(WheelPlay(play_rad=0.02),))
    found = diagnose(planted(smooth_kiwi(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "wheel_play" and finding.traced_to is Trace.ACTUATION
    (play,) = finding.parameters
    assert play.low <= 0.02 <= play.high and play.high - play.low < 0.002
    assert found.before.chi > 1.5 and found.after.chi < 1.06


def test_no_play_is_found_where_there_is_none() -> None:
    found = diagnose(planted(smooth_kiwi(), None, seed=4, **SMALL), seed=1)
    assert found.verdict is Verdict.NO_MISSING_EFFECT and not found.findings
