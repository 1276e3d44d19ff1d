"""A wheel that lifts carries nothing, the others take over its share, and the robot goes on."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from instants import agrees, compiled, instant, same_acceleration, somewhere
from manoeuvres import wheel_motion
from oracles.plain_simulator import acceleration, pressing, reference_motion
from scipy.optimize import nnls
from strategies import kiwi, tall

from slipmargin.api.simulate import SimulationResult
from slipmargin.errors import MotionStopped
from slipmargin.model import nominal_model
from slipmargin.model.parts import Drives
from slipmargin.robot import LoadRule
from slipmargin.sim.batch import Batch, Ending, Push
from slipmargin.sim.columns import AIR, ALPHA, BODY, CONTACT, LOAD, OMEGA, PULLED, RIGID, THETA, UP
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import held, linear
from slipmargin.sim.simulate import simulate

STILL = held(np.array([1.0, 1.6]), np.zeros((2, 4)))
TIMES = np.linspace(1.0, 1.6, 601)


def gust(model, x: float = 0.36, y: float = 0.48):
    """Towards a corner, 300 mm up, for a moment: the corner behind lifts, and comes down again."""
    wrench = model.inertia.weight_N * np.outer([0.0, 1.0, 0.0, 0.0], [x, y, 0.01])
    return Push(t_s=np.array([1.0, 1.2, 1.3, 1.6]), wrench=wrench, height_m=0.3)


def test_a_run_in_which_a_wheel_lifts_for_a_moment_goes_on_and_says_so():
    model = tall()
    run = simulate(model, STILL, TIMES, push=gust(model))
    up = np.flatnonzero(run.in_air_s > 0.0)
    assert len(up) == 1 and run.lifts_s is not None, run.in_air_s
    gone = run.load[:, up[0]] == 0.0
    assert np.all(run.force[gone, up[0]] == 0.0) and np.min(run.load) >= 0.0
    assert run.in_air_s[up[0]] == pytest.approx(np.count_nonzero(gone) * 1e-3, abs=3e-3)
    assert run.lifts_s == pytest.approx(run.t_s[np.argmax(gone)], abs=3e-3) and run.lifts_s > 1.0
    assert run.pose[-1, 0] != run.pose[int(np.argmax(gone)), 0], "it stopped on the way"


@pytest.mark.parametrize("rule", [LoadRule.STATIC, LoadRule.QUASI_STATIC])
def test_forces_and_moments_balance_while_a_wheel_is_in_the_air(rule):
    model = tall(rule=rule)
    run = simulate(model, STILL, TIMES, push=gust(model))
    assert np.any(run.in_air_s > 0.0)
    arm = model.geometry.position_m - model.inertia.com_m
    np.testing.assert_allclose(run.load.sum(axis=1), model.inertia.weight_N, rtol=1e-9)
    c, s = np.cos(run.pose[:, 2]), np.sin(run.pose[:, 2])
    pushed = gust(model)
    force = np.stack([np.interp(run.t_s, pushed.t_s, pushed.wrench[:, k]) for k in range(2)], axis=1)
    tilting = 0.3 * np.stack([c * force[:, 0] + s * force[:, 1], c * force[:, 1] - s * force[:, 0]], axis=1)
    friction = np.einsum(
        "tnk,nkj->tj", run.force, np.stack([model.geometry.grip, model.geometry.free], axis=1)
    )
    follows = float(rule is LoadRule.QUASI_STATIC) * model.inertia.com_height_m
    np.testing.assert_allclose(
        run.load @ arm, tilting - follows * (friction + tilting / 0.3), atol=1e-9 * model.inertia.weight_N
    )
    # what sliding takes, the gust gave, less what the robot still has
    speed, spin = np.hypot(run.velocity[:, 0], run.velocity[:, 1]), run.velocity[:, 2]
    energy = 0.5 * model.inertia.mass_kg * speed**2 + 0.5 * model.inertia.inertia_kg_m2 * spin**2
    moment = np.interp(run.t_s, pushed.t_s, pushed.wrench[:, 2])
    power = np.sum(force * run.velocity[:, :2], axis=1) + moment * spin
    arm_power = run.friction_power_W + power
    work = np.sum(0.5 * (arm_power[1:] + arm_power[:-1]) * np.diff(run.t_s))
    assert energy[-1] - energy[0] == pytest.approx(work, abs=2e-3 * np.max(np.abs(power)) * 0.6)


@pytest.mark.parametrize("wheels", [4, 6])
def test_loads_are_the_nearest_that_press(wheels):
    """Against SciPy's least squares of non-negative numbers, and against trying every set of wheels."""
    model, seen = tall(0.3 if wheels == 4 else 0.2, wheels=wheels), 0
    tips = 0
    plane = np.column_stack([np.ones(wheels), model.geometry.position_m - model.inertia.com_m])
    for seed in range(200):
        y, motion, rigid, push = somewhere(wheels, seed, 0.4)
        acc, _, load = compiled(model, 0.0, y, motion, rigid, 3.0 * push)
        free = model.loads.at(acc)
        if np.min(free) >= -1e-9 * model.inertia.weight_N:
            np.testing.assert_allclose(load, free, atol=1e-9)
            continue
        if nnls(plane.T, plane.T @ free)[1] > 1e-6:  # no loads that press have this sum and these moments
            tips += 1
            assert np.min(load) >= 0.0 and np.sum(load) == pytest.approx(model.inertia.weight_N, rel=1e-6)
            continue
        seen += 1
        weight = 1e5
        found, _ = nnls(
            np.vstack([np.eye(wheels), weight * plane.T]), np.append(free, weight * plane.T @ free)
        )
        np.testing.assert_allclose(load, found, atol=1e-6 * model.inertia.weight_N)
        np.testing.assert_allclose(load, pressing(plane, free), atol=1e-9 * model.inertia.weight_N)
        want = acceleration(model, 0.0, y, motion, rigid, 3.0 * push, guess=acc[:2])[0]
        np.testing.assert_allclose(acc, want, rtol=1e-9, atol=1e-10)
    assert seen > 10 and tips > 2


@pytest.mark.parametrize("rule", [LoadRule.STATIC, LoadRule.QUASI_STATIC])
def test_the_motion_is_that_of_the_plain_road(rule):
    model = tall(rule=rule)
    times = np.linspace(1.0, 1.6, 7)
    found = Batch([STILL], [times], pushes=[gust(model)]).run(pack(model), np.zeros(3), rtol=1e-9)
    assert np.any(found.in_air_s > 0.01)

    pushed = gust(model)

    def push(t):
        return np.array([np.interp(t, pushed.t_s, pushed.wrench[:, k]) for k in range(3)])

    want = reference_motion(
        model,
        wheel_motion(STILL),
        pushed.t_s,
        times,
        push=push,
        push_height_m=0.3,
        rtol=1e-9,
        atol=1e-11,
    )
    assert np.abs(found.pose[0] - want).max() <= 1e-6 * np.abs(want).max()


def test_three_wheels_that_tip_agree_with_the_plain_road():
    """Friction holds the foot of a tall robot: one of three wheels would have to be pulled down."""
    model, tips = tall(0.2, wheels=3), 0
    plane = np.column_stack([np.ones(3), model.geometry.position_m - model.inertia.com_m])
    for seed in range(200):
        y, motion, rigid, push = somewhere(3, seed, 0.4)
        acc, _, load = compiled(model, 0.0, y, motion, rigid, push)
        free = model.loads.at(acc)
        want = acceleration(model, 0.0, y, motion, rigid, push, guess=acc[:2])[0]
        same_acceleration(model, acc, want)
        np.testing.assert_allclose(load, pressing(plane, free), atol=1e-9 * model.inertia.weight_N)
        tips += np.min(free) < 0.0
    assert 10 < tips < 190


@pytest.mark.parametrize("height_m", [0.3, 0.4, 0.6])
def test_a_robot_far_too_tall_agrees_with_the_plain_road(height_m):
    """It may tip in two ways, and jam: what is found is an acceleration that agrees with its own loads."""
    for seed in range(300):
        agrees(tall(height_m, wheels=6), seed, 0.4)


def everything(flat, y, omega, motion, rigid, push, J):
    """Accelerations of body and driven wheels in one row, and the kernel's tables."""
    n = len(omega)
    C, B, acc, rate = np.zeros((n, CONTACT)), np.zeros(BODY), np.zeros(3), np.zeros(n)
    C[:, THETA], C[:, OMEGA], C[:, ALPHA], C[:, RIGID] = motion[0], omega, motion[2], rigid
    B[:3] = push
    instant(flat, 0.0, y, C, B, acc, J, n, rate)
    turning = y[5] * np.array([y[4], -y[3], 0.0])
    return np.concatenate([acc + turning, rate]), C, B


@pytest.mark.parametrize(
    ("wheels", "height_m", "tipping"), [(4, 0.35, False), (4, 0.35, True), (3, 0.2, True)]
)
def test_slopes_are_those_of_the_loads_in_force(wheels, height_m, tipping):
    """Derivatives of body and driven wheels by central differences, a wheel being in the air."""
    model = replace(tall(height_m, wheels=wheels), drives=Drives(stall_torque_N_m=0.5, max_speed_rad_s=40.0))
    flat, seen = np.array(pack(model)), 0
    for seed in range(60):
        y, motion, rigid, push = somewhere(wheels, seed, 0.4)
        J, rest = np.zeros((3 + wheels, 7 + 2 * wheels)), (motion, rigid, 3.0 * push)
        _, C, B = everything(flat, y, motion[1], *rest, J)
        other = (B[PULLED] > 0.0) != tipping or 0.0 < B[PULLED] < 0.1
        if B[UP] == 0.0 or other or np.min(C[C[:, AIR] == 0.0, LOAD]) < 0.1:
            continue
        seen += 1
        for k in range(3 + wheels):
            ends = []
            for d in (np.eye(3 + wheels)[k] * 1e-7, np.eye(3 + wheels)[k] * -1e-7):
                moved = y + np.append(np.zeros(3), d[:3])
                ends.append(everything(flat, moved, motion[1] + d[3:], *rest, np.zeros_like(J))[0])
            atol = 2e-4 * np.abs(J).max()
            np.testing.assert_allclose(J[:, 3 + k], (ends[0] - ends[1]) / 2e-7, rtol=2e-4, atol=atol)
    assert seen > 5


def test_it_tips_where_no_three_wheels_carry_it_and_three_wheels_have_none_to_spare():
    four = tall()
    with pytest.raises(MotionStopped, match="no three others carry"):
        simulate(four, STILL, TIMES, push=gust(four, 0.0, 1.0))
    three = nominal_model(kiwi(load_rule=LoadRule.STATIC), "paper")
    with pytest.raises(MotionStopped, match="no three others carry"):
        simulate(three, held(np.array([1.0, 1.6]), np.zeros((2, 3))), TIMES, push=gust(three))


def test_the_answer_says_which_wheel_hangs_in_the_air():
    model = tall()
    run = simulate(model, STILL, TIMES, push=gust(model))
    result = SimulationResult(model=model, run=run, fine=run, planned_end=None, warnings=())
    wheel = model.geometry.names[int(np.argmax(run.in_air_s))]
    assert any(f"wheels hang in the air: wheel {wheel} for " in line for line in result.lines())
    told = json.loads(result.to_json())
    assert told["lifts_s"] == pytest.approx(run.lifts_s) and max(told["in_air_s"]) > 0.0
    calm = simulate(model, STILL, TIMES)
    quiet = SimulationResult(model=model, run=calm, fine=calm, planned_end=None, warnings=())
    assert calm.lifts_s is None and not any("air" in line for line in quiet.lines())
    assert json.loads(quiet.to_json())["not_given"]["lifts_s"] == "no wheel lifted off the floor"


def test_a_signal_that_lifts_nothing_is_what_it_was():
    """No wheel in the air: the loads are the affine ones to the last digit."""
    model = tall(0.02)
    signal = linear(np.array([0.0, 0.5]), np.outer([0.0, 3.0], [1.0, 1.0, -1.0, -1.0]))
    found = simulate(model, signal, np.linspace(0.0, 0.5, 6))
    assert found.lifts_s is None and np.all(found.in_air_s == 0.0) and np.min(found.load) > 0.0


def test_a_prediction_of_what_was_measured_goes_on_where_its_robot_jams() -> None:
    """It chattered there, from one wheel to the other, and most such runs took more steps than allowed."""
    model, count, times = tall(1.0, surface="carpet"), 20, np.linspace(0.0, 0.5, 26)
    rng = np.random.default_rng(1)
    signals = [linear(times, np.cumsum(rng.normal(0.0, 1.0, (26, 4)), axis=0)) for _ in range(count)]
    batch = Batch(signals, [times] * count)
    free = batch.run(pack(model), np.zeros((count, 3)))
    assert np.any(free.ending != Ending.DONE)
    held = batch.run(pack(model), np.zeros((count, 3)), held_down=np.inf, max_steps=4000)
    assert np.all(held.ending == Ending.DONE)


def test_a_robot_that_jams_is_told() -> None:
    """No acceleration agrees with its own loads: a run ends there, and no other has loads out of balance.

    Of 400 states of a robot far taller than wide some jam; their loads summed up to several weights.
    """
    model, count, times = tall(1.0, wheels=6, surface="carpet"), 400, np.array([0.0, 1e-3])
    rng = np.random.default_rng(4)
    signals = [linear(times, np.tile(row, (2, 1))) for row in rng.uniform(-7.0, 7.0, (count, 6))]
    twist = rng.uniform(-1.0, 1.0, (count, 3)) * [0.4, 0.4, 2.0]
    batch, poses = Batch(signals, [times] * count), np.zeros((count, 3))
    outcome = batch.run(pack(model), poses, start_twist=twist, tell=True)
    jams = outcome.ending == Ending.JAMS
    assert 3 < jams.sum() < 0.1 * count
    assert np.all(outcome.stopped_s[jams] < times[-1]) and np.isfinite(outcome.lifts_s[jams]).all()
    assert outcome.load is not None
    on = outcome.load[outcome.ending == Ending.DONE]
    np.testing.assert_allclose(on.sum(axis=2), model.inertia.weight_N, rtol=1e-9)
    assert np.min(on) >= 0.0
    first = int(np.flatnonzero(jams)[0])
    with pytest.raises(MotionStopped, match="friction presses another down so hard"):
        simulate(model, signals[first], times, start_twist=twist[first])
    followed = batch.run(pack(model), poses, start_twist=twist, held_down=np.inf, tell=True)
    assert np.all(followed.ending == Ending.DONE)
    assert followed.load is not None
    resting = np.broadcast_to(model.loads.rest_N, (jams.sum(), 6))
    np.testing.assert_allclose(followed.load[jams, 0], resting, rtol=1e-9)
