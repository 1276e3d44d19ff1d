"""What every motion must obey: order of the method, exact switches, energy, symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from manoeuvres import driven, no_slip_rates
from numba import njit
from strategies import PAPER, four_wheels, kiwi

from slipmargin.errors import MotionStopped
from slipmargin.model import nominal_model
from slipmargin.paper.published import command, paper_model
from slipmargin.physics.sectors import on_rigid
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable
from slipmargin.robot import Body, GripShape, LoadRule, Robot, Wheel
from slipmargin.sim import layout as at
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import held, hermite, linear
from slipmargin.sim.simulate import simulate
from slipmargin.sim.stops import first_switch

STILL = [HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large]


def reversing():
    """A wheel motion in which wheels reverse and stop inside rigid sectors."""
    t = np.array([0.0, 0.1, 0.2, 0.3])
    theta = np.array([[0.70, 0.1, 0.69], [0.745, 0.3, 0.76], [0.72, 0.2, 0.76], [0.73, 0.15, 0.60]])
    omega = np.array([[2.0, 2.0, 0.0], [0.0, 0.0, 0.0], [-0.4, -1.0, 0.0], [0.0, 0.0, -3.0]])
    return hermite(t, theta, omega)


@pytest.mark.parametrize("case", ["paper", "reversing"])
def test_error_falls_with_the_fourth_power_of_the_steps(case):
    """RODAS is of order 4: sectors, reversals and stops inside a sector cost no order.

    A switch missed by the step size would leave an error that falls with the first power.
    """
    model = paper_model("paper", improved=True)
    signal = command(np.array([0.131, 0.255, 0.260])) if case == "paper" else reversing()
    times = np.array([0.0, signal.knots_s[-1]])
    batch, packed = Batch([signal], [times]), pack(model)
    exact = batch.run(packed, np.zeros(3), rtol=1e-13).pose[0, -1]
    errors, steps = [], []
    for rtol in (1e-8, 1e-9, 1e-10, 1e-11):  # nearer the start stiffness still hides the order
        outcome = batch.run(packed, np.zeros(3), rtol=rtol)
        errors.append(np.abs(outcome.pose[0, -1] - exact).max())
        steps.append(outcome.steps[0, 0])
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order > 3.5


def test_the_floors_origin_does_not_matter():
    """Seen a kilometre off: steps were as long as if the robot had come all the way from there."""
    model = paper_model("paper", improved=True)
    times = np.linspace(0.0, 3.0, 4)
    batch, packed = Batch([command(np.array([0.131, 0.255, 0.260]))], [times]), pack(model)
    here, there = (
        batch.run(packed, np.array([x, -x, 0.0]), rtol=1e-6).pose[0] - np.array([x, -x, 0.0])
        for x in (0.0, 1000.0)
    )
    np.testing.assert_allclose(there, here, atol=1e-9)


def switches(packed, coef, until):
    """Instants at which wheels change sector on one piece of their motion."""
    wheels = packed[at.HEAD : at.HEAD + 3 * at.WHEEL].reshape(3, at.WHEEL).copy()
    none, table = np.zeros(6), np.zeros((6, 6))
    found, t = [], 0.0
    while True:
        share = next_switch(wheels, coef, t, none, none, table, until - t)
        if share > 1.0:
            return np.array(found)
        t += share * (until - t)
        found.append(t)


@njit
def next_switch(W, coef, since, y, z, K, span):
    return first_switch(W, coef, since, y, z, K, span)


def test_switches_are_where_the_angle_says():
    """θ = 1.8 t + 0.05 and pitch 2π/8, rigid from 0.9 of it on: the times are known in closed form."""
    model = paper_model("paper", improved=True)
    signal = held(np.array([0.0, 2.0]), np.tile([1.8, 0.0, -1.8], (2, 1)), theta0=np.array([0.05, 0.1, 0.06]))
    coef = np.concatenate([signal.pieces, np.zeros((1, 3, 1))], axis=2)[0]
    pitch = np.pi / 4.0
    edges = np.concatenate([pitch * np.arange(-8, 8), pitch * (np.arange(-8, 8) + 0.9)])
    forth, back = (edges - 0.05) / 1.8, (0.06 - edges) / 1.8
    want = np.sort([t for t in (*forth, *back) if 0.0 < t < 2.0])
    np.testing.assert_allclose(switches(pack(model), coef, 2.0), want, atol=1e-9)


def test_a_wheel_that_turns_back_just_past_an_edge_switches_twice():
    """θ = edge + 1e-6 − (t − 0.37)²: past the edge for 2 ms, between two looks for it."""
    model = paper_model("paper", improved=True)
    coef = np.zeros((3, 5))
    coef[0, :3] = 0.9 * np.pi / 4.0 + 1e-6 - 0.37**2, 2.0 * 0.37, -1.0
    found = switches(pack(model), coef, 1.0)
    near = found[np.abs(found - 0.37) < 0.01]
    np.testing.assert_allclose(near, [0.369, 0.371], atol=1e-6)


def test_all_switches_of_an_exponential_on_a_parabola():
    """ω = c1 + 2 c2 τ + 3 c3 τ² + c4 e^(−τ/T) crosses zero three times; all switches are found."""
    packed, lag, h = pack(paper_model("paper", improved=True)).copy(), 0.3, 3.0
    packed[at.HEAD + at.LAG] = lag
    coef = np.zeros((3, 5))
    c = coef[0] = np.array([0.05, 4.0, -3.0, 2.0 / 3.0, -6.0])
    x = np.linspace(0.0, h, 2_000_001)
    theta = c[0] + x * (c[1] + x * (c[2] + x * c[3])) + c[4] * lag * (1.0 - np.exp(-x / lag))
    pitch = np.pi / 4.0
    number = np.floor(theta / pitch) * 2 + on_rigid(theta, pitch, 0.1)
    want = x[1:][np.diff(number) != 0.0]
    assert len(want) > 3
    np.testing.assert_allclose(switches(packed, coef, h), want, atol=3e-6)


@given(driven(shapes=tuple(GripShape)))
@settings(max_examples=25, deadline=None, suppress_health_check=STILL)
def test_friction_never_creates_energy(case):
    model, signal = case
    try:
        run = simulate(model, signal, np.linspace(0.0, 0.25, 40))
    except MotionStopped:
        assume(False)
    assert run.friction_power_W.max() <= 1e-12


@given(driven(shapes=tuple(GripShape)))
@settings(max_examples=15, deadline=None, suppress_health_check=STILL)
def test_rotated_world_same_motion(case):
    model, signal = case
    times = np.linspace(0.0, 0.25, 5)
    turn, shift = 0.7, np.array([2.0, -1.0])
    c, s = np.cos(turn), np.sin(turn)
    try:
        # A step over a corner of the friction law may be off by more than its tolerance (4e-6 of the
        # motion at 1e-7): the same motion is asked of accurate runs.
        here = simulate(model, signal, times, rtol=1e-9).pose
        there = simulate(model, signal, times, rtol=1e-9, start_pose=np.array([*shift, turn])).pose
    except MotionStopped:
        assume(False)
    rotated = here[:, :2] @ np.array([[c, s], [-s, c]]) + shift
    np.testing.assert_allclose(there[:, :2], rotated, atol=2e-6 * np.abs(here).max() + 1e-12)
    np.testing.assert_allclose(there[:, 2], here[:, 2] + turn, atol=2e-6 * np.abs(here).max() + 1e-12)


def mirrored(robot: Robot) -> Robot:
    """The robot seen in a mirror along its Y axis: x → −x; a wheel's drive direction turns with it."""
    flip = np.array([-1.0, 1.0])
    wheels = tuple(
        replace(
            w,
            position_m=flip * w.position_m,
            drive_direction_deg=180.0 - w.drive_direction_deg,
            roller_angle_deg=-w.roller_angle_deg,
        )
        for w in robot.wheels
    )
    return replace(robot, wheels=wheels, body=replace(robot.body, com_m=flip * robot.body.com_m))


@pytest.mark.parametrize("shape", list(GripShape))
@pytest.mark.parametrize(
    "robot",
    [
        kiwi(com_m=(0.005, -0.01), load_rule=LoadRule.QUASI_STATIC, com_height_m=0.015),
        four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.05),
    ],
    ids=["kiwi", "mecanum"],
)
def test_mirrored_robot_mirrored_motion(robot, shape):
    robot = replace(robot, friction=replace(robot.friction, grip=shape))
    model, other = nominal_model(robot, "paper"), nominal_model(mirrored(robot), "paper")
    twist = np.array([0.15, 0.08, 0.6])
    flip = np.array([-1.0, 1.0, -1.0])
    t = np.array([0.0, 0.3, 0.5])
    rates, mirror = no_slip_rates(model, twist), no_slip_rates(other, flip * twist)
    np.testing.assert_allclose(mirror, rates, atol=1e-12)
    signal = held(t, np.stack([rates, 0.2 * rates, rates]), theta0=np.full(model.count, 0.3))
    times = np.linspace(0.0, 0.5, 9)
    np.testing.assert_allclose(
        simulate(other, signal, times).pose, flip * simulate(model, signal, times).pose, atol=1e-8
    )


@pytest.mark.parametrize("count", [3, 4, 6])
@pytest.mark.parametrize("roller_deg", [0.0, 45.0])
def test_any_number_of_wheels_reaches_the_no_slip_twist(count, roller_deg):
    """Well inside its grip a robot moves at the twist its wheels ask for, less the creep of eq. (11)."""
    at = 2.0 * np.pi * np.arange(count) / count + 0.2
    wheels = tuple(
        Wheel(
            name=str(i),
            position_m=0.2 * np.array([np.cos(a), np.sin(a)]),
            drive_direction_deg=np.degrees(a) + 90.0,
            radius_m=0.05,
            roller_angle_deg=roller_deg,
        )
        for i, a in enumerate(at)
    )
    robot = Robot(name="ring", wheels=wheels, surfaces=(PAPER,), body=Body(mass_kg=8.0, inertia_kg_m2=0.2))
    model = nominal_model(robot, "paper")
    twist = np.array([0.1, -0.05, 0.4])
    rates = no_slip_rates(model, twist)
    signal = held(np.array([0.0, 1.5]), np.stack([rates, rates]))
    run = simulate(model, signal, np.linspace(0.0, 1.5, 31))
    c, s = np.cos(run.pose[-1, 2]), np.sin(run.pose[-1, 2])
    body = np.array([[c, s], [-s, c]]) @ run.velocity[-1, :2]
    np.testing.assert_allclose([*body, run.velocity[-1, 2]], twist, atol=0.012)
    np.testing.assert_allclose(run.load.sum(axis=1), 8.0 * 9.81, rtol=1e-12)


def test_ideal_rollers_and_very_steep_friction():
    """μ_T = 0 and k = 10⁵ work; with ideal rollers steady motion costs nothing: drive slip dies out."""
    model = paper_model("paper", improved=False)
    grip = replace(model.grip, roller=model.grip.roller * np.array([1.0, 0.0]), k_s_per_m=1e5)
    for shape in GripShape:
        ideal = replace(model, grip=replace(grip, shape=shape))
        run = simulate(ideal, command(np.zeros(3)), np.linspace(0.0, 3.4, 18))
        assert np.abs(run.slip[-1, :, 0]).max() < 1e-9
        assert np.abs(run.force[-1]).max() < 1e-6
    steep = replace(model, grip=replace(model.grip, k_s_per_m=1e5))
    run = simulate(steep, command(np.zeros(3)), np.linspace(0.0, 3.4, 18))
    assert np.abs(run.slip[-1, :, 0]).max() < 2e-5


def test_slip_ratio_law_loses_the_same_share_at_any_speed():
    """Creepage: with k ∝ 1/rolling speed the slip ratio of a loaded wheel does not depend on speed."""
    model = paper_model("paper", improved=False)
    creep = Multiplier(
        variable=Variable.ROLLING_SPEED,
        basis=Basis.RECIPROCAL,
        target=Target.STIFFNESS,
        shape=np.array([20.0 / 1000.0, 0.0]),
        coefficients=np.ones(1),
        wheels=np.ones(3),
    )
    model = replace(model, grip=replace(model.grip, multipliers=(creep,)))
    lost = []
    for factor in (1.0, 2.0):
        rates = factor * no_slip_rates(model, np.array([0.1, 0.0, 0.0]))
        signal = linear(np.array([0.0, 1.0, 3.0]), np.stack([rates, rates, rates]))
        run = simulate(model, signal, np.array([0.0, 2.9]), start_twist=np.array([0.1 * factor, 0.0, 0.0]))
        lost.append(run.slip[-1, 2, 0] / (rates[2] * 0.0254))
    assert lost[0] == pytest.approx(lost[1], rel=2e-3)
    assert abs(lost[0]) > 0.01


def test_loads_follow_the_acceleration_at_once():
    """Σ N_i (p_i − com) = −m h a at every instant (docs/theory.md, section 3), Σ N_i = m g."""
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.08)
    model = nominal_model(robot, "paper")
    rates = no_slip_rates(model, np.array([0.0, 0.5, 0.0]))
    signal = linear(np.array([0.0, 0.5]), np.stack([np.zeros(4), rates]))
    run = simulate(model, signal, np.linspace(0.0, 0.5, 26))
    force = np.einsum("tn,nk->tk", run.force[..., 0], model.geometry.grip) + np.einsum(
        "tn,nk->tk", run.force[..., 1], model.geometry.free
    )
    moment = run.load @ (model.geometry.position_m - model.inertia.com_m)
    np.testing.assert_allclose(moment, -0.08 * force, atol=1e-9)
    assert run.load[10, :2].sum() < run.load[10, 2:].sum()  # speeding up forwards unloads the front


@pytest.mark.parametrize("across", [1.0, 2.0])
def test_slip_ratio_friction_loses_the_same_share_from_a_crawl_to_a_run(across):
    """The effect itself: 0.1 to 0.8 m/s lose the same share, within what v_0 = 1 mm/s leaves of it."""
    from slipmargin.effects.recipe import with_effects
    from slipmargin.effects.slip_ratio_friction import SlipRatioFriction

    nominal = paper_model("paper", improved=False)
    effect = SlipRatioFriction(share=1.0, steepness=4.0, transverse_factor=across)
    model = with_effects(nominal, (effect,))
    shares = {}
    for name, tried in (("creep", model), ("eq. (11)", nominal)):
        lost = []
        for speed in (0.1, 0.2, 0.4, 0.8):
            rates = no_slip_rates(tried, np.array([speed, 0.0, 0.0]))
            signal = linear(np.array([0.0, 4.0]), np.stack([rates, rates]))
            run = simulate(tried, signal, np.array([3.8, 3.9]), start_twist=np.array([speed, 0.0, 0.0]))
            moved = np.hypot(*(run.pose[1, :2] - run.pose[0, :2]))
            lost.append(1.0 - moved / (0.1 * speed))
        shares[name] = np.array(lost)
    creep, absolute = shares["creep"], shares["eq. (11)"]
    assert creep.min() > 0.02
    np.testing.assert_allclose(creep, creep[-1], rtol=0.02)  # v_0/v is 1 % at 0.1 m/s
    assert absolute[0] > 5.0 * absolute[-1]  # eq. (11) loses a speed, not a share
