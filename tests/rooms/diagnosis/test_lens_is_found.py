"""A camera whose lens bends the picture: found without being told, with the point that it looks at."""

from __future__ import annotations

from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.camera_lens import CameraLens


def test_a_barrel_is_found() -> None:
    """Free cubics along x and along y hold no product of both: such sets were unexplained.

    Of three intervals of 95 % all hold the truth in 95 % where each is 1.22 times as wide (Bonferroni).
    """
    truth = CameraLens(bend_per_m2=-0.06, centre_x_m=0.2, centre_y_m=-0.1)
    plant = Plant(name="barrel", traces=(Trace.MEASUREMENT,), effects=(truth,))
    found = diagnose(planted(smooth_kiwi(), plant, seed=3, count=8, duration_s=2.5, rate_hz=100.0), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "camera_lens" and finding.traced_to is Trace.MEASUREMENT
    for p in finding.parameters:
        assert abs(getattr(truth, p.name) - p.value) <= 1.22 * 0.5 * (p.high - p.low), p
    assert found.before.chi > 1.5 and found.after.chi < 1.06
