"""What is recommended for a robot with an effect needs no more grip than it says, at any speed to 1 m/s."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import four_wheels, kiwi

from slipmargin.api.bounds import bounds
from slipmargin.effects import Effect, Recipe
from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.effects.trailing_load import TrailingLoad
from slipmargin.limits.bounds import ahead_of
from slipmargin.limits.motion import needed_share
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import Robot

MARGIN = 0.1
SPEEDS = (0.05, 0.2, 1.0)


def most_used(model: Model, acceleration_m_s2: float) -> float:
    """The largest share of a wheel's grip that speeding up so needs, in any direction and at all speeds."""
    ahead = ahead_of(np.deg2rad(np.arange(0.0, 360.0, 15.0)))
    return max(
        float(
            np.max(
                needed_share(
                    model,
                    Motion(velocity=speed * ahead, acceleration=acceleration_m_s2 * ahead, saturated=True),
                )
            )
        )
        for speed in SPEEDS
    )


@pytest.mark.parametrize(
    "effect",
    [
        RollingResistance(coefficient=0.02),
        RollingResistance(coefficient=0.0, viscous_N_s_per_m=0.5),
        RollingResistance(coefficient=0.01, yaw_share=3.0),
        DraggingPoint(force_N=1.0, place_x_m=0.1),
        TrailingLoad(lever_m=0.01),
    ],
    ids=["rolling", "viscous", "yaw", "point", "trailing"],
)
@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "four"])
def test_a_recommended_acceleration_needs_no_more_grip_at_any_speed(robot: Robot, effect: Effect) -> None:
    recipe = Recipe(robot=robot, effects=(effect,))
    found = bounds(recipe, "paper", margin=MARGIN, step_deg=15.0)
    assert found.recommended_m_s2 > 0.0
    assert most_used(recipe.build("paper"), found.recommended_m_s2) <= 1.0 - MARGIN + 1e-6
    growing = any("follows the speed" in w for w in found.warnings)
    assert growing == (getattr(effect, "viscous_N_s_per_m", 0.0) > 0.0)


def test_at_full_drag_a_force_that_fades_out_is_full() -> None:
    plain = Recipe(robot=kiwi()).build("paper")
    term = ForceTerm(
        variable=Variable.VELOCITY_X,
        basis=Basis.ODD,
        frame=Frame.BODY,
        shape=np.array([0.02, 0.0]),
        coefficients=np.array([[-0.4], [0.0], [0.0]]),
    )
    model = replace(plain, external=replace(plain.external, terms=(term,)))
    crawl = external_in_motion(model, Motion.full_drag(np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])))
    np.testing.assert_allclose(crawl.low.sum(axis=0)[:, 0], [-0.4, 0.4], rtol=1e-6)
    real = external_in_motion(model, Motion(velocity=np.array([[0.02, 0.0, 0.0]])))
    np.testing.assert_allclose(real.low.sum(axis=0)[0, 0], -0.2, rtol=1e-9)
