"""Bounds by direction, and the largest sets inside them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from strategies import kiwi, models

from slipmargin.errors import InputError, NoSolution
from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.bounds import cornering, directions, headings, spin, starting_by_motor, top_speed
from slipmargin.limits.bounds_inside import inside
from slipmargin.limits.bounds_states import States
from slipmargin.limits.bounds_summary import bounds
from slipmargin.limits.every_motion import all_motions
from slipmargin.limits.motion import acceleration_limit
from slipmargin.limits.motion_friction import friction_in_motion
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import torque_use
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model, nominal_model
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable
from slipmargin.report.bounds import answer
from slipmargin.robot import GripShape, Motor

HEADINGS = np.deg2rad(np.arange(0.0, 360.0, 30.0))


@pytest.fixture
def model() -> Model:
    return nominal_model(kiwi(), "paper")


def test_directions_repeat_the_single_limits(model: Model) -> None:
    around = headings(15.0)
    found = directions(model, around, share=0.8)
    for k in (0, 5, 13):
        d = np.round(np.array([[np.cos(around[k]), np.sin(around[k]), 0.0]]), 15)
        motion = Motion(velocity=d, saturated=True)
        assert acceleration_limit(model, motion, d, share=0.8).value[0] == pytest.approx(
            found.starting_m_s2[k]
        )
        assert acceleration_limit(model, motion, -d, share=0.8).value[0] == pytest.approx(
            found.braking_m_s2[k]
        )
    assert np.all(found.braking_m_s2 >= found.starting_m_s2)
    with pytest.raises(InputError, match="step"):
        headings(0.0)


def test_a_symmetric_robot_has_symmetric_limits() -> None:
    found = directions(nominal_model(kiwi(30.0), "paper"), headings(1.0))
    third = np.roll(found.starting_m_s2, 120)
    assert found.starting_m_s2 == pytest.approx(third, rel=1e-9)


@settings(max_examples=15, deadline=None)
@given(models(max_wheels=4))
def test_cornering_speed_is_where_the_grip_ends(model: Model) -> None:
    """At the cornering speed the realised use of a robot that only turns its velocity is at its limit."""
    around = np.array([0.3, 2.0])
    found = cornering(model, np.array([0.7]), around, share=0.7)
    for k, v in enumerate(found.held_m_s[0]):
        if v == 0.0:
            continue
        ahead = np.array([np.cos(around[k]), np.sin(around[k]), 0.0])
        sides = [np.array([-ahead[1], ahead[0], 0.0]) * s * 0.7 * v**2 for s in (1.0, -1.0)]
        # So fast that rollers which slide a ten-thousandth of the way have their full drag as well.
        motion = Motion(velocity=1e8 * np.stack([ahead, ahead]), acceleration=np.array(sides))
        use = np.max(realised(model, motion).use)
        assert use >= 0.7 - 2e-3  # equal for three wheels; more wheels may use more than they need
        if model.count == 3:
            assert use == pytest.approx(0.7, abs=2e-3)


@pytest.mark.parametrize("name", ["ohio-kiwi", "mecanum4"])
@pytest.mark.parametrize("turning", [False, True])
def test_cornering_speed_is_where_the_motors_end(name: str, turning: bool) -> None:
    """At the cornering speed of weak motors one of them has just the share of its torque that it may use."""
    model = read_recipe(name).build({"ohio-kiwi": "paper", "mecanum4": "floor"}[name])
    stall = {"ohio-kiwi": 0.06, "mecanum4": 0.6}[name]
    drives = replace(model.drives, max_speed_rad_s=40.0, stall_torque_N_m=stall)
    slow = replace(model, drives=drives)
    fast = replace(model, drives=replace(drives, max_speed_rad_s=None, stall_torque_N_m=None))
    around, curvature = np.array([0.3, 2.0]), 0.7
    found, unlimited = (cornering(m, np.array([curvature]), around, share=0.8) for m in (slow, fast))
    for k, (held, tangent) in enumerate(zip(found.held_m_s[0], found.tangent_m_s[0], strict=True)):
        v, free = (tangent, unlimited.tangent_m_s) if turning else (held, unlimited.held_m_s)
        assert 0.0 < v < free[0, k]
        sides = np.array([1.0, -1.0])
        twist = np.array([[np.cos(around[k]), np.sin(around[k]), s * turning * curvature] for s in sides])
        inward = np.array([[-np.sin(around[k]), np.cos(around[k]), 0.0]]) * sides[:, None] * curvature * v**2
        # So fast that rollers which slide a ten-thousandth of the way have their full drag as well.
        torque = realised(slow, Motion(velocity=1e8 * twist, acceleration=inward)).torque_N_m
        use = torque_use(slow, torque, slow.geometry.wheel_speeds(v * twist))
        assert np.max(use) == pytest.approx(0.8, rel=1e-3)


def test_spinning_and_motors() -> None:
    robot = replace(kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.04))
    model = nominal_model(robot, "paper")
    turn = spin(model)
    assert turn.top_rad_s == pytest.approx(60.0 * 0.0254 / 0.095)
    assert spin(model, motor=False).starting_rad_s2 > turn.starting_rad_s2 > 0.0
    # along Y the front wheels turn with v cos δ / ρ
    assert top_speed(model, np.array([np.pi / 2]))[0] == pytest.approx(60.0 * 0.0254 / np.cos(np.pi / 12))
    assert np.isinf(top_speed(nominal_model(kiwi(), "paper"), np.zeros(1))[0])
    assert np.isinf(starting_by_motor(nominal_model(kiwi(), "paper"), np.zeros(1))[0])
    found = bounds(model, step_deg=10.0)
    assert found.smaller == "motor" and found.motor_limit_m_s2 < found.traction_m_s2
    assert found.recommended_m_s2 == 0.0  # at half the top speed, half the torque is less than the drag's
    stronger = nominal_model(
        replace(robot, motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.12)), "paper"
    )
    enough = bounds(stronger, step_deg=10.0)
    assert 0.0 < enough.recommended_m_s2 < 0.45 * enough.motor_limit_m_s2
    assert found.motor_limit_m_s2 == pytest.approx(np.min(starting_by_motor(model, headings(10.0))))


def test_the_box_and_the_ellipsoid_are_inside_and_touch(model: Model) -> None:
    sets = inside(model, share=0.9)
    A, b, _ = States.of(model, 0.9, Contact.ROLLERS).rows
    room = b - np.abs(A) @ sets.even
    assert -1e-7 <= np.min(room) < 1e-6
    room = b - np.linalg.norm(A @ sets.ellipsoid, axis=1)
    assert -1e-7 <= np.min(room) < 1e-6
    assert sets.even[2] == sets.yaw_rad_s2  # the yaw in reserve is given, the rest is as large as it can be
    rng = np.random.default_rng(0)
    for _ in range(300):  # no box of larger volume fits
        trial = sets.even * np.exp(rng.normal(size=3) * np.array([0.2, 0.2, 0.0]))
        if np.prod(trial) > np.prod(sets.even) * (1.0 + 1e-6):
            assert np.min(b - np.abs(A) @ trial) < 0.0


def test_the_sided_box_is_safe_in_every_motion(model: Model) -> None:
    """Each axis speeds up or slows down on its own: all eight corners, for every direction of motion."""
    sets = inside(model, share=0.9)
    rng = np.random.default_rng(1)
    for _ in range(60):
        way, yaw = rng.uniform(-np.pi, np.pi), rng.choice([-1.0, 0.0, 1.0])
        v = np.array([np.cos(way), np.sin(way), yaw / 0.095])
        corner = np.where(rng.random(3) < 0.5, np.sign(v) * sets.fast, -np.sign(v) * sets.slow)
        corner[v == 0.0] = 0.0
        use = realised(model, Motion(velocity=v[None], acceleration=corner[None])).use
        assert np.max(use) <= 0.9 + 0.02


def test_motions_of_a_kind_stand_together_and_ask_the_same() -> None:
    """What wheels are asked for is found once for each kind: 62 runs of four wheels are of 13 kinds."""
    model = nominal_model(read_recipe("omni4").robot, "floor")
    states = States.of(model, 0.9, Contact.ROLLERS)
    moving = np.vstack([states.motion.velocity, all_motions(model).velocity])
    assert np.array_equal(*(m[np.lexsort(m.T)] for m in np.split(moving, 2)))
    assert set(np.diff(states.kind)) == set(np.diff(states.run)) == {0, 1}
    assert states.kind[-1] + 1 == states.normals.shape[1] < len(states.first) == states.run[-1] + 1
    assert np.array_equal(np.sign(states.motion.velocity), states.sign[states.run])
    alone = replace(states.demands, kind=np.arange(states.motion.count))
    draw = np.random.default_rng(2).uniform(-1.0, 1.0, (5, states.kind[-1] + 1, 3))
    for near in (False, True):
        one, other = (d.most(draw, states.kind, states.limit_N_m, near=near) for d in (alone, states.demands))
        for name in ("use", "motors", "torque_N_m"):
            np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-5, atol=1e-7)
    again = states.demands.unknown(*draw.shape[:2])
    first, second = (
        states.demands.most(draw * by, states.kind, states.limit_N_m, creep=again) for by in (1.1, 1.0)
    )
    assert not np.allclose(first.use, second.use, rtol=1e-3)
    np.testing.assert_allclose(second.use, other.use, rtol=1e-5)


def test_no_safe_set_where_the_robot_must_slip(model: Model) -> None:
    with pytest.raises(NoSolution, match=r"use a margin below 0\.46"):
        inside(model, share=0.5)
    with pytest.raises(NoSolution, match="plan for rollers only"):
        inside(model, share=0.9, contact=Contact.UNKNOWN)
    found = bounds(nominal_model(kiwi(grip=GripShape.ELLIPSE), "paper"), step_deg=30.0)
    assert found.inside is None and "drag uses the whole grip" in found.why_not
    assert found.recommended_m_s2 == 0.0 and len(found.slipping_rad) == 12


def test_of_many_directions_those_farthest_apart_are_kept() -> None:
    """600 ends of each set of 24 wheels were driven through 500 motions: 24 s."""
    from slipmargin.limits.bounds_states import _farthest_apart

    draw = np.random.default_rng(5).normal(size=(552, 3))
    draw /= np.linalg.norm(draw, axis=1, keepdims=True)
    kept = _farthest_apart(draw, 64)
    assert len(set(kept.tolist())) == 64
    assert np.min(np.max(draw @ draw[kept].T, axis=1)) > np.cos(np.radians(25.0))
    np.testing.assert_array_equal(_farthest_apart(draw[:56], 64), np.arange(56))


def test_of_mirrored_directions_the_first_is_the_weakest() -> None:
    """Rounding chose between them, and differently after each change of the code."""
    found = bounds(read_recipe("mecanum4").build("floor"), step_deg=1.0).full
    least = float(np.min(found.starting_m_s2))
    alike = np.flatnonzero(found.starting_m_s2 <= least * (1.0 + 1e-9))
    assert len(alike) > 1 and found.weakest == alike[0]
    swapped = found.starting_m_s2.copy()
    swapped[alike[-1]] = np.nextafter(least, 0.0)
    assert replace(found, starting_m_s2=swapped).weakest == alike[0]


@pytest.mark.parametrize(
    ("basis", "shape"), [(Basis.STEP, (1.0, 0.05)), (Basis.DECAY, (1.0, 1.0)), (Basis.RECIPROCAL, (1.0, 1.0))]
)
def test_friction_that_changes_over_time_is_followed_to_its_end(
    basis: Basis, shape: tuple[float, float]
) -> None:
    """A grip that is better only at first promises nothing; time runs forwards only."""
    plain = nominal_model(kiwi(), "paper")
    better = {Basis.STEP: 0.5, Basis.DECAY: -0.5, Basis.RECIPROCAL: 0.5}[basis]
    term = Multiplier(
        variable=Variable.TIME,
        basis=basis,
        shape=np.array(shape),
        coefficients=np.array([better]),
        wheels=np.ones(3),
        target=Target.DRIVE,
    )
    warmed = replace(plain, grip=replace(plain.grip, multipliers=(term,)))
    after = 1.0 if basis is Basis.STEP else 1.5 if basis is Basis.DECAY else 0.5
    ended = replace(plain, grip=replace(plain.grip, roller=plain.grip.roller * [min(after, 1.0), 1.0]))
    ways = np.column_stack([np.cos(HEADINGS), np.sin(HEADINGS), np.zeros_like(HEADINGS)])
    motion = Motion.full_drag(ways)
    found, want = (acceleration_limit(m, motion, ways).value for m in (warmed, ended))
    np.testing.assert_allclose(found, want, rtol=1e-4)


def test_drag_of_a_disc_is_no_more_than_its_radius() -> None:
    """Across, a wheel whose transverse coefficient is the larger one slides at the drive one."""
    model = nominal_model(kiwi(grip=GripShape.DISC_STRIP), "paper")
    grip = replace(model.grip, roller=np.tile([0.26, 0.6], (3, 1)))
    motion = Motion.full_drag(np.array([[1.0, 0.3, 0.0]]))
    found = friction_in_motion(replace(model, grip=grip), motion)
    assert np.max(np.abs(found.drag_low[0])) == pytest.approx(0.26)
    boxed = friction_in_motion(replace(model, grip=replace(grip, shape=GripShape.BOX)), motion)
    assert np.max(np.abs(boxed.drag_low[0])) == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("name", "surface", "heading_deg", "share", "wheels"),
    [
        ("mecanum4", "floor", 90.0, 1.0, {"front-right", "front-left", "rear-left", "rear-right"}),
        ("mecanum4", "floor", 90.0, 0.9, {"front-right", "front-left", "rear-left", "rear-right"}),
        ("mecanum4", "floor", 45.0, 1.0, {"front-left", "rear-right"}),
        ("ohio-kiwi", "paper", 90.0, 1.0, {"right", "left"}),
        ("ohio-kiwi", "paper", 90.0, 0.9, {"right", "left"}),
    ],
)
def test_all_wheels_that_limit_together_are_named(
    name: str, surface: str, heading_deg: float, share: float, wheels: set[str]
) -> None:
    """Two of four wheels were named: those of the facet that rounding chose."""
    model = read_recipe(name).build(surface)
    found = directions(model, np.deg2rad([heading_deg]), share=share, motor=False)
    assert set(found.starting.wheels[0]) == wheels


def test_all_motors_that_limit_together_are_named() -> None:
    model = read_recipe("mecanum4").build("floor")
    weak = replace(model, drives=replace(model.drives, stall_torque_N_m=0.3))
    found = directions(weak, np.deg2rad([90.0]), share=0.9)
    assert found.starting.cause == ("motor torque",)
    assert found.starting.wheels == (("rear-left", "rear-right"),)  # they carry more and drive more


def test_what_is_said_of_all_directions_does_not_hang_on_the_tables_step() -> None:
    """With a step of 90 degrees the weakest direction was 90° with 2.327 m/s²; it is 45° with 1.646."""
    model = read_recipe("mecanum4").build("floor")
    fine, coarse = (bounds(model, step_deg=step) for step in (1.0, 90.0))
    assert np.rad2deg(coarse.full.heading_rad) == pytest.approx([0.0, 90.0, 180.0, 270.0])
    assert len(coarse.rigid_use) == len(coarse.top_m_s) == coarse.cornering.held_m_s.shape[1] == 4
    assert coarse.full.starting_m_s2 == pytest.approx(fine.full.starting_m_s2[::90])
    assert answer(coarse) == answer(fine)
    assert (coarse.traction_m_s2, coarse.motor_limit_m_s2) == (fine.traction_m_s2, fine.motor_limit_m_s2)
    assert fine.traction_m_s2 < 0.9 * np.min(coarse.full.starting_m_s2)
