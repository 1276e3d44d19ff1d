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
        coefficients=weight * np.array([[0.0], [np.sin(a)], [0.0]]),
        shape=np.ones(2),
        frame=Frame.FLOOR,
        height_m=height_m,
        lift_N=weight * (1.0 - np.cos(a)),
    )
    return replace(model, external=replace(model.external, terms=(*model.external.terms, slope)))


@pytest.mark.parametrize("rule", [LoadRule.EQUAL, LoadRule.STATIC, LoadRule.QUASI_STATIC])
def test_loads_on_a_slope_are_those_of_statics(rule):
    """4 degrees with the centre of mass 80 mm up: 8.57 N on the upper wheel; it was 9.81 on each."""
    robot = kiwi(30.0, radius_m=0.09, com_height_m=0.08, load_rule=rule)
    run = simulate(on_a_slope(nominal_model(robot, "paper"), 4.0), STILL, np.array([0.0, 0.3]))
    np.testing.assert_allclose(run.load[-1], [10.394, 10.394, 8.570], atol=2e-3)


def test_a_push_shifts_the_loads_by_its_height():
    """A steady push forwards at 0.1 m presses the front wheels: Σ N_i p_i = h F with the robot at rest."""
    model = nominal_model(kiwi(load_rule=LoadRule.STATIC), "paper")
    push = Push(t_s=np.array([0.0, 1.0]), wrench=np.tile([0.5, 2.0, 0.0], (2, 1)), height_m=0.1)
    run = simulate(model, STILL, np.array([0.0, 0.3]), push=push)
    at = run.load[-1] @ (model.geometry.position_m - model.inertia.com_m)
    c, s = np.cos(run.pose[-1, 2]), np.sin(run.pose[-1, 2])
    np.testing.assert_allclose(at, 0.1 * np.array([0.5 * c + 2.0 * s, 2.0 * c - 0.5 * s]), atol=1e-9)
    np.testing.assert_allclose(run.load[-1].sum(), model.inertia.weight_N, rtol=1e-12)


def test_a_force_high_up_tips_a_robot_whose_loads_ignore_acceleration():
    model = nominal_model(kiwi(load_rule=LoadRule.STATIC), "paper")
    push = Push(t_s=np.array([0.0, 0.3]), wrench=np.array([[0.0, 0.0, 0.0], [0.0, 6.0, 0.0]]), height_m=0.4)
    with pytest.raises(MotionStopped, match="a wheel lifts off"):
        simulate(model, STILL, np.array([0.0, 0.3]), push=push)


def test_friction_over_the_load_sees_the_loads_of_forces():
    """Against the second road: slope, lift, load transfer and a friction that falls with the load at once."""
    model = nominal_model(four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.08), "paper")
    falling = Multiplier(
        variable=Variable.WHEEL_LOAD,
        basis=Basis.POLYNOMIAL,
        coefficients=np.array([-0.5]),
        shape=np.ones(2),
        wheels=np.ones(4),
        target=Target.BOTH,
    )
    model = on_a_slope(replace(model, grip=replace(model.grip, multipliers=(falling,))), 5.0)
    rates = np.array([[0.0] * 4, [6.0, 4.0, 7.0, 3.0], [2.0, 2.0, 2.0, 3.0]])
    signal, times = linear(np.array([0.0, 0.05, 0.1]), rates), np.linspace(0.0, 0.1, 5)
    want = reference_motion(model, wheel_motion(signal), signal.knots_s, times)
    pose = simulate(model, signal, times).pose
    assert np.abs(pose - want).max() <= 1e-6 * np.abs(want).max()
    low = replace(model, external=replace(model.external, terms=()))
    assert np.abs(simulate(low, signal, times).pose - pose).max() > 1e-3 * np.abs(want).max()
