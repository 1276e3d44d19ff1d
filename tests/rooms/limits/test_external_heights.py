"""External forces have heights: slope, cable and push shift the wheels' loads, a lift lightens them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.optimize import linprog
from strategies import kiwi, models, reals

from slipmargin.errors import NoSolution
from slipmargin.limits import Pull, pull_limit, sensitivity, sweep, wrench_set
from slipmargin.limits.bias import bias
from slipmargin.limits.bounds import directions
from slipmargin.limits.cones import cone_limit
from slipmargin.limits.motion import acceleration_limit, along, needed_share
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import acceleration_rows
from slipmargin.limits.motion_state import Motion
from slipmargin.limits.self_check import self_check
from slipmargin.limits.sweep import limit
from slipmargin.model import Model, nominal_model
from slipmargin.model.parts import Drives, ExternalWrench
from slipmargin.paths.path import through
from slipmargin.paths.plan import Request, plan
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.physics.grips import GripShape
from slipmargin.physics.kinematics import com_acceleration
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable
from slipmargin.robot import LoadRule

#: Wheel angles of a symmetric robot with its third wheel uphill where the floor falls towards +y.
SLOPE = np.deg2rad(4.0)


def term(
    force: tuple[float, float],
    *,
    frame: Frame = Frame.FLOOR,
    height_m: float | None = None,
    lift_N: float = 0.0,
    variable: Variable = Variable.UNITY,
) -> ForceTerm:
    return ForceTerm(
        variable=variable,
        basis=Basis.CONSTANT if variable is Variable.UNITY else Basis.POLYNOMIAL,
        frame=frame,
        coefficients=np.array([[force[0]], [force[1]], [0.0]]),
        shape=np.ones(2),
        height_m=height_m,
        lift_N=lift_N,
    )


def on_slope(model: Model, angle: float = SLOPE, way: float = np.pi / 2) -> Model:
    """The model on a plane that falls by ``angle`` towards ``way``."""
    weight = model.inertia.weight_N
    pull = weight * np.sin(angle)
    down = term((pull * np.cos(way), pull * np.sin(way)), lift_N=weight * (1.0 - np.cos(angle)))
    return replace(model, external=ExternalWrench(terms=(down,)))


def robot(height_m: float = 0.08, **more: object) -> Model:
    return nominal_model(
        kiwi(30.0, radius_m=0.09, com_height_m=height_m, **more),  # type: ignore[arg-type]
        "paper",
    )


def plain_loads(model: Model, force: np.ndarray, height: float, lift: float) -> np.ndarray:
    """Three wheels' loads from three balances: vertical, and moments about the centre of mass's foot."""
    c = model.geometry.position_m - model.inertia.com_m
    return np.linalg.solve(
        np.vstack([np.ones(3), c.T]), [model.inertia.weight_N - lift, *(height * np.asarray(force))]
    )


def by_lp(model: Model, phi: float, load: np.ndarray, wrench: np.ndarray, ray: np.ndarray) -> float:
    """The largest pull with wheel forces within μ N, from the statement of the problem."""
    drive, side = model.wrench_maps()
    n = model.count
    top = np.concatenate([model.grip.roller[:, 0] * load, model.grip.roller[:, 1] * load])
    found = linprog(
        np.append(np.zeros(2 * n), -1.0),
        A_eq=np.column_stack([drive, side, ray]),
        b_eq=-wrench,
        bounds=[*((-t, t) for t in top), (0.0, None)],
        method="highs",
    )
    return float(found.x[-1])


def test_loads_on_a_slope_of_four_degrees() -> None:
    model = on_slope(robot())
    load = bias(model, np.zeros(1)).load_N[0]
    assert np.round(load, 2).tolist() == [10.39, 10.39, 8.57]
    weight = model.inertia.weight_N
    assert load == pytest.approx(
        plain_loads(model, [0.0, weight * np.sin(SLOPE)], 0.08, weight * (1 - np.cos(SLOPE))), rel=1e-12
    )
    assert np.sum(load) == pytest.approx(3.0 * GRAVITY_M_S2 * np.cos(SLOPE), rel=1e-12)
    assert wrench_set(model).load_N == pytest.approx(load)
    # turned by half a turn the other side is downhill
    assert np.round(bias(model, np.array([np.pi])).load_N[0], 2).tolist() == [9.18, 9.18, 11.0]


def test_three_roads_on_a_slope_agree_with_those_loads() -> None:
    model = on_slope(robot())
    weight, phi = model.inertia.weight_N, np.linspace(0.0, 2.0 * np.pi, 13)
    facets = limit(model, phi, Pull())
    cones = cone_limit(model, phi, Pull(), np.zeros(3, dtype=bool))
    slow = []
    for one in phi:
        c, s = np.cos(one), np.sin(one)
        down = weight * np.sin(SLOPE) * np.array([s, c])
        load = plain_loads(model, down, 0.08, weight * (1 - np.cos(SLOPE)))
        slow.append(by_lp(model, one, load, np.array([*down, 0.0]), np.array([c, -s, 0.0])))
    assert facets == pytest.approx(slow, rel=1e-9)
    assert cones == pytest.approx(slow, rel=1e-7)
    assert pull_limit(model, 0.4).force_N == pytest.approx(limit(model, np.array([0.4]), Pull())[0], rel=1e-7)
    assert self_check(model, phi, facets) < 1e-8
    found = sensitivity(model, phi)
    assert found.force_N == pytest.approx(facets, rel=1e-12)


def test_downhill_and_uphill_pulls_differ_by_more_than_the_weight_where_the_load_moves() -> None:
    high, flat = on_slope(robot()), on_slope(robot(0.0))
    ends = [
        [limit(m, np.zeros(1), Pull(direction_rad=way))[0] for way in (np.pi / 2, -np.pi / 2)]
        for m in (flat, high)
    ]
    weight = flat.inertia.weight_N * np.sin(SLOPE)
    assert ends[0][1] - ends[0][0] == pytest.approx(2.0 * weight, rel=1e-9)  # loads alike: only the weight
    assert abs(ends[1][0] - ends[0][0]) > 0.01  # the loads' shift shows
    # height is a number or that of the centre of mass
    same = replace(
        high, external=ExternalWrench(terms=tuple(replace(t, height_m=0.08) for t in high.external.terms))
    )
    assert limit(same, np.zeros(1), Pull())[0] == limit(high, np.zeros(1), Pull())[0]


@settings(max_examples=40, deadline=None)
@given(
    models(max_wheels=3, rules=(LoadRule.STATIC,)),
    reals(-0.05, 0.05),
    reals(-3.0, 3.0),
    reals(0.0, 1.0),
    reals(0.0, 0.05),
    reals(0.0, 0.1),
)
def test_any_force_at_any_height(
    model: Model, share: float, way: float, phi: float, height: float, pull_height: float
) -> None:
    weight = model.inertia.weight_N
    force = share * weight * np.array([np.cos(way), np.sin(way)])
    changed = replace(
        model,
        external=ExternalWrench(terms=(term((force[0], force[1]), frame=Frame.BODY, height_m=height),)),
    )
    load = plain_loads(model, force, height, 0.0) + (
        bias(model, np.zeros(1)).load_N[0] - plain_loads(model, np.zeros(2), 0.0, 0.0)
    )
    if np.min(load) < 0.0:
        with pytest.raises(NoSolution):
            limit(changed, np.array([phi]), Pull())
        return
    ray = np.array([np.cos(phi), -np.sin(phi), 0.0])
    try:
        facets = limit(changed, np.array([phi]), Pull())[0]
    except NoSolution:
        drive, side = model.wrench_maps()
        top = np.concatenate([model.grip.roller[:, 0] * load, model.grip.roller[:, 1] * load])
        held = linprog(
            np.zeros(6),
            A_eq=np.column_stack([drive, side]),
            b_eq=-np.array([*force, 0.0]),
            bounds=[(-t, t) for t in top],
        )
        assert held.status == 2  # no wheel forces hold it
        return
    assert facets == pytest.approx(
        by_lp(model, phi, load, np.array([*force, 0.0]), ray), rel=1e-7, abs=1e-9 * weight
    )
    pull = Pull(height_m=pull_height)
    assert cone_limit(changed, np.array([phi]), pull, np.zeros(3, dtype=bool))[0] == pytest.approx(
        limit(changed, np.array([phi]), pull)[0], rel=2e-7, abs=1e-9 * weight
    )


def test_a_pull_at_a_height_is_an_external_force_at_that_height() -> None:
    """The largest pull, taken as a force that is there already, leaves almost nothing."""
    model, phi = robot(), np.array([0.3])
    pull = Pull(height_m=0.05)
    most = limit(model, phi, pull)[0]
    push = term((0.999 * most, 0.0), height_m=0.05)
    loaded = replace(model, external=ExternalWrench(terms=(push,)))
    assert limit(loaded, phi, pull)[0] == pytest.approx(0.001 * most, rel=1e-6)


def test_a_slope_that_lifts_a_wheel_is_said_in_one_line() -> None:
    model = on_slope(robot(0.3), np.deg2rad(12.0))
    for run in (
        lambda: sweep(model, np.zeros(1)),
        lambda: cone_limit(model, np.zeros(1), Pull(), np.zeros(3, dtype=bool)),
        lambda: sensitivity(model, np.zeros(1)),
        lambda: wrench_set(model),
        lambda: directions(model, np.zeros(1)),
        lambda: plan(model, through(np.array([[0, 0, 0], [1, 0, 0.0]])), Request(points=20)),
    ):
        with pytest.raises(NoSolution, match="lifts off the floor") as fault:
            run()
        assert "\n" not in str(fault.value)


def test_a_force_of_unknown_place_takes_the_worst_of_its_loads() -> None:
    """A cable held high pulls more the farther away: the band's low end is the worst place on a grid."""
    base = robot()
    cable = term((-0.4, 0.2), frame=Frame.BODY, height_m=0.25, variable=Variable.POSITION_X)
    model = replace(base, external=ExternalWrench(terms=(cable,)))
    still = replace(model, grip=replace(model.grip, rigid_fraction=np.zeros(3)))
    found = sweep(still, np.array([0.2, 1.0]))
    worst, best = np.full(2, np.inf), np.zeros(2)
    for x in np.linspace(-1.0, 1.0, 21):
        at = term((-0.4 * x, 0.2 * x), frame=Frame.BODY, height_m=0.25)
        one = limit(replace(still, external=ExternalWrench(terms=(at,))), np.array([0.2, 1.0]), Pull())
        worst, best = np.minimum(worst, one), np.maximum(best, one)
    assert found.f_low_N == pytest.approx(worst, rel=1e-9)
    assert np.all(found.f_high_N >= best * (1.0 - 1e-9))  # the facets' best ends need not be one place
    ellipse = replace(still, grip=replace(still.grip, shape=GripShape.ELLIPSE))
    assert np.all(sweep(ellipse, np.array([0.2, 1.0])).f_low_N <= found.f_low_N * (1.0 + 1e-6))


def motion_by_lp(
    model: Model, motion: Motion, direction: np.ndarray, force: np.ndarray, height: float, lift: float
) -> float:
    """Largest t with drive forces within μ_W N(t), full drag and a known force at a height."""
    along_, across = model.wrench_maps()
    slide = np.sign(motion.velocity[0] @ model.geometry.lateral_rows().T)
    a0 = com_acceleration(model.inertia.com_m, motion.velocity, np.zeros((1, 3)))[0]
    a1 = com_acceleration(model.inertia.com_m, 0.0 * motion.velocity, direction[None])[0]
    n = model.count
    load0 = plain_loads(model, force, height, lift) + model.loads.per_acceleration_kg @ a0[:2]
    load1 = model.loads.per_acceleration_kg @ a1[:2]
    mass, drag = np.diag(model.inertia.diagonal), -across * (model.grip.roller[:, 1] * slide)
    limits = [np.column_stack([s * np.eye(n), -model.grip.roller[:, 0] * load1]) for s in (1.0, -1.0)]
    found = linprog(
        np.append(np.zeros(n), -1.0),
        A_eq=np.column_stack([along_, drag @ load1 - mass @ a1]),
        b_eq=mass @ a0 - drag @ load0 - np.array([*force, 0.0]),
        A_ub=np.vstack([*limits, np.column_stack([np.zeros((n, n)), -load1])]),
        b_ub=np.concatenate([*[model.grip.roller[:, 0] * load0] * 2, load0]),
        bounds=[(None, None)] * (n + 1),
    )
    return float(found.x[-1])


@pytest.mark.parametrize("rule", [LoadRule.STATIC, LoadRule.QUASI_STATIC])
@pytest.mark.parametrize("phi", [0.0, 1.1, 4.0])
def test_motion_limits_on_a_slope_are_those_of_a_linear_program(rule: LoadRule, phi: float) -> None:
    flat = robot(0.05, load_rule=rule)
    model, weight = on_slope(flat, np.deg2rad(3.0)), flat.inertia.weight_N
    down = weight * np.sin(np.deg2rad(3.0)) * np.array([np.sin(phi), np.cos(phi)])
    lift = weight * (1.0 - np.cos(np.deg2rad(3.0)))
    motion = Motion(velocity=np.array([[0.2, 0.5, 0.4]]), heading=np.array([phi]), saturated=True)
    for way in (np.array([0.0, 1.0, 0.0]), np.array([-1.0, 0.2, 0.0]), np.array([0.0, 0.0, 1.0])):
        ours = acceleration_limit(model, motion, way).value[0]
        slow = motion_by_lp(model, motion, way, down, 0.05, lift)
        assert ours == pytest.approx(slow, rel=1e-8)
        if slow > 0.0:  # at the limit the needed share is one, and so is the creeping equilibrium's
            at = replace(motion, acceleration=slow * way[None])
            assert needed_share(model, at)[0] == pytest.approx(1.0, rel=1e-8)
    # the centre of mass stands at the origin, which does not accelerate
    still = realised(model, replace(motion, acceleration=np.zeros((1, 3))))
    assert still.load_N[0] == pytest.approx(plain_loads(model, down, 0.05, lift), rel=1e-12)


def test_an_unknown_heading_is_as_bad_as_the_worst_one() -> None:
    model = on_slope(robot(0.05), np.deg2rad(2.0))
    velocity = np.array([[0.0, 1.0, 0.0]])
    unknown = acceleration_limit(model, Motion(velocity=velocity, saturated=True), velocity).value[0]
    each = [
        acceleration_limit(
            model, Motion(velocity=velocity, heading=np.array([phi]), saturated=True), velocity
        ).value[0]
        for phi in np.linspace(0.0, 2.0 * np.pi, 37)
    ]
    # a box round the circle of headings: never above the worst, and not far below
    assert min(each) - 0.3 * (max(each) - min(each)) <= unknown <= min(each) + 1e-9


def test_motor_torque_on_a_slope_counts_the_shifted_drag() -> None:
    model = on_slope(robot(0.08))
    model = replace(model, drives=Drives(max_speed_rad_s=100.0, stall_torque_N_m=0.03))
    motion = Motion(velocity=np.array([[0.3, 0.1, 0.0]]), heading=np.array([0.5]), saturated=True)
    rows = acceleration_rows(model, motion)
    way = np.array([[1.0, 0.0, 0.0]])
    found = along(model, rows, np.zeros((1, 3)), way)
    assert found.cause[0] == "motor torque"
    # at that acceleration the wheel's torque is what the motor gives: by the balance of forces
    load = bias(model, np.array([0.5])).load_N[0]
    wrench = bias(model, np.array([0.5])).wrench[0]
    slide = np.sign(motion.velocity[0] @ model.geometry.lateral_rows().T)
    drive, side = model.wrench_maps()
    asked = found.value[0] * way[0] * model.inertia.diagonal - wrench + side @ (0.09 * slide * load)
    torque = 0.0254 * np.linalg.solve(drive, asked)
    speed = model.geometry.wheel_speeds(motion.velocity)[0]
    given = 0.03 * np.where(-torque * speed > 0.0, 1.0 - np.abs(speed) / 100.0, 1.0)
    assert np.max(np.abs(torque) / given) == pytest.approx(1.0, rel=1e-9)


def test_a_plan_on_a_slope_keeps_its_share_with_the_true_loads() -> None:
    model = on_slope(robot(0.08), np.deg2rad(3.0))
    found = plan(model, through(np.array([[0, 0, 0], [0.5, 0.4, 0.5], [1, 0, 1.0]])), Request(points=40))
    assert found.max_use <= 0.9 * (1.0 + 1e-6)
    assert np.max(np.ptp(found.audit.load_N, axis=(0, 1))) > 0.5  # turning moves the load
    level = plan(
        on_slope(robot(0.0), np.deg2rad(3.0)),
        through(np.array([[0, 0, 0], [0.5, 0.4, 0.5], [1, 0, 1.0]])),
        Request(points=40),
    )
    assert abs(found.duration_s / level.duration_s - 1.0) > 1e-3
