"""Every command gives the same physics for a robot written in the paper's convention and in that of ROS."""

from __future__ import annotations

import csv
import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest
from conventions import gives_the_floor_a_direction, in_ros, ros
from hypothesis import given, reject, settings, strategies as st
from strategies import effects, four_wheels, kiwi, reals, robots

import slipmargin as sm
from slipmargin.checks import Array
from slipmargin.effects import Recipe
from slipmargin.effects.catalogue import CATALOGUE
from slipmargin.errors import SlipmarginError
from slipmargin.io.robot_file import recipe_from_text
from slipmargin.io.robot_text import write_recipe
from slipmargin.limits.bounds import directions
from slipmargin.physics.convention import Convention
from slipmargin.robot import GripShape, LoadRule, Robot

#: Solvers stop at another last digit where the columns of their matrices are turned.
SAME = {"rtol": 2e-7, "atol": 1e-9}
QUARTER = 0.5 * math.pi


def pair(robot: Robot | Recipe) -> tuple[Recipe, Recipe]:
    """The robot as its two files say it."""
    recipe = Recipe(robot=robot) if isinstance(robot, Robot) else robot
    one, two = (recipe_from_text(write_recipe(r)) for r in (recipe, in_ros(recipe)))
    assert one.robot.convention is Convention.PAPER and two.robot.convention is Convention.ROS
    return one, two


@st.composite
def drawn(draw: st.DrawFn) -> Robot:
    return draw(robots(max_wheels=4, shapes=tuple(GripShape), motors=True))


@settings(deadline=None, max_examples=12)
@given(robots(max_wheels=4), st.data())
def test_static_limits_and_the_wrench_polytope_are_turned(robot: Robot, data: st.DataObject) -> None:
    effect = data.draw(effects([c for c in CATALOGUE if c.name not in ("rigid_sector",)], reach=0.5))
    try:
        one, two = pair(Recipe(robot=robot, effects=(effect,)))
        # The floor's +x is the paper's robot's right at φ = 0 and the front of ROS's: a quarter turn apart.
        paper = sm.sweep(one, "floor", from_deg=0.0, to_deg=180.0, step_deg=15.0)
    except SlipmarginError:
        one, two = pair(robot)
        paper = sm.sweep(one, "floor", from_deg=0.0, to_deg=180.0, step_deg=15.0)
    # A pull along the floor's +x is another pull where the floor has a direction of its own.
    if not any(gives_the_floor_a_direction(effect) for effect in one.effects):
        turned = sm.sweep(two, "floor", from_deg=90.0, to_deg=270.0, step_deg=15.0)
        np.testing.assert_allclose(turned.f_max_N, paper.f_max_N, **SAME)
        np.testing.assert_allclose(turned.f_low_N, paper.f_low_N, **SAME)
        np.testing.assert_allclose(turned.f_high_N, paper.f_high_N, **SAME)
        assert turned.isotropic.force_N == pytest.approx(paper.isotropic.force_N, rel=1e-9)
    same_corners(sm.polytope(one, "floor").vertices, sm.polytope(two, "floor").vertices)


def same_corners(paper: Array, turned: Array) -> None:
    assert paper.shape == turned.shape
    size = np.abs(paper).max()
    apart = np.linalg.norm(ros(paper)[:, None] - turned[None], axis=2)
    assert np.max(apart.min(axis=1)) < 1e-9 * size and np.max(apart.min(axis=0)) < 1e-9 * size


@settings(deadline=None, max_examples=8)
@given(drawn())
def test_limits_in_motion_are_turned(robot: Robot) -> None:
    one, two = pair(robot)
    way = np.deg2rad(np.arange(0.0, 360.0, 30.0))
    paper = directions(one.build("floor"), way)
    turned = directions(two.build("floor"), way - QUARTER)
    for name in ("starting_m_s2", "turning_m_s2", "braking_m_s2", "steady_use"):
        np.testing.assert_allclose(getattr(turned, name), getattr(paper, name), rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("shape", [GripShape.DISC_STRIP, GripShape.ELLIPSE])
def test_coupled_grips_are_turned(shape: GripShape) -> None:
    for robot in (kiwi(grip=shape), four_wheels(grip=shape)):
        one, two = pair(robot)
        paper = sm.sweep(one, "paper", step_deg=15.0)
        turned = sm.sweep(two, "paper", from_deg=90.0, to_deg=180.0, step_deg=15.0)
        np.testing.assert_allclose(turned.f_max_N, paper.f_max_N, rtol=1e-6)
        np.testing.assert_allclose(turned.f_low_N, paper.f_low_N, rtol=1e-6)


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_bounds_and_their_exports_are_turned(robot: Robot) -> None:
    one, two = pair(robot)
    paper, turned = (sm.bounds(r, "paper", step_deg=15.0) for r in (one, two))
    back = np.roll(turned.bounds.full.starting_m_s2, 6)  # 90° of the paper's directions are 0° of ROS's
    np.testing.assert_allclose(back, paper.bounds.full.starting_m_s2, rtol=1e-6)
    assert turned.recommended_m_s2 == pytest.approx(paper.recommended_m_s2, rel=1e-6)
    assert paper.bounds.inside is not None and turned.bounds.inside is not None
    assert turned.bounds.inside.circle_m_s2 == pytest.approx(paper.bounds.inside.circle_m_s2, rel=1e-5)
    for name in ("fast", "slow"):
        x, y, yaw = getattr(paper.bounds.inside, name)
        np.testing.assert_allclose(getattr(turned.bounds.inside, name), [y, x, yaw], rtol=1e-4)
    for tool in ("nav2", "roadrunner", "pathplanner", "choreo"):  # all have x forward: the same text
        ours, theirs = numbers(turned.export_text(tool)), numbers(paper.export_text(tool))
        assert len(ours) >= 2 and ours == pytest.approx(theirs, rel=1e-3, abs=2e-4)


def numbers(text: str) -> list[float]:
    return [float(found) for found in re.findall(r"-?\d+\.\d+", text)]


@settings(deadline=None, max_examples=8)
@given(drawn(), reals(-math.pi, math.pi), reals(0.1, 0.8), reals(-1.0, 1.0))
def test_plans_checks_and_simulations_are_turned(robot: Robot, way: float, far: float, turn: float) -> None:
    one, two = pair(robot)
    goal = [[0.0, 0.0, 0.0], [far * math.cos(way), far * math.sin(way), turn]]
    try:
        paper = sm.plan(one, "floor", goal, points=40, step_s=0.02)
    except SlipmarginError as refused:
        with pytest.raises(type(refused)):
            sm.plan(two, "floor", ros(goal), points=40, step_s=0.02)
        return
    turned = sm.plan(two, "floor", ros(goal), points=40, step_s=0.02)
    assert turned.duration_s == pytest.approx(paper.duration_s, rel=1e-6)
    rows, others = paper.trajectory, turned.trajectory
    if len(rows.t_s) == len(others.t_s):
        for name in ("pose", "velocity", "acceleration"):
            np.testing.assert_allclose(
                getattr(others, name),
                ros(getattr(rows, name)),
                rtol=1e-4,
                atol=1e-4 * np.abs(rows.acceleration).max(),
            )
        np.testing.assert_allclose(others.omega, rows.omega, rtol=1e-4, atol=1e-4 * np.abs(rows.omega).max())
    given_rows = np.column_stack([rows.t_s, rows.pose])
    checked = sm.check(one, "floor", given_rows)
    again = sm.check(two, "floor", np.column_stack([rows.t_s, ros(rows.pose)]))
    np.testing.assert_allclose(again.check.use, checked.check.use, rtol=1e-6, atol=1e-7)
    assert again.time_scale_needed == pytest.approx(checked.time_scale_needed, rel=1e-6)


#: Steps of 0.2 s beyond which a wheel hovers at the edge of its rigid sector, where rounding decides [1];
#: others take a few thousand.
HOVERS = 20_000


@settings(deadline=None, max_examples=8)
@given(drawn(), st.data())
def test_simulations_are_turned(robot: Robot, data: st.DataObject) -> None:
    effect = data.draw(effects([c for c in CATALOGUE if c.name not in ("elliptic_grip",)], reach=0.5))
    try:
        one, two = pair(Recipe(robot=robot, effects=(effect,)))
    except SlipmarginError:
        one, two = pair(robot)
    n = len(robot.wheels)
    speed = 0.2 / max(w.radius_m for w in robot.wheels)
    omega = data.draw(st.lists(reals(-speed, speed), min_size=n, max_size=n))
    rows = [[0.0, *omega], [0.2, *omega]]
    push = data.draw(st.sampled_from([None, [0.3, -0.2, 0.01]]))
    found: list[Any] = []
    for machine, pushed in ((one, push), (two, None if push is None else ros(push))):
        with mock.patch("slipmargin.sim.batch.WHEEL_STEPS", HOVERS * n):
            try:
                found.append(
                    sm.simulate(machine, "floor", rows, push=pushed, step_s=0.05, relative_error=1e-9)
                )
            except SlipmarginError as refused:
                found.append(refused)
    if any("too many steps" in str(answer) for answer in found):
        reject()
    paper, turned = found
    if isinstance(paper, SlipmarginError):
        assert type(turned) is type(paper)
        return
    size = np.abs(paper.run.pose).max() + 1e-3
    np.testing.assert_allclose(turned.run.pose, ros(paper.run.pose), rtol=1e-5, atol=1e-6 * size)
    np.testing.assert_allclose(turned.run.theta, paper.run.theta, rtol=1e-6, atol=1e-8)
    # Along the drive direction: the file of ROS names the other end of the same line.
    np.testing.assert_allclose(
        turned.run.force, -paper.run.force, rtol=1e-3, atol=1e-3 * np.abs(paper.run.force).max()
    )


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_files_of_both_conventions_round_trip(robot: Robot, tmp_path: Path) -> None:
    _, two = pair(robot)
    again = recipe_from_text(write_recipe(two))
    assert again.robot.convention is Convention.ROS
    assert write_recipe(again) == write_recipe(two)
    assert 'convention = "ros"' in write_recipe(two)
    assert two.robot.load_rule is LoadRule(robot.load_rule)


def test_a_positive_speed_of_a_ros_mecanum_robot_drives_it_forwards() -> None:
    """20 rad/s on all four ended at y = −0.96 m before there was a convention."""
    _, two = pair(four_wheels())
    wheels = tuple(replace(w, drive_direction_deg=0.0) for w in two.robot.wheels)
    speeds = [[0.0, *[20.0] * 4], [1.0, *[20.0] * 4]]
    x, y, phi = sm.simulate(replace(two.robot, wheels=wheels), "paper", speeds).run.pose[-1]
    assert x > 0.7 and abs(y) < 1e-6 and abs(phi) < 1e-6


@settings(deadline=None, max_examples=6)
@given(robots(max_wheels=4), st.sampled_from(["sdf", "urdf", "mjcf"]))
def test_simulators_models_are_the_same(robot: Robot, format: str) -> None:
    """Gazebo and MuJoCo have x forward, whatever the robot file has."""
    one, two = pair(robot)
    ours, theirs = (numbers(sm.export_simulator(r, format, "floor").text) for r in (two, one))
    assert len(ours) > 20 and ours == pytest.approx(theirs, rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_designs_are_turned(robot: Robot) -> None:
    one, two = pair(robot)
    paper, turned = (sm.design(r, "paper", "circle_radius_m=0.1:0.2:0.1", static=True) for r in (one, two))
    ours, theirs = (list(csv.DictReader(found.table_text().splitlines())) for found in (turned, paper))
    for row, other in zip(ours, theirs, strict=True):
        assert row.pop("problem") == other.pop("problem") == ""
        del row["worst_phi_rad"], other["worst_phi_rad"]  # an orientation: counted from other axes
        assert [float(v) for v in row.values()] == pytest.approx([float(v) for v in other.values()], rel=2e-4)
    assert turned.best == paper.best


def test_measured_coefficients_are_turned(tmp_path: Path) -> None:
    one, two = pair(kiwi())
    phi = np.deg2rad(np.arange(0.0, 360.0, 20.0))
    forces = sm.sweep(one, "paper", from_deg=0.0, to_deg=340.0, step_deg=20.0).f_max_N
    found = []
    for recipe, turn in ((one, 0.0), (two, QUARTER)):  # the same pull, the heading counted from other axes
        rows = [f"{a + turn!r},{f!r}" for a, f in zip(phi.tolist(), forces.tolist(), strict=True)]
        file = tmp_path / f"{recipe.robot.convention.value}.csv"
        file.write_text("\n".join(["phi_rad,force_N", *rows]) + "\n", encoding="utf-8")
        found.append(sm.measure(file, recipe, "paper").measured)
    paper, turned = found
    np.testing.assert_allclose(turned.value, paper.value, rtol=1e-4)
    np.testing.assert_allclose(paper.value[0], [0.26, 0.09], rtol=1e-3)


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_stopping_distances_are_turned(robot: Robot) -> None:
    one, two = pair(robot)
    paper, turned = (
        sm.stop(r, "paper", speeds_m_s=[0.3], step_deg=90.0, verify=False).to_dict() for r in (one, two)
    )
    back = np.roll(np.array(turned["distance_m"]), 1, axis=0)  # 90° of the paper's directions are 0° of ROS's
    np.testing.assert_allclose(back, paper["distance_m"], rtol=1e-5)


@pytest.mark.parametrize("robot", [kiwi(), four_wheels()], ids=["kiwi", "mecanum"])
def test_monitors_see_the_same_slip(robot: Robot) -> None:
    paper, turned = (sm.SlipMonitor(r, "paper", false_alarm_rate=0.5) for r in pair(robot))
    for k in range(30):
        omega = np.resize([1.0, 2.0, 1.5, 0.5], len(robot.wheels)) * (8.0 if k > 20 else 0.4 * k)
        one, two = paper.update(0.01 * k, omega), turned.update(0.01 * k, omega)
        np.testing.assert_allclose(two.log_ratio, one.log_ratio, **SAME)
        np.testing.assert_allclose(
            two.twist, [one.twist[1], -one.twist[0], one.twist[2]], rtol=1e-3, atol=1e-4
        )
        assert (one.alarm, one.wheel) == (two.alarm, two.wheel)
    assert one.alarm or len(robot.wheels) == 3, "three wheels without gyro have no redundancy"


def test_every_command_is_held_to_both_conventions() -> None:
    """Where a command reads or writes something with axes, a test turns it; the list is for who adds one."""
    here = {
        "sweep",
        "polytope",
        "bounds",
        "plan",
        "check",
        "simulate",
        "design",
        "export",
        "measure",
        "stop",
        "monitor",
    }
    elsewhere = {
        "diagnose": "rooms/io/test_ros_conventions.py",  # the same report to the last digit
        "import": "rooms/io/test_log_formats.py",
        "next-run": "rooms/experiment/test_turned.py",  # computed in one frame, as a diagnosis is
        "robots": "rooms/study/test_layouts_in_ros.py",  # words and drawings
    }
    without_axes = {"reproduce", "surfaces", "effects", "explore"}
    from slipmargin_cli.main import COMMANDS

    missing = set(COMMANDS) - here - set(elsewhere) - without_axes
    assert not missing, f"say how {missing} is held to both conventions"
    tests = Path(__file__).parents[1]
    assert all((tests / name).is_file() for name in elsewhere.values())
