"""The wrench set in motion against a second road: linear programs over the wheel forces themselves."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from oracles.drive_shares import drive_shares
from scipy.integrate import solve_ivp
from scipy.optimize import linprog
from strategies import four_wheels, kiwi, models, reals

from slipmargin.effects import Recipe
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.limits.motion import acceleration_limit, needed_share
from slipmargin.limits.motion_realised import realised, settling
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model, nominal_model
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.robot import GripShape, LoadRule, Motor

X = np.array([[1.0, 0.0, 0.0]])


def twists() -> st.SearchStrategy[np.ndarray]:
    return (
        st.tuples(reals(-1, 1), reals(-1, 1), reals(-3, 3))
        .map(np.array)
        .filter(lambda v: np.hypot(*v[:2]) > 0.05)
    )


def by_lp(model: Model, velocity: np.ndarray, direction: np.ndarray, rigid: np.ndarray) -> float:
    """Largest t with drive forces f: Σ b f − Σ t_i μ_T N_i sign = M a(t), |f_i| ≤ μ_W N_i(a), N_i ≥ 0."""
    n, c, com = model.count, model.geometry, model.inertia.com_m
    mu = np.where(rigid[:, None], model.grip.rigid, model.grip.roller)
    hub = velocity[:2] + velocity[2] * np.column_stack([-c.position_m[:, 1], c.position_m[:, 0]])
    roll = -np.sum(hub * c.grip, axis=1) / np.sum(c.drive * c.grip, axis=1)
    sign = np.sign(np.sum(hub * c.free, axis=1) + roll * np.sum(c.drive * c.free, axis=1))
    along, across = model.wrench_maps()
    a0 = -(velocity[2] ** 2) * np.array([*com, 0.0])
    a1 = direction + direction[2] * np.array([-com[1], com[0], 0.0])
    mass = np.diag([model.inertia.mass_kg] * 2 + [model.inertia.inertia_kg_m2])
    per = np.column_stack([model.loads.per_acceleration_kg, np.zeros(n)])
    load0, load1 = model.loads.rest_N + per @ a0, per @ a1
    drag = -across * (mu[:, 1] * sign)
    # unknowns (f, t): along f + drag (load0 + load1 t) = mass (a0 + a1 t)
    equal = np.column_stack([along, drag @ load1 - mass @ a1])
    right = mass @ a0 - drag @ load0
    limits = [np.column_stack([s * np.eye(n), -mu[:, 0] * load1]) for s in (1.0, -1.0)]
    A = np.vstack([*limits, np.column_stack([np.zeros((n, n)), -load1])])
    b = np.concatenate([mu[:, 0] * load0, mu[:, 0] * load0, load0])
    found = linprog(
        np.append(np.zeros(n), -1.0), A_ub=A, b_ub=b, A_eq=equal, b_eq=right, bounds=[(None, None)] * (n + 1)
    )
    return float(found.x[-1]) if found.success else -np.inf


@settings(max_examples=40, deadline=None)
@given(models(), twists(), reals(-np.pi, np.pi), reals(-5, 5))
def test_facets_agree_with_the_program_over_forces(
    model: Model, velocity: np.ndarray, way: float, turn: float
) -> None:
    direction = np.array([np.cos(way), np.sin(way), turn])
    answer = acceleration_limit(
        model, Motion(velocity=velocity[None], saturated=True), direction[None]
    ).value[0]
    expected = by_lp(model, velocity, direction, np.zeros(model.count, dtype=bool))
    if expected > 0.0:  # a state that must slip has no limit to compare
        assert answer == pytest.approx(expected, rel=1e-7, abs=1e-9)
    else:
        assert answer <= 1e-9


@settings(max_examples=20, deadline=None)
@given(models(max_wheels=4), twists(), reals(-np.pi, np.pi))
def test_unknown_contact_is_the_worst_of_all_states(model: Model, velocity: np.ndarray, way: float) -> None:
    model = replace(
        model,
        grip=replace(model.grip, rigid_fraction=np.full(model.count, 0.1)),
        loads=replace(model.loads, per_acceleration_kg=np.zeros((model.count, 2))),
    )
    direction = np.array([np.cos(way), np.sin(way), 0.0])
    motion = Motion(velocity=velocity[None], saturated=True)
    answer = acceleration_limit(model, motion, direction[None], contact=Contact.UNKNOWN).value[0]
    states = [np.array(s) for s in itertools.product((False, True), repeat=model.count)]
    expected = min(by_lp(model, velocity, direction, s) for s in states)
    least = max(-by_lp(model, velocity, -direction, s) for s in states)
    assume(abs(least - expected) > 1e-6)  # closer the programs' own tolerance decides
    if least > expected:  # one state needs more acceleration than another allows: none is safe in all
        assert answer <= 0.0
    elif expected > 0.0:
        assert answer == pytest.approx(expected, rel=1e-7, abs=1e-9)
    else:
        assert answer <= 1e-9


@settings(max_examples=30, deadline=None)
@given(models(min_wheels=3, max_wheels=3), twists())
def test_three_wheels_share_exactly(model: Model, velocity: np.ndarray) -> None:
    motion = Motion(velocity=velocity[None], saturated=True)
    assert needed_share(model, motion)[0] == pytest.approx(
        np.max(np.abs(drive_shares(model, motion))), rel=1e-7
    )


def unbalanced(
    model: Model,
    velocity: np.ndarray,
    asked: np.ndarray,
    creep: np.ndarray,
    load: np.ndarray,
    open_loop: bool,
) -> tuple[np.ndarray, np.ndarray]:
    """Wrench left over from the wheels' forces, and their use: Newton's law, wheel by wheel."""
    c, com, k = model.geometry, model.inertia.com_m, model.grip.k_s_per_m
    at_com = velocity[:2] + velocity[2] * np.array([-com[1], com[0]]) + creep[:2]
    spin = model.geometry.wheel_speeds(velocity)
    total, use = np.zeros(3), np.zeros(model.count)
    for i in range(model.count):
        arm = c.position_m[i] - com
        slip = (
            at_com
            + (velocity[2] + creep[2]) * np.array([-arm[1], arm[0]])
            + c.radius_m[i] * spin[i] * c.drive[i]
        )
        use[i] = abs(2.0 / np.pi * np.arctan(k * (slip @ c.grip[i])))
        f = sum(
            -load[i] * model.grip.roller[i, j] * 2.0 / np.pi * np.arctan(k * (slip @ e)) * e
            for j, e in enumerate((c.grip[i], c.free[i]))
        )
        total += [*f, arm[0] * f[1] - arm[1] * f[0]]
    a = asked[:2] + asked[2] * np.array([-com[1], com[0]]) - velocity[2] ** 2 * com
    if open_loop:
        w, v0 = velocity[2], at_com - creep[:2]
        a = a + (w + creep[2]) * np.array([-at_com[1], at_com[0]]) - w * np.array([-v0[1], v0[0]])
    needed = np.array([*(model.inertia.mass_kg * a), model.inertia.inertia_kg_m2 * asked[2]])
    return total - needed, use


@settings(max_examples=25, deadline=None)
@given(models(), twists(), st.booleans())
def test_realised_forces_balance(model: Model, velocity: np.ndarray, open_loop: bool) -> None:
    """Newton's equilibrium put back into the equation of motion."""
    asked = np.array([0.05, -0.03, 0.1])
    motion = Motion(velocity=velocity[None], acceleration=asked[None])
    forces = realised(model, motion, open_loop=open_loop)
    if np.max(forces.use) > 0.97:
        return  # the continued law takes over
    left, use = unbalanced(model, velocity, asked, forces.twist[0], forces.load_N[0], open_loop)
    assert left == pytest.approx(np.zeros(3), abs=1e-7 * model.inertia.weight_N)
    assert use == pytest.approx(forces.use[0], abs=1e-9)


@settings(max_examples=20, deadline=None)
@given(models(), twists(), reals(-0.4, 0.4), reals(-0.4, 0.4), reals(-1.0, 1.0))
def test_settling_after_a_jump_is_the_equation_of_motion(
    model: Model, velocity: np.ndarray, ax: float, ay: float, turn: float
) -> None:
    """The creep's own differential equation by SciPy, from the balance before to that after the jump."""
    jump = np.array([ax, ay, turn])
    while True:  # slower and softer until the wheels can do it
        before, after = (Motion(velocity=velocity[None], acceleration=a[None]) for a in (-jump, jump))
        ends = [realised(model, motion, open_loop=True) for motion in (before, after)]
        if max(np.max(end.use) for end in ends) < 0.9:
            break
        velocity, jump = 0.6 * velocity, 0.6 * jump
    mass = np.array([model.inertia.mass_kg, model.inertia.mass_kg, model.inertia.inertia_kg_m2])
    load = ends[1].load_N[0]

    def rate(_: float, creep: np.ndarray) -> np.ndarray:
        return unbalanced(model, velocity, jump, creep, load, True)[0] / mass

    path = solve_ivp(rate, (0.0, 0.5), ends[0].twist[0], method="LSODA", rtol=1e-7, atol=1e-10, max_step=1e-3)
    steps = list(path.y.T)
    if np.max(np.abs(unbalanced(model, velocity, jump, steps[-1], load, True)[1] - ends[1].use[0])) > 1e-3:
        # slow, or a balance that is unstable: the creep leaves it after a while
        path = solve_ivp(rate, (0.0, 20.0), steps[-1], method="LSODA", rtol=1e-7, atol=1e-10)
        steps += list(path.y.T)
    uses = [unbalanced(model, velocity, jump, creep, load, True)[1] for creep in steps]
    most = np.max([*uses, ends[1].use[0]], axis=0)  # half a second may not be the end of it
    found = settling(model, before, after)[0]
    if np.max(most) > 0.97:  # the creep ran away, and the continued law says how far
        assert np.max(found) > 0.97
    else:
        assert found == pytest.approx(most, abs=5e-3)


def test_a_wheel_may_use_more_on_the_way_than_before_and_after() -> None:
    """Four wheels, one heavy on its corner: yaw settles later than translation."""
    body = replace(four_wheels().body, inertia_kg_m2=2.0)
    model = nominal_model(replace(four_wheels(), body=body), "paper")
    twist = np.array([[0.3, 0.4, 0.5]])
    before = Motion(velocity=twist, acceleration=np.array([[0.5, -0.6, -0.3]]))
    after = Motion(velocity=twist, acceleration=np.array([[-0.5, 0.6, 0.3]]))
    ends = np.maximum(*(realised(model, m, open_loop=True).use for m in (before, after)))
    assert np.max(settling(model, before, after) - ends) > 0.02


def test_four_wheels_use_more_than_the_zonotope_needs() -> None:
    """docs/theory.md, section 4: some distribution exists, but the realised one is the wheels' own."""
    com = replace(four_wheels(), body=replace(four_wheels().body, com_m=np.array([0.05, 0.04])))
    model = nominal_model(com, "paper")
    motion = Motion(velocity=np.array([[0.6, 0.5, 1.0]]), acceleration=np.array([[0.4, 0.5, 0.5]]))
    least = needed_share(model, motion)[0]
    assert least < np.max(realised(model, motion).use) < 1.0


def test_use_beyond_the_limit_says_by_how_much() -> None:
    model = nominal_model(kiwi(), "paper")
    limit = acceleration_limit(model, Motion(velocity=X, saturated=True), X).value[0]
    fast = np.array([[20.0, 0.0, 0.0]])
    shares = [
        np.max(realised(model, Motion(velocity=fast, acceleration=part * limit * X)).use)
        for part in (0.5, 1.0, 1.2, 2.0)
    ]
    steady = 0.53122
    assert shares == pytest.approx(
        [steady + part * (1.0 - steady) for part in (0.5, 1.0, 1.2, 2.0)], abs=2e-3
    )


def test_losses_come_off_the_limit() -> None:
    recipe = Recipe(robot=kiwi())
    plain, heading = recipe.build("paper"), np.zeros(1)
    motion = Motion(velocity=X, saturated=True, heading=heading)
    free = acceleration_limit(plain, motion, X).value[0]
    slow = recipe.with_effects(RollingResistance(coefficient=0.01)).build("paper")
    resisting = 0.01 * GRAVITY_M_S2
    assert acceleration_limit(slow, motion, X).value[0] == pytest.approx(free - resisting, rel=1e-9)
    hill = recipe.with_effects(FloorTilt(tilt_x_rad=-0.02, tilt_y_rad=0.0)).build("paper")
    uphill = acceleration_limit(hill, motion, X).value[0]
    # every force between wheel and floor shrinks with the weight across the floor, m g cos
    assert uphill == pytest.approx(np.cos(0.02) * free - np.sin(0.02) * GRAVITY_M_S2, rel=1e-9)
    unknown = acceleration_limit(hill, Motion(velocity=X, saturated=True), X).value[0]
    assert unknown <= uphill + 1e-12  # with the heading unknown the slope may come from anywhere


def test_a_tall_robot_tips_before_it_slips() -> None:
    model = nominal_model(kiwi(load_rule=LoadRule.QUASI_STATIC, com_height_m=0.6), "paper")
    grippy = replace(model, grip=replace(model.grip, roller=np.tile([3.0, 0.01], (3, 1))))
    back = np.array([[0.0, -1.0, 0.0]])  # the rear wheel, ahead now, is lifted and has no drive force to give
    limit = acceleration_limit(grippy, Motion(velocity=-back, saturated=True), back)
    assert limit.wheels == (("rear",),)  # its grip ends where its load does
    load = grippy.loads.rest_N + grippy.loads.per_acceleration_kg @ (limit.value[0] * back[0, :2])
    assert np.min(load) == pytest.approx(0.0, abs=1e-9)


def test_a_weak_motor_limits_first_and_less_at_speed() -> None:
    robot = replace(kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.04))
    model = nominal_model(robot, "paper")
    slow, fast = (acceleration_limit(model, Motion(velocity=v * X, saturated=True), X) for v in (1e-3, 0.7))
    assert slow.cause == fast.cause == ("motor torque",)
    assert fast.value[0] < 0.75 * slow.value[0]
    # by hand: the rear wheel drives with 2/(1+sin δ) … of m a + drag; its torque is ρ f
    drag = 2.0 * 0.09 * model.loads.rest_N[0] * np.cos(np.pi / 12)
    force = 0.04 * (1.0 - 1e-3 / 0.0254 / 60.0) / 0.0254 * (1.0 + np.sin(np.pi / 12))
    assert slow.value[0] == pytest.approx((force - drag) / 3.0, rel=1e-6)
    assert acceleration_limit(model, Motion(velocity=X, saturated=True), X, motor=False).cause == ("grip",)


def test_coupled_grips_leave_less_for_the_drive() -> None:
    motion, limits = Motion(velocity=X, saturated=True), []
    for shape in (GripShape.BOX, GripShape.DISC_STRIP):
        model = nominal_model(kiwi(grip=shape), "paper")
        limits.append(
            acceleration_limit(
                model,
                Motion(velocity=np.array([[0.0, 1.0, 0.0]]), saturated=True),
                np.array([[0.0, 1.0, 0.0]]),
            ).value[0]
        )
    assert limits[1] < limits[0]
    # a wheel that slides as a whole has no grip left beside full drag: it must slip
    ellipse = nominal_model(kiwi(grip=GripShape.ELLIPSE), "paper")
    assert needed_share(ellipse, motion)[0] > 1.0
