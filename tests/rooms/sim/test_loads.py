"""Every external force has a height: it shifts the wheel loads, and with them the friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manoeuvres import wheel_motion
from oracles.plain_simulator import reference_motion
from strategies import four_wheels, kiwi

from slipmargin.errors import MotionStopped
from slipmargin.model import nominal_model
from slipmargin.physics.terms import ForceTerm, Multiplier
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot import LoadRule
from slipmargin.sim.batch import Push
from slipmargin.sim.signal import held, linear
from slipmargin.sim.simulate import simulate

STILL = held(np.array([0.0, 0.3]), np.zeros((2, 3)))


def on_a_slope(model, degrees, height_m=None):
    """The model on a floor that falls towards +y, by its weight's component along and off the floor."""
    a, weight = np.deg2rad(degrees), model.inertia.weight_N
    slope = ForceTerm(
        variable=Variable.UNITY,
        basis=Basis.CONSTANT,
        coefficients=weight * np.array([[0.0], [-np.sin(a)], [0.0]]),
        shape=np.ones(2),
        frame=Frame.FLOOR,
        height_m=height_m,
        lift_N=weight * (1.0 - np.cos(a)),
    )
    return replace(model, external=replace(model.external, terms=(*model.external.terms, slope)))


@pytest.mark.parametrize("rule", [LoadRule.EQUAL, LoadRule.STATIC, LoadRule.QUASI_STATIC])
def test_loads_on_a_slope_are_those_of_statics(rule):
    """4 degrees with the centre of mass 80 mm up: 8.57 N on the upper wheel, it was 9.81 on each."""
    model = nominal_model(kiwi(30.0, com_height_m=0.08, load_rule=rule), "paper")
    run = simulate(on_a_slope(model, 4.0), STILL, np.array([0.0, 0.3]))
    total, lever = 29.43 * np.cos(np.deg2rad(4.0)), 29.43 * np.sin(np.deg2rad(4.0)) * 0.08
    want = [total / 3 - lever / (3 * 0.095)] * 2 + [total / 3 + 2 * lever / (3 * 0.095)]
    np.testing.assert_allclose(run.load[-1], want, atol=0.02)  # the creep still settles
    np.testing.assert_allclose(sorted(want), [9.18, 9.18, 11.0], atol=0.01)
