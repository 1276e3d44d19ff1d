"""The compiled road against the readable one: accelerations, slopes, whole motions."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from instants import agrees, compiled, instant, somewhere
from manoeuvres import driven, force, modulation, wheel_motion, with_terms
from oracles.plain_simulator import acceleration, reference_motion
from strategies import four_wheels, kiwi, models, reals

from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.effects.recipe import with_effects
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.trailing_load import TrailingLoad
from slipmargin.errors import InputError, MotionStopped
from slipmargin.model import nominal_model
from slipmargin.model.parts import ActuatorDynamics, Drives
from slipmargin.physics.friction_laws import LAWS
from slipmargin.physics.terms import OF_PLACE, PER_WHEEL
from slipmargin.physics.variables import Basis, Frame, Target, Variable
from slipmargin.robot import GripShape, LoadRule
from slipmargin.sim.columns import ALPHA, BODY, CONTACT, OMEGA, RIGID, THETA
from slipmargin.sim.layout import BY_VELOCITY
from slipmargin.sim.motion import probed
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import linear
from slipmargin.sim.simulate import simulate

SHAPES = tuple(GripShape)


@given(
    models(shapes=SHAPES),
    st.integers(0, 2**31),
    st.sampled_from(range(len(LAWS))),
    reals(0.0, 1.0),
    st.booleans(),
)
@settings(max_examples=80, deadline=None)
def test_accelerations_agree(model, seed, law, coupling, raised):
    """Any robot, friction law and grip set, with forces at a height and an upward force."""
    model = replace(model, grip=replace(model.grip, law=law, coupling=coupling))
    if raised:
        slope = force(Variable.UNITY, Basis.CONSTANT, Frame.FLOOR, seed % 999, 0.1 * model.inertia.weight_N)
        lift = 0.05 * model.inertia.weight_N
        model = with_terms(model, forces=(replace(slope, height_m=None, lift_N=lift),))
    agrees(model, seed)


@pytest.mark.parametrize("field", ["runout", "wobble"])
@given(models(shapes=SHAPES), st.integers(0, 2**31))
@settings(max_examples=40, deadline=None)
def test_wheels_that_change_in_a_turn_agree(field, model, seed):
    waves = np.random.default_rng(seed).uniform(-0.1, 0.1, (model.count, 2))
    bent = replace(model, geometry=replace(model.geometry, **{field: waves}))
    y, wheels, rigid, push = somewhere(model.count, seed)
    agrees(bent, seed)
    slip, straight_slip = (compiled(m, 0.1, y, wheels, rigid, push)[1] for m in (bent, model))
    assert np.abs(slip - straight_slip).max() > 1e-6


@pytest.mark.parametrize("field", ["runout", "wobble"])
def test_a_run_on_a_wheel_that_changes_in_a_turn_agrees(field):
    model = nominal_model(kiwi(), "paper")
    waves = np.array([[0.04, -0.02], [0.0, 0.0], [0.0, 0.03]])
    bent = replace(model, geometry=replace(model.geometry, **{field: waves}))
    rates = np.array([[0.0, 0.0, 0.0], [9.0, -4.0, -6.0], [9.0, -4.0, -6.0]])
    signal = linear(np.array([0.0, 0.1, 0.8]), rates)
    times = np.linspace(0.0, 0.8, 5)
    pose = simulate(bent, signal, times).pose
    want = reference_motion(bent, wheel_motion(signal), signal.knots_s, times)
    assert np.abs(pose - want).max() <= 1e-6 * np.abs(want).max()
    assert np.abs(pose - simulate(model, signal, times).pose).max() > 1e-4


@pytest.mark.parametrize("variable", [v for v in Variable if v is not Variable.COMMAND_SPEED])
@pytest.mark.parametrize("basis", list(Basis))
def test_every_friction_term_agrees(variable, basis):
    robot = kiwi(
        load_rule=LoadRule.QUASI_STATIC, com_height_m=0.02, grip=SHAPES[basis % 3], com_m=(0.004, -0.01)
    )
    for target in Target:
        model = with_terms(nominal_model(robot, "paper"), (modulation(variable, basis, target, 3, variable),))
        y, wheels, rigid, push = somewhere(3, 10 * variable + basis)
        acc = compiled(model, 0.21, y, wheels, rigid, push)[0]
        np.testing.assert_allclose(
            acc, acceleration(model, 0.21, y, wheels, rigid, push)[0], rtol=1e-8, atol=1e-9
        )


@pytest.mark.parametrize("variable", sorted(PER_WHEEL))
def test_a_force_over_a_variable_of_a_wheel_is_refused(variable):
    with pytest.raises(InputError, match=f"{variable.name} belongs to a wheel"):
        force(variable, Basis.CONSTANT, Frame.FLOOR, 0)


@pytest.mark.parametrize("variable", [v for v in Variable if v not in PER_WHEEL])
@pytest.mark.parametrize("basis", list(Basis))
def test_every_force_term_agrees(variable, basis):
    bare = nominal_model(kiwi(com_m=(0.01, -0.02)), "carpet")
    y, wheels, rigid, push = somewhere(3, 10 * variable + basis)
    for frame in Frame:
        model = with_terms(bare, forces=(force(variable, basis, frame, variable, 5.0),))
        acc = compiled(model, 0.1, y, wheels, rigid, push)[0]
        np.testing.assert_allclose(
            acc, acceleration(model, 0.1, y, wheels, rigid, push)[0], rtol=1e-9, atol=1e-10
        )


#: Variables that come from the hub's velocity, and bases that have a slope everywhere.
HUB = (Variable.HUB_SPEED, Variable.PASSING_SPEED)
SMOOTH = (Basis.DECAY, Basis.POLYNOMIAL, Basis.STEP, Basis.FOURIER)
#: Variables by which a force on the body may change with its velocity; the first leaves that to its frame.
MOVING = (Variable.UNITY, Variable.VELOCITY_X, Variable.VELOCITY_Y, Variable.YAW_RATE, Variable.SPEED)


@given(
    models(shapes=SHAPES),
    st.integers(0, 2**31),
    st.sampled_from(
        (
            None,
            (Variable.HEADING, Basis.DECAY, Target.BOTH),
            *product(HUB, SMOOTH, Target),
            *product(HUB, (Basis.RECIPROCAL,), Target),
        )
    ),
    reals(0.0, 1.0) | st.just(1.0),
    st.booleans(),
    st.sampled_from((None, *product(MOVING, SMOOTH, Frame))),
)
@settings(max_examples=100, deadline=None)
def test_slopes_are_those_of_the_acceleration(model, seed, term, coupling, limited, drag):
    """Analytic derivatives over velocities, wheel speeds and time, of the body and of driven wheels."""
    n = model.count
    model = replace(model, grip=replace(model.grip, coupling=coupling))
    if term is not None:
        model = with_terms(model, (modulation(*term, n, seed % 1000),))
    if drag is not None:
        pull = force(*drag, seed % 1000, 0.02 * model.inertia.weight_N)
        model = with_terms(model, forces=(pull, replace(pull, height_m=0.05)))
    weak = np.where(np.arange(n) % 2 == seed % 2, 1e-3 * model.inertia.weight_N, np.inf)
    stall = weak if limited else None
    dynamics = replace(ActuatorDynamics.none(n), lag_s=np.full(n, 0.02), droop_rad_s_per_N_m=np.full(n, 2.0))
    drives = Drives(stall_torque_N_m=stall, max_speed_rad_s=30.0)
    model = replace(model, actuators=dynamics, drives=drives)
    y, wheels, rigid, _ = somewhere(n, seed, speed=0.003)
    packed = np.array(pack(model))
    assume(not packed[BY_VELOCITY])

    def at(state, omega):
        C, B, acc = np.zeros((n, CONTACT)), np.zeros(BODY), np.zeros(3)
        C[:, THETA], C[:, OMEGA], C[:, ALPHA], C[:, RIGID] = wheels[0], omega, wheels[2], rigid
        J, still, rate = np.zeros((3 + n, 7 + 2 * n)), np.zeros((3, 7)), np.zeros(n)
        instant(packed, 0.1, state, C.copy(), B, acc, still, 0, rate)
        instant(packed, 0.1, state, C, B, acc, J, n, rate)
        w = state[5]
        turned = acc + np.array([w * state[4], -w * state[3], 0.0])
        return np.concatenate([turned, rate]), J, still

    _, J, still = at(y, wheels[1])
    scale = np.abs(J).max(axis=1)
    for k in range(3 + n):
        up, down, faster, slower = y.copy(), y.copy(), wheels[1].copy(), wheels[1].copy()
        if k < 3:
            up[3 + k] += 1e-7
            down[3 + k] -= 1e-7
        else:
            faster[k - 3] += 1e-6
            slower[k - 3] -= 1e-6
        d = 2e-7 if k < 3 else 2e-6
        slope = (at(up, faster)[0] - at(down, slower)[0]) / d
        np.testing.assert_allclose(J[:, 3 + k], slope, rtol=2e-3, atol=2e-3 * scale.max())
        if k < 3:
            np.testing.assert_allclose(still[:, 3 + k], J[:3, 3 + k], rtol=1e-12)
    later = (at(y, wheels[1] + 1e-7 * wheels[2])[0][:3] - at(y, wheels[1])[0][:3]) / 1e-7
    np.testing.assert_allclose(still[:, 6], later, rtol=2e-3, atol=2e-3 * max(1.0, np.abs(later).max()))


@given(driven(shapes=SHAPES))
@settings(
    max_examples=20,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large],
)
def test_motions_agree_to_a_millionth(case):
    """20 drawn robots and manoeuvres, sectors included, against a reference at rtol 1e-11."""
    model, signal = case
    times = np.linspace(0.0, 0.25, 6)
    try:
        pose = simulate(model, signal, times).pose
    except MotionStopped:
        assume(False)
    want = reference_motion(model, wheel_motion(signal), signal.knots_s, times)
    error = np.abs(pose - want).max(axis=0)
    reach = float(np.mean(np.hypot(*model.geometry.position_m.T)))
    size = max(np.abs(want[:, :2]).max(), reach * np.abs(want[:, 2]).max())
    assert error[:2].max() <= 1e-6 * size + 1e-12
    assert reach * error[2] <= 1e-6 * size + 1e-12


@pytest.mark.parametrize(
    "variable",
    [
        Variable.SLIP_SPEED,
        Variable.WHEEL_LOAD,
        Variable.TIME,
        Variable.ROLLING_SPEED,
        Variable.ACCELERATION_X,
        Variable.HUB_SPEED,
        Variable.FROM_PLACE,
        Variable.BEFORE_LINE,
        Variable.SLIP_DIRECTION,
        Variable.PASSING_SPEED,
    ],
)
def test_motions_with_terms_agree(variable):
    robot = four_wheels(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.05)
    basis = Basis.WINDOW if variable is Variable.TIME else Basis.POLYNOMIAL
    basis = Basis.STEP if variable in OF_PLACE else basis
    model = with_terms(nominal_model(robot, "paper"), (modulation(variable, basis, Target.BOTH, 4, 5),))
    if variable in (Variable.TIME, Variable.ACCELERATION_X):
        model = with_terms(model, forces=(force(variable, basis, Frame.FLOOR, 3, 8.0),))
    rates = np.array([[0.0, 0.0, 0.0, 0.0], [6.0, 4.0, 7.0, 3.0], [2.0, 2.0, 2.0, 3.0], [0.0, 0.0, 0.0, 0.0]])
    signal = linear(np.array([0.0, 0.05, 0.08, 0.1]), rates)
    times = np.linspace(0.0, 0.1, 5)
    edges = np.array([0.2 * 0.3, 0.7 * 0.3]) if variable is Variable.TIME else None
    want = reference_motion(model, wheel_motion(signal), signal.knots_s, times, edges_s=edges)
    pose = simulate(model, signal, times).pose
    assert np.abs(pose - want).max() <= 1e-6 * np.abs(want).max()


@pytest.mark.parametrize(
    "effect",
    [
        SlipRatioFriction(share=0.9, steepness=4.0, transverse_factor=2.0),
        SlipRatioFriction(share=1.0, steepness=4.0, tread_share=0.5),
        TrailingLoad(lever_m=0.004),
        RollingResistance(coefficient=0.02, viscous_N_s_per_m=1.0),
        DraggingPoint(force_N=1.0, place_x_m=0.1),
    ],
)
def test_what_follows_the_velocity_has_analytic_slopes(effect):
    """Differences take as long as half of a step."""
    bare = nominal_model(kiwi(), "paper")
    assert not len(probed(np.array(pack(with_effects(bare, (effect,)))), pushed=False))
