"""The height of the floor under each wheel: the compiled road against the readable one, and by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from instants import agrees, compiled, same_acceleration, somewhere
from manoeuvres import wheel_motion
from oracles.plain_simulator import acceleration, reference_motion
from strategies import four_wheels, kiwi, models, tall

from slipmargin.effects.floor_bump import FloorBump
from slipmargin.effects.floor_ramp import FloorRamp
from slipmargin.effects.floor_seam import FloorSeam
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.recipe import with_effects
from slipmargin.model import Model, nominal_model
from slipmargin.physics.relief import Profile, Relief, beyond, rise
from slipmargin.robot import GripShape, LoadRule
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate


def uneven(model: Model, *reliefs: Relief) -> Model:
    return replace(model, external=replace(model.external, reliefs=reliefs))


def drawn(seed: int) -> tuple[Relief, Relief, Relief]:
    """A ramp, a ridge and a bump near the floor's origin."""
    rng = np.random.default_rng(seed)
    direction, edge = rng.uniform(-3.0, 3.0), rng.uniform(0.005, 0.05)
    offset, size = rng.uniform(-0.3, 0.1), rng.uniform(-0.1, 0.1)
    long, middle = rng.uniform(0.1, 0.6), (offset, rng.uniform(-0.2, 0.2))
    return (
        Relief(profile=Profile.RAMP, size=size, extent_m=long, place=(offset, direction), edge_m=edge),
        Relief(profile=Profile.RIDGE, size=0.1 * size, extent_m=0.2, place=(-offset, direction), edge_m=edge),
        Relief(profile=Profile.BUMP, size=0.1 * size, extent_m=long, place=middle, edge_m=edge),
    )


@given(models(shapes=tuple(GripShape)), st.integers(0, 2**31))
@settings(max_examples=60, deadline=None)
def test_accelerations_agree(model: Model, seed: int) -> None:
    """Any robot, load rule and grip set."""
    agrees(uneven(model, *drawn(seed)), seed)


@pytest.mark.parametrize(("wheels", "height_m"), [(3, 0.2), (4, 0.35), (5, 0.3)])
def test_a_floor_that_rises_does_not_push_a_wheel_in_the_air(wheels: int, height_m: float) -> None:
    """Slopes push with the load that the wheel has in the end; three wheels tip, of more some only lift."""
    model, up = tall(height_m, wheels=wheels), 0
    for seed in range(100):
        hilly, (y, *rest) = uneven(model, *drawn(seed)), somewhere(wheels, seed, 0.4)
        acc, _, load = compiled(hilly, 0.0, y, *rest)
        want, _, _, want_load = acceleration(hilly, 0.0, y, *rest)
        same_acceleration(hilly, acc, want)
        np.testing.assert_allclose(load, want_load, atol=1e-9 * model.inertia.weight_N)
        up += np.min(load) < 1e-6
    assert 5 < up < 95


@pytest.mark.parametrize("robot", [kiwi(com_height_m=0.03, load_rule=LoadRule.QUASI_STATIC), four_wheels()])
def test_a_run_over_a_ramp_a_ridge_and_a_bump_agrees(robot) -> None:
    model = uneven(
        nominal_model(robot, robot.surfaces[0].name),
        Relief(profile=Profile.RAMP, size=0.08, extent_m=0.1, place=(0.02, 0.4), edge_m=0.004),
        Relief(profile=Profile.RIDGE, size=0.004, extent_m=0.03, place=(-0.03, 2.0), edge_m=1.0),
        Relief(profile=Profile.BUMP, size=0.01, extent_m=0.1, place=(0.03, 0.02), edge_m=1.0),
    )
    n = model.count
    rates = np.outer([0.0, 1.0, 1.0], 8.0 * np.cos(1.0 + 2.1 * np.arange(n)))
    signal = linear(np.array([0.0, 0.1, 0.6]), rates)
    times = np.linspace(0.0, 0.6, 5)
    pose = simulate(model, signal, times).pose
    want = reference_motion(model, wheel_motion(signal), signal.knots_s, times)
    assert np.abs(pose - want).max() <= 1e-5 * np.abs(want).max()
    assert np.abs(pose - simulate(uneven(model), signal, times).pose).max() > 1e-4


def test_a_flat_relief_changes_nothing() -> None:
    model = nominal_model(kiwi(), "paper")
    flat = uneven(
        model,
        Relief(profile=Profile.RAMP, size=0.0, extent_m=1.0, place=(0.0, 0.0), edge_m=0.01),
    )
    signal = linear(np.array([0.0, 0.1, 0.6]), np.outer([0.0, 1.0, 1.0], [8.0, -5.0, 3.0]))
    times = np.linspace(0.0, 0.6, 5)
    np.testing.assert_allclose(
        simulate(flat, signal, times).pose, simulate(model, signal, times).pose, atol=1e-7
    )


def test_a_ramp_under_all_of_the_robot_is_a_tilted_floor() -> None:
    """Downhill is against the direction in which a ramp rises."""
    model = nominal_model(kiwi(com_height_m=0.0, load_rule=LoadRule.STATIC), "paper")
    ramp = FloorRamp(slope_rad=0.02, offset_m=-50.0, direction_rad=0.7, length_m=100.0)
    tilt = FloorTilt(tilt_x_rad=-0.02 * np.cos(0.7), tilt_y_rad=-0.02 * np.sin(0.7))
    signal = linear(np.array([0.0, 0.2, 1.0]), np.outer([0.0, 1.0, 1.0], [6.0, -4.0, 2.0]))
    times = np.linspace(0.0, 1.0, 6)
    level, *found = (
        simulate(m, signal, times).pose for m in (model, *(with_effects(model, (e,)) for e in (ramp, tilt)))
    )
    moved = np.abs(found[1] - level).max()
    assert moved > 1e-4
    np.testing.assert_allclose(found[0], found[1], atol=2e-3 * moved)


def test_one_wheel_on_a_ramp_turns_the_robot() -> None:
    """By hand: the load of one wheel times the slope at its arm, over the yaw inertia."""
    model = nominal_model(kiwi(), "paper")
    place = model.geometry.position_m[2]  # the rear wheel, at (0, −r)
    ramp = FloorRamp(
        slope_rad=0.05, offset_m=float(place[0]) - 1.0, direction_rad=0.0, length_m=9.0, edge_m=5e-4
    )
    ramp = replace(ramp, direction_rad=0.5 * np.pi, offset_m=float(place[1]) - 0.01, length_m=0.02)
    y, zero = np.zeros(6), np.zeros(3)
    acc, _, load = compiled(with_effects(model, (ramp,)), 0.0, y, (zero, zero, zero), zero > 1.0, zero)
    force = load[2] * np.tan(0.05)
    np.testing.assert_allclose(acc[:2], [0.0, -force / model.inertia.mass_kg], rtol=1e-6, atol=1e-9)
    across = replace(ramp, direction_rad=0.0, offset_m=-0.05, length_m=0.1)
    acc, _, _ = compiled(with_effects(model, (across,)), 0.0, y, (zero, zero, zero), zero > 1.0, zero)
    want = float(place[1]) * force / model.inertia.inertia_kg_m2
    assert acc[2] == pytest.approx(want, rel=1e-6) and abs(want) > 0.01


def test_a_ridge_takes_as_much_as_it_gives() -> None:
    """The height is a potential: over a ridge and past it the work is zero, on its top m g h."""
    d = np.linspace(-0.3, 0.3, 6001)
    slope = rise(int(Profile.RIDGE), 0.004, 0.05, 1.0, d)
    height = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(d))])
    assert height[-1] == pytest.approx(0.0, abs=1e-12) and height.max() == pytest.approx(0.004, rel=1e-4)
    assert np.interp(0.025, d, height) == pytest.approx(0.002, rel=1e-3)
    seam = FloorSeam(height_m=0.004, width_m=0.05)
    (steepest,) = seam.derived(nominal_model(kiwi(), "paper"))
    assert steepest.value == pytest.approx(np.abs(slope).max(), rel=1e-4)
    assert beyond(0.2, 0.0, 0.5, 9.0) == pytest.approx(0.3)


def test_a_bump_pushes_away_from_its_middle_and_is_half_as_high_at_its_radius() -> None:
    """The height follows from the slope along any way up."""
    bump = FloorBump(height_m=0.006, centre_x_m=0.3, centre_y_m=-0.2, radius_m=0.15)
    model = nominal_model(kiwi(), "paper")
    (relief,) = with_effects(model, (bump,)).external.reliefs
    far = np.linspace(1.5, 0.0, 20001)
    for way in (0.3, 2.0, -2.5):
        x, y = 0.3 + far * np.cos(way), -0.2 + far * np.sin(way)
        slope = relief.gradient(x, y) @ np.array([np.cos(way), np.sin(way)])
        height = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(far))])
        assert height[-1] == pytest.approx(0.006, rel=1e-5)
        assert np.interp(-0.15, -far, height) == pytest.approx(0.003, rel=1e-4)
        (steepest,) = bump.derived(model)
        assert steepest.value == pytest.approx(np.abs(slope).max(), rel=1e-5)
    assert np.all(relief.gradient(np.array([0.3]), np.array([-0.2])) == 0.0)


def test_motors_climb_a_ramp_that_they_are_driven_up() -> None:
    """Wheels driven by their motors: the droop grows by the torque that the climb asks for."""
    model = nominal_model(kiwi(), "paper")
    n = model.count
    droop = replace(model, actuators=replace(model.actuators, droop_rad_s_per_N_m=np.full(n, 3.0)))
    rates = model.geometry.wheel_speeds(np.array([0.1, 0.0, 0.0]))
    signal = linear(np.array([0.0, 0.5, 2.0]), np.outer([0.0, 1.0, 1.0], rates))
    ramp = FloorRamp(slope_rad=0.03, offset_m=-9.0, direction_rad=0.0, length_m=99.0)
    times = np.linspace(0.0, 2.0, 5)
    level, up = (
        Batch([signal], [times], commanded=True).run(pack(m), np.zeros(3)).pose[0, -1, 0]
        for m in (droop, with_effects(droop, (ramp,)))
    )
    assert up < level - 1e-4
