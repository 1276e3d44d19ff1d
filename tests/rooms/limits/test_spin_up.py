"""Torque that wheels and rotors take: against derivatives, a heavier robot and the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strategies import models, reals

import slipmargin as sm
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.motion import acceleration_limit
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_state import Motion
from slipmargin.limits.spin_up import spin_at_constant, spin_by_acceleration
from slipmargin.model import Model
from slipmargin.physics.frames import to_floor

INERTIA = 0.004


def with_rotors(model: Model, inertia: float | None = INERTIA, stall_N_m: float = 0.4) -> Model:
    drives = replace(model.drives, stall_torque_N_m=stall_N_m, wheel_inertia_kg_m2=inertia)
    return replace(model, drives=drives)


@given(models(), st.tuples(*[reals(-2, 2)] * 3), st.tuples(*[reals(-3, 3)] * 3))
def test_wheels_gain_the_speed_that_their_motion_says(
    model: Model, twist: tuple[float, ...], gain: tuple[float, ...]
) -> None:
    """The wheels' speeds a moment before and after, and the path of the centre of mass in the floor frame."""
    model = with_rotors(model)
    u0, du, h = np.array(twist), np.array(gain), 1e-4
    com = np.asarray(model.inertia.com_m)

    def centre(t: float) -> np.ndarray:  # velocity in the axes that the body has at t = 0
        u = u0 + t * du
        v = u[:2] + u[2] * np.array([-com[1], com[0]])
        phi = u0[2] * t + 0.5 * du[2] * t * t
        return np.append(to_floor(phi, *v), u[2])

    acceleration = (centre(h) - centre(-h)) / (2.0 * h)
    speeds = (model.geometry.wheel_speeds(u0 + h * du) - model.geometry.wheel_speeds(u0 - h * du)) / (2.0 * h)
    torque = spin_by_acceleration(model) @ acceleration + spin_at_constant(model, u0)
    np.testing.assert_allclose(torque, INERTIA * speeds, rtol=1e-5, atol=1e-6)


def test_rotors_are_like_mass_straight_ahead() -> None:
    """Four mecanum wheels: 4 T/ρ = (m + 4 J/ρ²) a, for rollers that do not turn brake nothing."""
    model = with_rotors(sm.read_robot("mecanum4", load_model="equal").build("carpet"))
    ahead = Motion.full_drag(np.array([[0.0, 1.0, 0.0]]))
    radius, mass = float(model.geometry.radius_m[0]), model.inertia.mass_kg
    found = acceleration_limit(model, ahead, np.array([[0.0, 1.0, 0.0]])).value[0]
    assert found == pytest.approx(4.0 * 0.4 / radius / (mass + 4.0 * INERTIA / radius**2), rel=2e-3)
    without = acceleration_limit(with_rotors(model, None), ahead, np.array([[0.0, 1.0, 0.0]])).value[0]
    assert without == pytest.approx(4.0 * 0.4 / radius / mass, rel=2e-3)


def test_a_circle_driven_nose_first_turns_no_wheel_faster() -> None:
    model = read_recipe("mecanum4").build("carpet")
    speed, radius = 0.6, 0.8
    round_ = Motion(
        velocity=np.array([[0.0, speed, speed / radius]]),
        acceleration=np.array([[-(speed**2) / radius, 0.0, 0.0]]),
    )
    heavy, light = (realised(with_rotors(model, j), round_).torque_N_m for j in (INERTIA, None))
    np.testing.assert_allclose(heavy, light, atol=1e-12)


@pytest.mark.parametrize("inertia", [None, 0.012])
def test_a_plan_is_followed_by_motors_that_turn_heavy_rotors(inertia: float | None) -> None:
    """A plan that left them out asked for more than the motors had, and ended 0.58 m away."""
    recipe = read_recipe("mecanum4")
    assert recipe.robot.motor is not None
    motor = replace(recipe.robot.motor, stall_torque_N_m=0.8, reflected_inertia_kg_m2=inertia)
    weak = replace(recipe, robot=replace(recipe.robot, motor=motor))
    places = [[0.0, 0.0, 0.0], [1.5, 0.5, 1.2], [3.0, 0.0, 0.0]]
    found = sm.plan(weak, "carpet", places, points=150, verify=True)
    assert found.simulated["on rollers"].drift_m < 0.005
    checked = sm.check(weak, "carpet", found.trajectory, margin=0.1)
    assert float(np.max(checked.check.torque)) == pytest.approx(0.9, abs=0.01)
