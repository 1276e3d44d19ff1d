"""Limits under other tools' names: keys, units, frames, signs."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from strategies import kiwi

from slipmargin.api.robots import read_robot
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.bounds_summary import Bounds, bounds
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import torque_use
from slipmargin.limits.motion_state import Motion
from slipmargin.model import nominal_model
from slipmargin.report.exports import TOOLS, export_text
from slipmargin.robot import GripShape, Motor


@pytest.fixture(scope="module")
def found() -> Bounds:
    robot = replace(kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.9))
    return bounds(nominal_model(robot, "paper"), step_deg=15.0)


def numbers(line: str) -> list[float]:
    return [float(v) for v in re.findall(r"-?\d+\.\d+", line.split("#")[0])]


def test_nav2_has_its_own_names_order_and_signs(found: Bounds) -> None:
    text = export_text("nav2", found)
    lines = {line.split(":")[0].strip(): line for line in text.splitlines() if ":" in line}
    right, forward, yaw = found.inside.fast
    assert numbers(lines["max_accel"]) == pytest.approx([forward, right, yaw], abs=1e-4)  # x forward, y left
    assert all(v < 0.0 for v in numbers(lines["max_decel"]))
    assert numbers(lines["ax_max"]) == pytest.approx([found.inside.even[1]], abs=1e-4)
    assert numbers(lines["ax_min"]) == pytest.approx([-found.inside.even[1]], abs=1e-4)
    assert numbers(lines["ay_max"]) == pytest.approx([found.inside.even[0]], abs=1e-4)
    top = 60 * 0.0254 / np.cos(np.pi / 12)
    assert numbers(lines["max_velocity"])[0] == pytest.approx(found.inside.pace * top, abs=1e-3)
    assert "velocity_smoother" in lines and "az_max" in lines and "vx_max" in lines


def test_road_runner_speaks_inches(found: Bounds) -> None:
    text = export_text("roadrunner", found)
    assert re.match(r"// Paste .* class Params of Road Runner's MecanumDrive\.java\n", text)
    values = dict(re.findall(r"public double (\w+) = (-?[\d.]+);", text))
    assert float(values["maxProfileAccel"]) == pytest.approx(found.inside.circle_m_s2 / 0.0254, abs=1e-2)
    assert float(values["minProfileAccel"]) < 0.0
    wheel = found.inside.pace * 60.0  # rad/s × 1 inch
    assert float(values["maxWheelVel"]) == pytest.approx(wheel, abs=1e-2)
    assert {"maxAngVel", "maxAngAccel"} <= values.keys()
    assert "// omni wheels: MecanumDrive's kinematics are not this robot's" in text
    assert "omni wheels" not in export_text("roadrunner", rolling(45.0))


def test_pathplanner_and_choreo_take_a_coefficient(found: Bounds) -> None:
    table = json.loads(export_text("pathplanner", found))
    assert table["wheelCOF"] == found.inside.coefficient
    assert table["defaultMaxAccel"] == pytest.approx(found.inside.circle_m_s2)
    assert table["defaultMaxAngAccel"] == pytest.approx(np.rad2deg(found.inside.even[2]))
    assert table["robotMass"] == 3.0 and "robotMOI" in table and "maxDriveSpeed" in table
    config = json.loads(export_text("choreo", found))["config"]
    assert config["cof"]["val"] == pytest.approx(table["wheelCOF"])
    pace = found.inside.pace
    assert config["vmax"]["val"] == pytest.approx(60.0 * pace) and config["vmax"]["exp"].endswith("rad / s")
    assert config["tmax"]["val"] == pytest.approx(0.9 * 0.9 * (1.0 - pace))  # what the margin leaves there


def test_motors_have_the_exported_accelerations_at_the_exported_speeds() -> None:
    """The exported maximum speed was the speed without load, at which no torque is left to accelerate."""
    weak = replace(kiwi(), motor=Motor(max_speed_rad_s=60.0, stall_torque_N_m=0.12))
    model = nominal_model(weak, "paper")
    found = bounds(model, step_deg=15.0)
    assert 0.5 - 1e-6 <= found.inside.pace < 0.9
    speed = found.speeds[2]
    for way in np.deg2rad(np.arange(0.0, 360.0, 10.0)):
        ahead = np.array([[np.cos(way), np.sin(way), 0.0]])
        for sign in (1.0, -1.0):
            asked = ahead * found.inside.circle_m_s2 + [[0.0, 0.0, sign * found.inside.yaw_rad_s2]]
            forces = realised(model, Motion(velocity=speed * ahead, acceleration=asked))
            wheels = model.geometry.wheel_speeds(speed * ahead)
            assert np.max(torque_use(model, forces.torque_N_m, wheels)) <= 0.9 + 1e-6


def rolling(degrees: float) -> Bounds:
    """A robot with four wheels whose rollers stand at an angle, and motors."""
    robot = read_robot("mecanum4").robot
    wheels = tuple(
        replace(w, roller_angle_deg=float(np.copysign(degrees, w.roller_angle_deg))) for w in robot.wheels
    )
    motor = Motor(max_speed_rad_s=40.0, stall_torque_N_m=1.5)
    return bounds(nominal_model(replace(robot, wheels=wheels, motor=motor), "floor"), step_deg=15.0)


@pytest.mark.parametrize("degrees", [45.0, 60.0])
def test_a_swerve_modules_speed_is_not_a_wheels(degrees: float) -> None:
    """Choreo's vmax is how fast a module may move any way; a wheel with rollers at 45° turns √2 as fast.

    It was the wheels' speed, so that plans in the slow direction asked for 1.41 times the exported speed.
    """
    found = rolling(degrees)
    config = json.loads(export_text("choreo", found))["config"]
    speed = config["vmax"]["val"] * config["radius"]["val"]
    assert speed == pytest.approx(json.loads(export_text("pathplanner", found))["defaultMaxVel"])
    ways = np.deg2rad(np.arange(0.0, 360.0, 5.0))
    wheels = found.model.geometry.wheel_speeds(
        speed * np.column_stack([np.cos(ways), np.sin(ways), 0.0 * ways])
    )
    assert np.max(np.abs(wheels)) == pytest.approx(40.0 * found.inside.pace, rel=1e-3)


@pytest.mark.parametrize("tool", ["nav2", "roadrunner", "choreo"])
def test_a_part_of_the_top_speed_has_its_reason_beside_it(tool: str) -> None:
    """A comment said 77.8 % of the top speed and did not say what took the rest."""
    found = rolling(45.0)
    text = f"speeds: {100.0 * found.inside.pace:.3g} % of the wheels' top speed, each axis alone; "
    assert text + "there these accelerations and drag take 90 % of the motors' torque" in export_text(
        tool, found
    )
    motor = replace(found.model.drives, stall_torque_N_m=None)
    free = bounds(replace(found.model, drives=motor), step_deg=45.0)
    assert "speeds: 90 % of the wheels' top speed, each axis alone; up to there" in export_text(tool, free)


def test_pathplanners_top_speed_is_what_the_motors_hold() -> None:
    """PathPlanner takes the torque at maxDriveSpeed for lost: at half of the top speed that was half."""
    found = rolling(45.0)
    table, model = json.loads(export_text("pathplanner", found)), found.model
    speed = table["maxDriveSpeed"]
    assert speed > 1.05 * table["defaultMaxVel"]
    worst = []
    for way in np.deg2rad(np.arange(0.0, 360.0, 5.0)):
        velocity = speed * np.array([[np.cos(way), np.sin(way), 0.0]])
        torque = realised(model, Motion(velocity=velocity, acceleration=np.zeros((1, 3)))).torque_N_m
        worst.append(np.max(torque_use(model, torque, model.geometry.wheel_speeds(velocity))))
    assert max(worst) == pytest.approx(1.0, abs=5e-3)


def test_mass_off_the_middle_is_told_to_who_turns_while_driving() -> None:
    model = nominal_model(read_robot("mecanum4").robot, "floor")
    assert "off the middle" not in export_text("nav2", bounds(model, step_deg=45.0))
    moved = replace(model, inertia=replace(model.inertia, com_m=np.array([0.03, -0.04])))
    for tool in ("nav2", "roadrunner", "pathplanner", "choreo"):
        assert "0.05 m off the middle: turning at w rad/s while driving takes 0.05 w^2 m/s^2" in export_text(
            tool, bounds(moved, step_deg=45.0)
        )


def test_json_holds_everything(found: Bounds) -> None:
    table = json.loads(export_text("json", found))
    assert table["schema"] == 1 and len(table["starting_m_s2"]) == 24
    assert table["inside"]["box"] == pytest.approx(found.inside.even)


def test_refusals(found: Bounds) -> None:
    with pytest.raises(InputError, match="use one of: nav2"):
        export_text("moveit", found)
    hopeless = bounds(nominal_model(kiwi(grip=GripShape.ELLIPSE), "paper"), step_deg=45.0)
    for tool in set(TOOLS) - {"json"}:
        with pytest.raises(NoSolution, match="drag uses the whole grip") as refusal:
            export_text(tool, hopeless)
        assert str(refusal.value) == hopeless.why_not  # its own cure, and no other
    assert json.loads(export_text("json", hopeless))["inside"] is None


def test_too_much_yaw_in_reserve_says_how_much_may_be() -> None:
    """It had said "reserve less for yaw, use a smaller margin", and the margin has nothing to do with it."""
    model = nominal_model(kiwi(), "paper")
    greedy = bounds(model, step_deg=45.0, yaw_rad_s2=1000.0)
    with pytest.raises(
        NoSolution, match=r"1000 rad/s² leaves no grip .*, reserve less than \S+ rad/s² \(--yaw\)$"
    ):
        export_text("nav2", greedy)
    most = float(greedy.why_not.split("less than ")[1].split()[0])
    assert bounds(model, step_deg=45.0, yaw_rad_s2=0.98 * most).inside is not None
    again = bounds(model, step_deg=45.0, yaw_rad_s2=1.02 * most)
    assert again.why_not.endswith(f"reserve less than {most:g} rad/s² (--yaw)")
