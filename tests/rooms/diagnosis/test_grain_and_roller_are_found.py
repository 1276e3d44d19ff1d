"""A weave of the floor and one heavy roller: found without being told, their intervals hold the truth."""

from __future__ import annotations

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Trace
from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.effects.effect import Effect
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.floor_weave import FloorWeave
from slipmargin.effects.stiff_roller import StiffRoller

SMALL = {"count": 7, "duration_s": 2.5, "rate_hz": 100.0}


@pytest.mark.parametrize(
    "effect",
    [
        FloorGrain(cosine=0.03, sine=-0.04),
        FloorWeave(cosine=-0.03, sine=0.04),
        DraggingPoint(force_N=0.6, place_x_m=-0.02, place_y_m=0.06),
        StiffRoller(factor=2.5, angle_rad=1.9, wheels=("2",)),
    ],
    ids=lambda e: e.name,
)
def test_it_is_found_by_its_name(effect: Effect) -> None:
    plant = Plant(name="plant", traces=(effect.traced_to,), effects=(effect,))
    found = diagnose(planted(smooth_kiwi(), plant, seed=3, **SMALL), seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == effect.name and finding.traced_to is effect.traced_to
    if effect.traced_to is Trace.WHEEL_ANGLE:
        assert finding.wheels == ("2",)
    true = {p.name: getattr(effect, p.name) for p in effect.parameters}
    for p in finding.parameters:
        turn = 2.0 * np.pi * round((p.value - true[p.name]) / (2.0 * np.pi)) if "angle" in p.name else 0.0
        half = 0.5 * (p.high - p.low)
        assert abs(p.value - turn - true[p.name]) <= 2.0 * half, p  # 95 % intervals, twice as wide
    assert found.before.chi > 1.5 and found.after.chi < 1.06
