"""The second road that every sweep reports."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import NARROW, four_wheels, kiwi, models, narrow

from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.recipe import with_effects
from slipmargin.limits import sweep
from slipmargin.limits.self_check import self_check
from slipmargin.model import Model, nominal_model
from slipmargin.robot import GripShape, Robot

PHI = np.array([0.1, 1.3, 4.0])


@settings(max_examples=15, deadline=None)
@given(models(shapes=tuple(GripShape)))
def test_it_agrees_on_drawn_robots(model: Model) -> None:
    force = sweep(model, PHI, with_band=False).f_max_N
    exact = model.grip.shape is GripShape.BOX
    assert self_check(model, PHI, force) < (1e-10 if exact else 1e-7)


@pytest.mark.parametrize("kind", NARROW)
@pytest.mark.parametrize("shape", GripShape)
def test_it_finds_the_end_of_a_narrow_valley(shape: GripShape, kind: str) -> None:
    # Rollers that hardly grip across their axles: the support function is a valley two hundred times as long
    # as it is wide.  A search that closed in on both variables at once stopped 1.7e-3 (omni, disc-strip) and
    # 2.8e-5 (mecanum, box) above its end.
    model = nominal_model(narrow(kind, shape), "floor")
    force = sweep(model, PHI, with_band=False).f_max_N
    assert self_check(model, PHI, force) < (1e-10 if shape is GripShape.BOX else 1e-8)


@pytest.mark.parametrize(
    "robot",
    [kiwi(), four_wheels(), four_wheels(grip=GripShape.ELLIPSE)],
    ids=["kiwi", "mecanum", "mecanum-ellipse"],
)
def test_it_sees_a_wrong_number_and_a_slope(robot: Robot) -> None:
    model = nominal_model(robot, "paper")
    force = sweep(model, PHI, with_band=False).f_max_N
    for wrong in (1.001, 0.999):
        assert self_check(model, PHI, wrong * force) == pytest.approx(1e-3, rel=0.01)
    tilted = with_effects(model, (FloorTilt(tilt_x_rad=0.01, tilt_y_rad=0.0),))
    pulled = sweep(tilted, PHI, with_band=False).f_max_N
    assert np.all(np.abs(pulled / force - 1.0) > 1e-3)
    assert self_check(tilted, PHI, pulled) < 1e-6
