"""Where the motors hold less than the grip bears, limits of held wheels say so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from strategies import kiwi

import slipmargin as sm
from slipmargin.effects import Recipe
from slipmargin.effects.motor_torque import MotorTorque
from slipmargin.limits import Pull
from slipmargin.limits.sweep import limit
from slipmargin.robot import Motor
from slipmargin.sim.pull import pull_test


def with_motor(stall_N_m: float) -> Recipe:
    robot = kiwi(rigid_fraction=0.0)
    return Recipe(robot=replace(robot, motor=Motor(max_speed_rad_s=40.0, stall_torque_N_m=stall_N_m)))


def grip_torque_N_m() -> float:
    """What the grip of the wheel with most of it bears."""
    model = with_motor(1.0).build("paper")
    return float(np.max(model.grip.roller[:, 0] * model.loads.rest_N * model.geometry.radius_m))


def said(result: sm.Result) -> list[str]:
    return [w for w in result.warnings if w.startswith("motors: ")]


@pytest.mark.parametrize("share", [0.5, 0.99, 1.01])
def test_a_weak_motor_is_said(share: float) -> None:
    """The recommended pull was one at which motors are turned back, without a word."""
    recipe = with_motor(share * grip_torque_N_m())
    for result in (sm.sweep(recipe, "paper", step_deg=30.0), sm.polytope(recipe, "paper")):
        assert len(said(result)) == (share < 1.0)
        assert all("pushes with" in s and "see bounds" in s for s in said(result))


def test_it_is_so() -> None:
    """A pull turns wheels against motors of half of what grip bears, well before the limit of held wheels."""
    for share, motor in ((0.5, True), (1.01, False)):
        weak = with_motor(share * grip_torque_N_m()).build("paper")
        held, most = pull_test(weak, np.zeros(1)), limit(weak, np.zeros(1), Pull())
        assert (held.limit == ("motor",)) == motor
        assert (held.force_N[0] < 0.9 * most[0]) == motor


def test_a_motor_that_is_strong_enough_and_one_that_is_not_known_are_not() -> None:
    plain = Recipe(robot=kiwi())
    for recipe in (with_motor(1.0), plain):
        assert not said(sm.sweep(recipe, "paper", step_deg=30.0))
    assert said(sm.sweep(plain.with_effects(MotorTorque(shortfall=2.0)), "paper", step_deg=30.0))
