"""A log of ROS, as ROS writes it, is imported without a conversion by its user."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.api.robots import RobotLike
from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.data_set import read_data_set
from slipmargin.io.importers.ros_names import guessed_topic, joints_of_wheels
from slipmargin.io.robot_text import write_recipe
from slipmargin.physics.convention import Convention

pytest.importorskip("rosbags", reason="rosbags is not installed (extra [ros])")

JOINTS = (
    "wheel_front_left_joint",
    "wheel_front_right_joint",
    "wheel_rear_left_joint",
    "wheel_rear_right_joint",
)


def write_bag(
    folder: Path,
    t: Array,
    pose: Array,
    theta: Array,
    omega: Array,
    names: Sequence[str] = JOINTS,
    odometry: bool = False,
) -> Path:
    """A ROS 2 bag by REP 103: a tracker's PoseStamped, joint_states in alphabetic order, a goal pose."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    T = store.types
    kinds = {
        "/tracker/pose": "geometry_msgs/msg/PoseStamped",
        "/goal_pose": "geometry_msgs/msg/PoseStamped",
        "/joint_states": "sensor_msgs/msg/JointState",
    }
    order = np.argsort(names)
    with Writer(folder, version=9) as writer:
        links = {k: writer.add_connection(k, v, typestore=store) for k, v in kinds.items()}

        def put(topic: str, message: object, at: float) -> None:
            writer.write(links[topic], round(1e9 * at), store.serialize_cdr(message, kinds[topic]))

        for k, at in enumerate(100.0 + t):
            sec, rest = divmod(round(1e9 * float(at)), 10**9)
            stamp = T["builtin_interfaces/msg/Time"](sec=sec, nanosec=rest)
            header = T["std_msgs/msg/Header"](stamp=stamp, frame_id="map")
            half = pose[k, 2] / 2
            body = T["geometry_msgs/msg/Pose"](
                position=T["geometry_msgs/msg/Point"](x=pose[k, 0], y=pose[k, 1], z=0.0),
                orientation=T["geometry_msgs/msg/Quaternion"](
                    x=0.0, y=0.0, z=math.sin(half), w=math.cos(half)
                ),
            )
            stamped = T["geometry_msgs/msg/PoseStamped"](header=header, pose=body)
            put("/tracker/pose", stamped, at)
            put("/goal_pose", stamped, at)
            state = T["sensor_msgs/msg/JointState"](
                header=header,
                name=[names[i] for i in order],
                position=theta[k, order],
                velocity=omega[k, order],
                effort=np.zeros(0),
            )
            put("/joint_states", state, at)
    return folder


def rover(tmp_path: Path) -> Path:
    """A mecanum robot as ``robots new`` writes it, with friction law and loads that simulate quickly."""
    file = tmp_path / "rover.toml"
    file.write_text(sm.new_robot("rover", "mecanum").text, encoding="utf-8")
    return file


def drives(count: int, seed: int = 1) -> list[tuple[Array, Array]]:
    """Wheel speeds (T, 4) of short manoeuvres, smooth and at rest at both ends."""
    random = np.random.default_rng(seed)
    t = np.linspace(0.0, 3.0, 61)
    found = []
    for _ in range(count):
        parts = random.uniform(-5.0, 5.0, (3, 4))
        shape = np.array([np.sin(np.pi * k * t / t[-1]) for k in (1, 2, 3)]).T
        found.append((t, shape @ parts))
    return found


def bags(robot: RobotLike, tmp_path: Path, count: int, noise: float = 3e-4) -> list[Path]:
    """Bags of a robot that was simulated, its pose measured with noise."""
    random = np.random.default_rng(7)
    out = []
    for k, (t, omega) in enumerate(drives(count)):
        run = sm.simulate(robot, "floor", np.column_stack([t, omega]), linear=True, step_s=0.05).run
        pose = run.pose + random.normal(0.0, noise, run.pose.shape)
        speeds = np.array([np.interp(run.t_s, t, w) for w in omega.T]).T
        out.append(write_bag(tmp_path / f"run{k}", run.t_s, pose, run.theta, speeds))
    return out


def test_a_bag_is_imported_without_a_conversion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, out = rover(tmp_path), tmp_path / "set"
    (bag,) = bags(sm.read_robot(robot), tmp_path, 1, noise=0.0)
    assert status(["import", "ros", str(bag), "--robot", str(robot), "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "/tracker/pose (geometry_msgs/msg/PoseStamped) is taken as the pose topic" in told
    assert "fl = wheel_front_left_joint, fr = wheel_front_right_joint" in told
    kept = read_data_set(out)
    assert kept.recipe.robot.convention is Convention.ROS
    t, omega = drives(1)[0]
    run = sm.simulate(robot, "floor", np.column_stack([t, omega]), linear=True, step_s=0.05).run
    (trial,) = kept.trials
    np.testing.assert_allclose(trial.pose, run.pose, atol=1e-8)
    np.testing.assert_allclose(trial.theta, run.theta, atol=1e-6)
    assert status(["import", "ros", str(bag), "--robot", str(robot), "--out", str(out)]) == 2
    assert "holds a data set already" in capsys.readouterr().err
    assert status(["import", "ros", str(bag), "--robot", str(robot), "--out", str(out), "--force"]) == 0


@pytest.mark.parametrize("turn", [0.0, 90.0, -37.0])
def test_yaw_becomes_phi_of_the_robot_s_convention(turn: float, tmp_path: Path) -> None:
    t = np.linspace(0.0, 1.0, 11)
    front = np.column_stack([0.1 * t, 0.2 * t, 0.3 * t])
    logged = front + np.array([0.0, 0.0, math.radians(turn)])
    bag = write_bag(tmp_path / "run", t, logged, np.outer(t, np.ones(4)), np.ones((11, 4)))
    ros_robot = sm.new_robot("rover", "mecanum").recipe
    paper = sm.read_robot("mecanum4")
    for robot, phi in ((ros_robot, front[:, 2]), (paper, front[:, 2] - 0.5 * math.pi)):
        (record,) = sm.import_logs([bag], "ros", robot, pose_rotation_deg=turn).data_set.trials
        np.testing.assert_allclose(record.pose[:, 2], phi, atol=1e-9)
        np.testing.assert_allclose(record.pose[:, :2], front[:, :2], atol=1e-9)


def test_topics_are_guessed_by_type() -> None:
    pose, odom = "geometry_msgs/msg/PoseStamped", "nav_msgs/msg/Odometry"
    assert guessed_topic({"/a": pose, "/goal_pose": pose, "/odom": odom}, "--pose-topic")[0] == "/a"
    topic, note = guessed_topic({"/odom": odom}, "--pose-topic")
    assert topic == "/odom" and "cannot show that they slip" in note
    with pytest.raises(InputError, match="2 topics fit: /a, /b"):
        guessed_topic({"/a": pose, "/b": pose}, "--pose-topic")
    with pytest.raises(InputError, match="no topic of the bag is one of sensor_msgs"):
        guessed_topic({"/a": pose}, "--joint-topic")


@pytest.mark.parametrize(
    ("wheels", "joints", "found"),
    [
        (("fl", "rr"), ("rr_wheel", "fl_wheel"), ("fl_wheel", "rr_wheel")),
        (
            ("front-left", "rear-right"),
            ("backRightWheel", "frontLeftWheel"),
            ("frontLeftWheel", "backRightWheel"),
        ),
        (("left", "back"), ("base_left_wheel", "base_back_wheel"), ("base_left_wheel", "base_back_wheel")),
        (("1", "2"), ("wheel_2", "wheel_1"), ("wheel_1", "wheel_2")),
        (("w", "v"), ("w", "v", "w_roller"), ("w", "v")),
    ],
)
def test_joints_are_found_by_their_words(
    wheels: tuple[str, ...], joints: tuple[str, ...], found: tuple[str, ...]
) -> None:
    assert joints_of_wheels(wheels, joints, "/j") == found


def test_joints_that_are_not_clear_are_asked_for() -> None:
    with pytest.raises(InputError, match="no joint is clearly wheel 'fl'"):
        joints_of_wheels(("fl",), ("a", "b"), "/j")
    with pytest.raises(InputError, match="fl_1, fl_2 all fit wheel 'fl'"):
        joints_of_wheels(("fl",), ("fl_1", "fl_2"), "/j")


def test_a_planted_effect_is_found_in_bags_without_a_conversion(tmp_path: Path) -> None:
    """Wheel fl is 4 % larger than the file says; the same runs in the paper's convention say the same."""
    file = rover(tmp_path)
    believed = sm.read_robot(file)
    worn = tuple(
        replace(w, radius_m=w.radius_m * (1.04 if w.name == "fl" else 1.0)) for w in believed.robot.wheels
    )
    folders = bags(replace(believed.robot, wheels=worn), tmp_path, 5)
    data, out = tmp_path / "set", tmp_path / "report"
    assert status(["import", "ros", *map(str, folders), "--robot", str(file), "--out", str(data)]) == 0
    assert status(["diagnose", str(data), "--out", str(out)]) == 0
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    (effect,) = report["effects"]
    assert report["verdict"] == "effect-found" and effect["name"] == "wheel_radius"
    assert effect["wheels"] == ["fl"]
    assert effect["parameters"]["radius_factor"]["value"] == pytest.approx(1.04, abs=0.01)

    # The same data set as a user of the paper's convention has it: the same report to the last digit.
    turned = tmp_path / "paper" / "set"
    turned.parent.mkdir()
    in_paper(data, turned)
    assert status(["diagnose", str(turned), "--out", str(tmp_path / "again")]) == 0
    again = json.loads((tmp_path / "again" / "report.json").read_text(encoding="utf-8"))
    assert again.pop("noise") == dict(
        zip(("x_m", "y_m", "phi_rad"), (report["noise"][k] for k in ("y_m", "x_m", "phi_rad")), strict=True)
    )
    del report["noise"]
    ours, theirs = report.pop("limit_curves"), again.pop("limit_curves")
    for when in ("before", "after"):
        for name, values in theirs[when].items():  # a quarter of the circle apart
            back = len(values) // 4 * (1 if name.startswith("f_") else -1)
            assert ours[when][name] == np.roll(values, back).tolist(), (when, name)
    axis = {"position x": "position y", "position y": "position x"}
    for row in (*again["where"], *again["where_after"]):
        row["variable"] = axis.get(row["variable"], row["variable"])
    assert again == report
    first, second = (sm.read_robot(tmp_path / d / "corrected.toml") for d in ("report", "again"))
    assert [e.to_table() for e in first.effects] == [e.to_table() for e in second.effects]
    assert first.robot.convention is Convention.ROS and second.robot.convention is Convention.PAPER


def in_paper(data: Path, out: Path) -> None:
    """A data set of the convention of ROS in that of the paper: floor and body turned by 90°."""
    from slipmargin.io.data_set_write import write_data_set

    kept = read_data_set(data)
    robot = kept.recipe.robot

    def turned(v: Array) -> Array:
        return np.array([-v[1], v[0]])

    wheels = tuple(
        replace(w, position_m=turned(w.position_m), drive_direction_deg=w.drive_direction_deg - 90.0)
        for w in robot.wheels
    )
    body = replace(robot.body, com_m=turned(robot.body.com_m))
    recipe = replace(kept.recipe, robot=replace(robot, convention=Convention.PAPER, wheels=wheels, body=body))
    trials = tuple(
        replace(t, pose=np.column_stack([-t.pose[:, 1], t.pose[:, 0], t.pose[:, 2]])) for t in kept.trials
    )
    assert 'convention = "paper"' in write_recipe(recipe)
    write_data_set(out, replace(kept, recipe=recipe, trials=trials))


def test_damaged_bags_are_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A bag cut or overwritten anywhere is read or refused with one line, never with a traceback."""
    robot, t = rover(tmp_path), np.linspace(0.0, 1.0, 11)
    pose = np.column_stack([0.1 * t, 0.0 * t, 0.0 * t])
    bag = write_bag(tmp_path / "run", t, pose, np.outer(t, np.ones(4)), np.ones((11, 4)))
    files = sorted(p for p in bag.iterdir() if p.is_file())
    random = np.random.default_rng(3)
    for k in range(25):
        file = files[k % len(files)]
        whole = file.read_bytes()
        at = int(random.integers(1, len(whole)))
        file.write_bytes(
            whole[:at] if k % 2 else whole[:at] + bytes(random.integers(0, 256, 60)) + whole[at + 60 :]
        )
        out = tmp_path / f"set{k}"
        code = status(["import", "ros", str(bag), "--robot", str(robot), "--out", str(out)])
        told = capsys.readouterr().err
        file.write_bytes(whole)
        assert code in (0, 2), (k, told)
        if code == 2:
            assert told.startswith("error: ") and told.count("\n") == 1 and not out.exists()


def test_a_log_without_pose_or_with_unknown_joints_says_what_is_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot, t = rover(tmp_path), np.linspace(0.0, 1.0, 11)
    pose = np.column_stack([0.1 * t, 0.0 * t, 0.0 * t])
    bag = write_bag(
        tmp_path / "run", t, pose, np.outer(t, np.ones(4)), np.ones((11, 4)), names=("a", "b", "c", "d")
    )
    words = ["import", "ros", str(bag), "--robot", str(robot), "--out", str(tmp_path / "set")]
    assert status(words) == 2
    told = capsys.readouterr().err
    assert "no joint is clearly wheel 'fl', give --joint once for each of fl, fr, rl, rr" in told
    named = [w for joint in ("a", "b", "-c", "-d") for w in ("--joint", joint)]
    assert status([*words, *named[:6]]) == 2
    assert "--joint: are 3, give one for each of 4 wheels" in capsys.readouterr().err
    assert status([*words, *named, "--pose-rotation", "720"]) == 2
    assert "--pose-rotation: is 720" in capsys.readouterr().err
    assert status([*words, *named]) == 0
