"""A place of the body that drags: what limits count of it while the robot turns on the spot."""

from __future__ import annotations

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.effects import Recipe
from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.errors import InputError
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_state import Motion
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable


def test_turning_on_the_spot_it_resists_by_force_times_distance() -> None:
    recipe = Recipe(robot=kiwi(com_m=(0.0, 0.0)))
    model = recipe.with_effects(DraggingPoint(force_N=2.0, place_x_m=0.03, place_y_m=-0.04)).build("paper")
    still, turning = np.zeros((1, 3)), np.array([[0.0, 0.0, 500.0]])
    wrench, _ = external_in_motion(model, Motion(velocity=turning)).middle(np.zeros(2))
    np.testing.assert_allclose(wrench[0], [-2.0 * 0.8, -2.0 * 0.6, -2.0 * 0.05], rtol=1e-6)
    assert not np.any(external_in_motion(model, Motion(velocity=still)).middle(np.zeros(2))[0])


def test_a_place_is_refused_where_nothing_acts_at_a_place() -> None:
    with pytest.raises(InputError, match="place_m: is given with the frame body"):
        ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            shape=np.ones(2),
            frame=Frame.BODY,
            coefficients=np.ones((3, 1)),
            place_m=np.array([0.1, 0.0]),
        )
