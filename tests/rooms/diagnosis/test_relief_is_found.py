"""A ramp and a hollow of the floor: found without being told, where they are."""

from __future__ import annotations

import numpy as np
from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.floor_bump import FloorBump
from slipmargin.effects.floor_ramp import FloorRamp

SMALL = {"count": 8, "duration_s": 2.5, "rate_hz": 100.0}


def test_a_ramp_is_found_and_its_intervals_hold_the_truth() -> None:
    """Up one way is down the other way: the same strip with its other end for a beginning.

    Of four intervals of 95 % chance leaves the truth outside one in one of five draws.  All four hold it in
    95 % where each is 1.27 times as wide (Bonferroni: 2.50 standard deviations instead of 1.96).
    """
    truth = FloorRamp(slope_rad=0.03, offset_m=-0.3, direction_rad=4.0, length_m=0.2)
    plant = Plant(name="ramp", traces=(Trace.POSITION,), effects=(truth,))
    found = diagnose(planted(smooth_kiwi(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "floor_ramp" and finding.traced_to is Trace.POSITION
    other = {"slope_rad": -0.03, "offset_m": 0.1, "direction_rad": 4.0 - np.pi, "length_m": 0.2}
    own = {p.name: p for p in finding.parameters}
    want = other if own["slope_rad"].value < 0.0 else {k: getattr(truth, k) for k in other}
    turns = 2.0 * np.pi * np.round((own["direction_rad"].value - want["direction_rad"]) / (2.0 * np.pi))
    want["direction_rad"] += turns
    for name, value in want.items():
        half = 0.5 * (own[name].high - own[name].low)
        assert abs(value - own[name].value) <= 1.27 * half, (name, value, own[name])
    assert found.before.chi > 3.0 and found.after.chi < 1.06


def test_a_hollow_is_found_where_it_is() -> None:
    """A seam was claimed for a dip that all runs crossed, and a lump under the carpet stayed unexplained."""
    truth = FloorBump(height_m=-0.01, centre_x_m=0.1, centre_y_m=-0.05, radius_m=0.12)
    plant = Plant(name="hollow", traces=(Trace.POSITION,), effects=(truth,))
    found = diagnose(planted(smooth_kiwi(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == "floor_bump" and finding.traced_to is Trace.POSITION
    for p in finding.parameters:  # Bonferroni, as above
        assert abs(getattr(truth, p.name) - p.value) <= 1.27 * 0.5 * (p.high - p.low), p
    assert found.before.chi > 3.0 and found.after.chi < 1.06
