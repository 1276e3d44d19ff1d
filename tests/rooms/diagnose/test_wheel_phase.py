"""Rotor angles that were not logged: found again where the wheels care, and no reason to see ghosts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planting import Plant, planted, smooth_kiwi

from slipmargin.data.data_set import DataSet
from slipmargin.diagnose.diagnosis import Verdict
from slipmargin.diagnose.loop import diagnose
from slipmargin.effects import Trace
from slipmargin.effects.rigid_sector import RigidSector

SMALL = {"count": 6, "duration_s": 2.5, "rate_hz": 100.0}


def without_angles(data: DataSet) -> DataSet:
    return replace(data, trials=tuple(replace(t, theta=None) for t in data.trials))


def test_rigid_material_is_found_without_logged_angles() -> None:
    truth = RigidSector(rigid_fraction=0.10, rigid_coefficient=0.47)
    plant = Plant(name="rigid", traces=(Trace.WHEEL_ANGLE,), effects=(truth,))
    found = diagnose(without_angles(planted(smooth_kiwi(), plant, seed=3, **SMALL)), seed=1)
    assert found.findings[0].name == "rigid_sector"
    values = {p.name: p.value for p in found.findings[0].parameters}
    assert values["rigid_fraction"] == pytest.approx(0.10, abs=0.02)
    assert found.after.chi < 0.6 * found.before.chi


def test_free_angles_are_no_reason_to_see_rigid_material() -> None:
    data = without_angles(planted(smooth_kiwi(), None, seed=5, **SMALL))
    found = diagnose(data, seed=1)
    assert found.verdict is Verdict.NO_MISSING_EFFECT
    assert found.before.chi == pytest.approx(1.0, abs=0.08)
    assert np.isfinite(found.before.rmse_position_m)
