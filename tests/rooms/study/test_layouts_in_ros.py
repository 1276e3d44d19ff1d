"""What knows where the front is (layouts, laps, words, pictures) turns with the robot file's convention."""

from __future__ import annotations

import numpy as np
import pytest
from conventions import robot_in_ros, ros
from matplotlib.figure import Figure
from strategies import four_wheels, kiwi

import slipmargin as sm
from slipmargin.model import nominal_model
from slipmargin.physics.convention import Convention
from slipmargin.plots.polar import of_pull
from slipmargin.report.drawing import drawing, speeds, wheel_words
from slipmargin.robot import Robot
from slipmargin.robot.layout import wheel_angle_deg, with_wheel_angle
from slipmargin.study.laps import benchmark_paths, lap_times
from slipmargin.study.layouts import ring, rows

PAPER, ROS = Convention.PAPER, Convention.ROS


def same_places(paper: Robot, turned: Robot) -> None:
    """The wheels stand at the same places, and their grip lines are the same lines."""
    one, two = paper.geometry, turned.geometry
    np.testing.assert_allclose(two.position_m, ros(one.position_m), atol=1e-12)
    across = ros(one.grip)[:, 0] * two.grip[:, 1] - ros(one.grip)[:, 1] * two.grip[:, 0]
    np.testing.assert_allclose(across, 0.0, atol=1e-12)


@pytest.mark.parametrize("delta", [-20.0, 15.0, 40.0])
def test_the_wheel_angle(delta: float) -> None:
    turned = with_wheel_angle(robot_in_ros(kiwi()), delta)
    same_places(with_wheel_angle(kiwi(), delta), turned)
    np.testing.assert_allclose(
        turned.geometry.drive, ros(with_wheel_angle(kiwi(), delta).geometry.drive), atol=1e-12
    )
    assert wheel_angle_deg(turned) == pytest.approx(delta)


@pytest.mark.parametrize("count", [3, 4, 6])
def test_rings_and_rows(count: int) -> None:
    same_places(ring(kiwi(), count), ring(robot_in_ros(kiwi()), count))
    if count % 2 == 0:
        robot = four_wheels()
        same_places(rows(robot, count), rows(robot_in_ros(robot), count))


def test_laps_take_as_long() -> None:
    names = ("forwards", "right", "square")
    paths = [{n: p for n, p in benchmark_paths(c).items() if n in names} for c in (PAPER, ROS)]
    one, two = (
        lap_times(nominal_model(r, "paper"), p)
        for r, p in zip((kiwi(), robot_in_ros(kiwi())), paths, strict=True)
    )
    assert one["forwards"] != pytest.approx(one["right"], rel=1e-3)
    assert two == pytest.approx(one, rel=1e-6)


def test_words_and_drawings_are_the_same_robot() -> None:
    one, two = four_wheels(), robot_in_ros(four_wheels())
    assert wheel_words(two) == wheel_words(one)
    np.testing.assert_allclose(speeds(two), speeds(one), atol=1e-12)
    text, other = drawing(kiwi()), drawing(robot_in_ros(kiwi()))
    assert "front (+Y)" in text[0] and "front (+X)" in other[0]
    places = [
        [(i, row.find(str(k))) for i, row in enumerate(t) if str(k) in row]
        for t in (text, other)
        for k in (1, 2, 3)
    ]
    assert len(places[0]) == len(places[3]) == 1  # each number is drawn once
    assert all(abs(a[0][0] - b[0][0]) <= 4 for a, b in zip(places[:3], places[3:], strict=True))


def test_pictures_name_the_axes_of_the_file() -> None:
    """The wedge of the front, the axes' names and polar plots follow the convention."""
    turned = robot_in_ros(kiwi())
    labels = []
    for robot in (kiwi(), turned):
        figure = sm.describe_robot(robot).plot()
        axes = figure.axes[0]
        wedge = np.mean(axes.patches[1].get_xy()[:3], axis=0) - np.mean(robot.geometry.position_m, axis=0)
        labels.append(
            (axes.get_xlabel(), axes.get_ylabel(), np.round(wedge / np.linalg.norm(wedge), 6).tolist())
        )
    assert labels[0] == ("x, to the right [m]", "y, forwards [m]", [0.0, 1.0])
    assert labels[1] == ("x, forwards [m]", "y, to the left [m]", [1.0, 0.0])
    # A pull at φ = 0 along the floor's +x: to the right of the paper's robot, forwards of ROS's.
    assert of_pull(np.zeros(1), PAPER) == pytest.approx(-0.5 * np.pi)
    assert of_pull(np.zeros(1), ROS) == pytest.approx(0.0)
    section = sm.polytope(turned, "paper").plot().axes[1]
    assert section.get_xlabel() == "Fx, forwards [N]"
    for result in (
        sm.bounds(turned, "paper", step_deg=45.0),
        sm.plan(turned, "paper", [[0, 0, 0], [1, 0, 0]], points=40),
    ):
        assert isinstance(result.plot(), Figure)


def test_the_robotino_s_front_is_its_makers() -> None:
    """Wheel 2 is at the rear, 1 to the left and 3 to the right of the front; nav2's x is the makers' x."""
    robot = sm.read_robot("robotino").robot
    assert robot.convention is ROS
    rear, left, right = robot.wheels[1], robot.wheels[0], robot.wheels[2]
    assert rear.position_m[0] < 0.0 and abs(rear.position_m[1]) < 1e-9
    assert left.position_m[1] > 0.0 > right.position_m[1] and left.position_m[0] == right.position_m[0] > 0.0
    found = sm.bounds(robot, "table", step_deg=30.0)
    assert found.bounds.inside is not None
    ahead, side, yaw = found.bounds.inside.fast
    assert ahead != pytest.approx(side, rel=1e-3)
    assert f"max_accel: [{ahead:.4f}, {side:.4f}, {yaw:.4f}]" in found.export_text("nav2")
