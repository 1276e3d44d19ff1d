"""Rolling resistance acts at the axles: its loads are those of statics with the floor's force moved ahead."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.effects.trailing_load import TrailingLoad
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_state import Motion
from slipmargin.robot import LoadRule

SHARE = 0.03


@pytest.mark.parametrize("heading_deg", [0.0, 50.0, 90.0, 200.0])
def test_loads_are_those_of_a_floor_force_ahead_of_each_wheel(heading_deg: float) -> None:
    robot = kiwi(20.0)
    model = Recipe(robot=robot, effects=(RollingResistance(coefficient=SHARE),)).build("paper")
    ahead = np.array([np.cos(np.deg2rad(heading_deg)), np.sin(np.deg2rad(heading_deg)), 0.0])
    motion = Motion(velocity=ahead[None])
    _, loads = external_in_motion(model, motion).middle(np.zeros(2))
    # By statics: at constant speed the floor pushes up c ρ ahead of each wheel, and balances the weight.
    lead = SHARE * robot.wheels[0].radius_m * ahead[:2]
    place = model.geometry.position_m + lead - model.inertia.com_m
    still = np.linalg.solve(np.vstack([np.ones(3), place.T]), [model.inertia.weight_N, 0.0, 0.0])
    level = np.linalg.solve(np.vstack([np.ones(3), (place - lead).T]), [model.inertia.weight_N, 0.0, 0.0])
    change = loads[0] - model.loads.rest_N
    np.testing.assert_allclose(change, still - level, atol=2e-3 * np.max(np.abs(still - level)))
    behind = np.argmin(model.geometry.position_m @ ahead[:2])
    assert change[behind] > 0.0


def test_larger_wheels_shift_more_load_and_standing_still_none() -> None:
    robot = kiwi(20.0)
    model = Recipe(robot=robot, effects=(RollingResistance(coefficient=SHARE),)).build("paper")
    steady, rising, turning = model.external.terms
    assert steady.height_m == rising.height_m == pytest.approx(robot.wheels[0].radius_m)
    assert turning.height_m == 0.0
    standing = external_in_motion(model, Motion(velocity=np.zeros((1, 3)))).middle(np.zeros(2))[1]
    np.testing.assert_allclose(standing[0], model.loads.rest_N, rtol=1e-9)


@pytest.mark.parametrize("lever_m", [0.004, -0.003])
@pytest.mark.parametrize("com_m", [(0.0, 0.0), (0.03, -0.02)], ids=["even", "uneven"])
@pytest.mark.parametrize("heading_deg", [0.0, 50.0, 90.0, 200.0])
def test_a_trailing_load_balances_the_weight_ahead_of_each_axle(
    heading_deg: float, com_m: tuple[float, float], lever_m: float
) -> None:
    """However unequal the loads are: Σ N_i (p_i + e v̂) = W com, and nothing brakes."""
    robot = kiwi(20.0, com_m=com_m, load_rule=LoadRule.STATIC)
    model = Recipe(robot=robot, effects=(TrailingLoad(lever_m=lever_m),)).build("paper")
    ahead = np.array([np.cos(np.deg2rad(heading_deg)), np.sin(np.deg2rad(heading_deg)), 0.0])
    wrench, loads = external_in_motion(model, Motion(velocity=ahead[None])).middle(np.zeros((1, 2)))
    np.testing.assert_allclose(wrench, 0.0, atol=1e-12)
    weight = model.inertia.weight_N
    centre = loads[0] @ (model.geometry.position_m + lever_m * ahead[:2]) / weight
    np.testing.assert_allclose(centre, model.inertia.com_m, atol=2e-3 * abs(lever_m))
    assert np.sum(loads) == pytest.approx(weight)
    standing = external_in_motion(model, Motion(velocity=np.zeros((1, 3)))).middle(np.zeros((1, 2)))[1]
    np.testing.assert_allclose(standing[0], model.loads.rest_N, rtol=1e-9)


def test_a_trailing_load_of_one_wheel_counts_by_what_that_wheel_carries() -> None:
    robot = kiwi(20.0, com_m=(0.03, -0.02), load_rule=LoadRule.STATIC)
    motion = Motion(velocity=np.array([[0.3, 0.4, 0.0]]))
    level = Recipe(robot=robot).build("paper").loads.rest_N

    def change(*wheels: str) -> np.ndarray:
        model = Recipe(robot=robot, effects=(TrailingLoad(lever_m=0.004, wheels=wheels),)).build("paper")
        return external_in_motion(model, motion).middle(np.zeros((1, 2)))[1][0] - level

    for wheel, load in zip(robot.wheels, level, strict=True):
        np.testing.assert_allclose(change(wheel.name), change() * load / np.sum(level), atol=1e-12)
