"""Pulls beyond the paper's: direction, point, moment, height; biases; answers known by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import four_wheels, kiwi, models

from slipmargin.effects import Recipe
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits import Pull, pull_limit, sensitivity, sweep
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.robot import GripShape, LoadRule

PHI = np.linspace(0.0, 2.0 * np.pi, 25)
WEIGHT = 3.0 * GRAVITY_M_S2


def test_moment_alone_by_hand() -> None:
    # Three drives at the same lever arm r: the pure moment limit is 3 N μ_W r = m g μ_W r; the axles have
    # no moment.  A pull at a very long lever is nearly a pure moment.
    model = nominal_model(kiwi(30.0), "paper")
    lever = 1e6
    force = limit(model, np.array([0.4]), Pull(moment_m=lever))[0]
    assert force * lever == pytest.approx(WEIGHT * 0.26 * 0.095, rel=1e-6)


def test_point_of_application_is_a_moment() -> None:
    model = nominal_model(kiwi(com_m=(0.01, -0.02), load_rule=LoadRule.STATIC), "paper")
    phi, at = 0.6, np.array([0.05, 0.03])
    arm = at - np.array([0.01, -0.02])
    lever = arm[0] * np.sin(-phi) - arm[1] * np.cos(-phi)
    one = limit(model, np.array([phi]), Pull(point_m=at))
    two = limit(model, np.array([phi]), Pull(moment_m=lever))
    np.testing.assert_allclose(one, two, rtol=1e-14)
    assert one[0] < limit(model, np.array([phi]), Pull())[0]


def test_tip_over_by_hand() -> None:
    # Four wheels at y = ±0.2 m, weight in the middle: pulled along +y at height z the rear pair lifts
    # where F z = m g 0.2.  High friction, so that it does not slip first.
    model = nominal_model(four_wheels(), "carpet")
    weight = model.inertia.weight_N
    high = 0.2 / (0.1 * 0.25)  # tips at a tenth of the drive coefficient
    force = limit(model, np.array([0.0]), Pull(direction_rad=np.pi / 2, height_m=high))[0]
    assert force == pytest.approx(weight * 0.2 / high, rel=1e-12)
    found = sensitivity(model, np.array([0.0]), Pull(direction_rad=np.pi / 2, height_m=high))
    assert found.wheels()[0][-2:] == ("tip-over at rl", "tip-over at rr")
    assert found.forces()[0][-2:] == ("tip-over at rl", "tip-over at rr")
    binding = pull_limit(model, 0.0, Pull(direction_rad=np.pi / 2, height_m=high)).binding()
    assert {"floor under rl", "floor under rr"} & set(binding)


def test_cones_name_the_tipping_wheels_too() -> None:
    model = nominal_model(four_wheels(grip=GripShape.ELLIPSE), "carpet")
    pull = Pull(direction_rad=np.pi / 2, height_m=8.0)
    assert limit(model, np.array([0.0]), pull)[0] == pytest.approx(model.inertia.weight_N * 0.025, rel=1e-7)
    assert sensitivity(model, np.array([0.0]), pull).wheels()[0][-2:] == ("tip-over at rl", "tip-over at rr")


@settings(max_examples=40, deadline=None)
@given(models())
def test_height_goes_to_zero_smoothly(model: Model) -> None:
    np.testing.assert_allclose(limit(model, PHI, Pull(height_m=1e-9)), limit(model, PHI, Pull()), rtol=1e-6)


def test_pull_towards_the_heavy_side_holds_better() -> None:
    # Pulled high along +x the right wheel gains what the others lose; mirrored pulls mirror the answer.
    model = nominal_model(kiwi(), "paper")
    right, left = (
        limit(model, np.array([0.3]), Pull(height_m=0.1)),
        limit(model, np.array([-0.3]), Pull(direction_rad=np.pi, height_m=0.1)),
    )
    np.testing.assert_allclose(right, left, rtol=1e-12)


@pytest.mark.parametrize("shape", GripShape)
def test_slope_adds_to_a_pull_downhill(shape: GripShape) -> None:
    # The slope's pull is m g sin(tilt) along +x of the floor: a pull along +x has that much less to do,
    # whatever the heading; one uphill that much more.  The wheels carry m g cos(tilt).
    tilt = 0.02
    slope = FloorTilt(tilt_x_rad=tilt, tilt_y_rad=0.0)
    model = Recipe(robot=kiwi(grip=shape), effects=(slope,)).build("paper")
    level = np.cos(tilt) * limit(nominal_model(kiwi(grip=shape), "paper"), PHI, Pull())
    down, uphill = np.sin(tilt) * WEIGHT, Pull(direction_rad=np.pi)
    np.testing.assert_allclose(limit(model, PHI, Pull()), level - down, rtol=1e-7)
    np.testing.assert_allclose(limit(model, PHI, uphill), level + down, rtol=1e-7)


@pytest.mark.parametrize("shape", GripShape)
def test_slope_too_steep_to_stand_on(shape: GripShape) -> None:
    steep = FloorTilt(tilt_x_rad=0.25, tilt_y_rad=0.0)
    model = Recipe(robot=kiwi(grip=shape), effects=(steep,)).build("paper")
    with pytest.raises(NoSolution, match="slips without any pull"):
        sweep(model, PHI)
    with pytest.raises(NoSolution, match="slips without any pull"):
        pull_limit(model, 0.0, Pull(direction_rad=np.pi))  # pulled uphill it would hold, were it let


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("direction_rad", float("nan")),
        ("height_m", -0.1),
        ("moment_m", float("inf")),
        ("point_m", [1.0, 2.0, 3.0]),
    ],
)
def test_bad_pulls_are_refused_by_name(key: str, value: object) -> None:
    with pytest.raises(InputError, match=key):
        Pull(**{key: value})  # type: ignore[arg-type]
