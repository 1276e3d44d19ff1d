"""Motors that give less torque than they are asked for count in limits as weaker motors do."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from planting import smooth_kiwi

import slipmargin as sm
from slipmargin.effects.motor_torque import MotorTorque
from slipmargin.limits.bounds import directions
from slipmargin.robot import Motor


@pytest.mark.parametrize("stated", [None, 0.4], ids=["no torque in the file", "a torque in the file"])
def test_it_counts_in_limits_as_a_motor_of_that_torque_does(stated: float | None) -> None:
    recipe = smooth_kiwi()
    motor = None if stated is None else Motor(max_speed_rad_s=1e6, stall_torque_N_m=stated)
    weak = replace(recipe, robot=replace(recipe.robot, motor=motor)).with_effects(MotorTorque(shortfall=1.5))
    torque = weak.build("paper").drives.stall_torque_N_m
    nominal = recipe.build("paper")
    grip = np.mean(nominal.grip.roller[:, 0] * nominal.loads.rest_N * nominal.geometry.radius_m)
    assert 1.0 / torque == pytest.approx((0.0 if stated is None else 1.0 / stated) + 1.5 / grip, rel=1e-12)
    own = replace(recipe.robot, motor=Motor(max_speed_rad_s=1e6, stall_torque_N_m=torque))
    models = [r.build("paper") for r in (weak, replace(recipe, robot=own), recipe)]
    starts = [directions(model, np.deg2rad([0.0, 50.0, 100.0])).starting_m_s2 for model in models]
    np.testing.assert_allclose(starts[0], starts[1], rtol=1e-4)
    assert np.all(starts[0] < starts[2])


def test_a_simulator_gets_a_torque_whose_speed_is_not_known() -> None:
    """The joint's limit was left out where no top speed was known."""
    robot = smooth_kiwi().with_effects(MotorTorque(shortfall=1.5))
    text = sm.export_simulator(robot, "urdf", "paper").text
    limits = ET.fromstring(text).findall("joint/limit")
    assert len(limits) == 3
    torque = robot.build("paper").drives.stall_torque_N_m
    assert all(float(one.get("effort", "0")) == pytest.approx(torque, rel=1e-4) for one in limits)
