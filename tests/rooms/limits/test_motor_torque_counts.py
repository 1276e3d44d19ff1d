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
from slipmargin.paths.path import through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import trajectory
from slipmargin.paths.verify import verify
from slipmargin.robot import Motor


@pytest.mark.parametrize("stated", [None, 0.4], ids=["no torque in the file", "a torque in the file"])
def test_it_counts_in_limits_as_a_motor_of_that_torque_does(stated: float | None) -> None:
    recipe = smooth_kiwi()
    motor = None if stated is None else Motor(max_speed_rad_s=1e6, stall_torque_N_m=stated)
    weak = replace(recipe, robot=replace(recipe.robot, motor=motor)).with_effects(MotorTorque(shortfall=1.5))
    torque = weak.build("paper").drives.weakest_N_m
    nominal = recipe.build("paper")
    grip = np.mean(nominal.grip.roller[:, 0] * nominal.loads.rest_N * nominal.geometry.radius_m)
    assert 1.0 / torque == pytest.approx((0.0 if stated is None else 1.0 / stated) + 1.5 / grip, rel=1e-12)
    own = replace(recipe.robot, motor=Motor(max_speed_rad_s=1e6, stall_torque_N_m=torque))
    models = [r.build("paper") for r in (weak, replace(recipe, robot=own), recipe)]
    starts = [directions(model, np.deg2rad([0.0, 50.0, 100.0])).starting_m_s2 for model in models]
    np.testing.assert_allclose(starts[0], starts[1], rtol=1e-4)
    assert np.all(starts[0] < starts[2])


def test_one_weak_motor_counts_where_its_wheel_works() -> None:
    """Along its wheel all motors might be as weak, across it none; and what is planned so is driven so."""
    recipe = smooth_kiwi()
    one, every = (recipe.with_effects(MotorTorque(shortfall=2.0, wheels=on)) for on in (("2",), ()))
    models = [r.build("paper") for r in (recipe, one, every)]
    along = np.arctan2(*models[0].geometry.drive[1][::-1])
    free, weak, all_weak = (directions(m, along + np.array([0.0, np.pi / 2])).starting_m_s2 for m in models)
    assert weak[0] == pytest.approx(all_weak[0], rel=1e-6) and weak[0] < 0.8 * free[0]
    assert weak[1] == pytest.approx(free[1], rel=1e-6)

    there = np.array([[0.0, 0.0, 0.0], [*np.array([np.cos(along), np.sin(along)]), 0.0]])
    plans = [plan(m, through(there), Request(share=0.9, points=60)) for m in models[:2]]
    assert np.max(plans[1].audit.torque) == pytest.approx(0.9, abs=0.01)
    assert np.all(plans[1].audit.torque[..., [0, 2]] == 0.0)
    bold, sound = (verify(models[1], trajectory(p)) for p in plans)
    assert bold.drift_m > 10.0 * sound.drift_m


def test_a_limiter_takes_every_motor_as_the_weakest_and_says_so() -> None:
    """One weak motor halved what the limiter allowed across its wheel too, without a word."""
    recipe = smooth_kiwi()
    one, every = (recipe.with_effects(MotorTorque(shortfall=2.0, wheels=on)) for on in (("2",), ()))
    limiters = [sm.Limiter(robot, "paper") for robot in (one, every)]
    ways = 0.5 * np.column_stack([np.cos(np.arange(8.0)), np.sin(np.arange(8.0)), np.zeros(8)])
    weak, all_weak = (x.limit_twist(np.zeros((8, 3)), ways, 0.02)[0] for x in limiters)
    np.testing.assert_allclose(weak, all_weak, rtol=1e-9)
    said = [[w for w in x.warnings if "as the weakest" in w] for x in limiters]
    assert len(said[0]) == 1 and f"{one.build('paper').drives.weakest_N_m:.3g} N m" in said[0][0]
    assert not said[1]


def test_a_simulator_gets_a_torque_whose_speed_is_not_known() -> None:
    """The joint's limit was left out where no top speed was known."""
    robot = smooth_kiwi().with_effects(MotorTorque(shortfall=1.5))
    text = sm.export_simulator(robot, "urdf", "paper").text
    limits = ET.fromstring(text).findall("joint/limit")
    assert len(limits) == 3
    torque = robot.build("paper").drives.weakest_N_m
    assert all(float(one.get("effort", "0")) == pytest.approx(torque, rel=1e-4) for one in limits)
