"""Rolling resistance acts at the axles: its loads are those of statics with the floor's force moved ahead."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_state import Motion

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
