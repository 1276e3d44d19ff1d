"""Drives that do not do what they are told are found as what they are."""

from __future__ import annotations

import pytest
from planting import Plant, commanded, smooth_kiwi

from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Verdict
from slipmargin.effects import Effect, Trace
from slipmargin.effects.command_dead_band import CommandDeadBand
from slipmargin.effects.command_ramp import CommandRamp
from slipmargin.effects.command_saturation import CommandSaturation
from slipmargin.effects.effect import WheelEffect
from slipmargin.effects.motor_torque import MotorTorque
from slipmargin.effects.speed_droop import SpeedDroop

EVERY = ("1", "2", "3")


@pytest.mark.parametrize(
    ("effect", "widest"),
    [
        (CommandDeadBand(dead_band_rad_s=1.5), 0.2),
        (CommandRamp(ramp_s2_per_rad=0.015), 0.001),
        (CommandSaturation(saturation_s_per_rad=0.1, wheels=("2",)), 0.01),
        (MotorTorque(shortfall=2.0, wheels=("2",)), 0.2),
        (SpeedDroop(droop_rad_s_per_N_m=20.0, wheels=("2",)), 2.0),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_a_faulty_drive_is_found(effect: Effect, widest: float) -> None:
    """Actuation was not among the leads, or not the first: creep, load or a wheel of its own were."""
    plant = Plant(name=effect.name, traces=(Trace.ACTUATION,), effects=(effect,))
    data = commanded(smooth_kiwi(), plant, 3, count=8, duration_s=2.5, rate_hz=100.0)
    found = diagnose(data, seed=1)
    assert found.verdict is Verdict.EFFECT_FOUND
    (finding,) = found.findings
    assert finding.name == effect.name and finding.traced_to is Trace.ACTUATION
    assert finding.wheels == (effect.wheels if isinstance(effect, WheelEffect) and effect.wheels else EVERY)
    size, truth = finding.parameters[0], effect.values()[0]
    assert size.low < truth < size.high and size.high - size.low < widest
    assert found.before.chi > 2.0 and found.after.chi < 1.1
    model = smooth_kiwi().with_effects(effect).build("paper")
    for mine, true in zip(finding.derived, effect.derived(model), strict=True):
        assert mine.name == true.name and mine.low < true.value < mine.high
