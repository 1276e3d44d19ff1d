"""Trajectories written for other tools read back as they were, in both conventions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from conventions import robot_in_ros, ros
from slipmargin_cli.main import status
from strategies import kiwi

import slipmargin as sm
from slipmargin.api.trajectories import TOOLS
from slipmargin.errors import InputError
from slipmargin.io.trajectory_file import read_trajectory

WAY = [[0.0, 0.0, 1.0], [0.6, 0.4, 1.8], [1.2, 0.0, 4.6]]  # the heading passes π


def tool_or_skip(tool: str) -> None:
    if tool == "ros-path":
        pytest.importorskip("rosbags", reason="rosbags is not installed (extra [ros])")


@pytest.mark.parametrize("tool", TOOLS)
@pytest.mark.parametrize("convention", ["paper", "ros"])
def test_a_plan_is_read_back_to_1e_9(tool: str, convention: str, tmp_path: Path) -> None:
    tool_or_skip(tool)
    robot = kiwi() if convention == "paper" else robot_in_ros(kiwi())
    way = np.array(WAY) if convention == "paper" else ros(WAY)
    found = sm.plan(robot, "paper", way, points=60, step_s=0.02)
    sm.export_trajectory(found, tool, tmp_path / "drive")
    read = read_trajectory(tmp_path / "drive", None, robot.convention)
    assert read.notes == ()
    np.testing.assert_allclose(read.t_s, found.trajectory.t_s, atol=1e-9)
    turns = np.round((read.pose[0, 2] - found.trajectory.pose[0, 2]) / (2 * np.pi)) * 2 * np.pi
    np.testing.assert_allclose(read.pose - [0.0, 0.0, turns], found.trajectory.pose, atol=1e-9)


@pytest.mark.parametrize("tool", TOOLS)
def test_both_conventions_write_the_same_motion_of_the_front(tool: str, tmp_path: Path) -> None:
    tool_or_skip(tool)
    one = sm.plan(kiwi(), "paper", WAY, points=60, step_s=0.02)
    rows = np.column_stack([one.trajectory.t_s, one.trajectory.pose])
    two = sm.check(robot_in_ros(kiwi()), "paper", np.column_stack([rows[:, 0], ros(rows[:, 1:])]))
    for name, found in (("one", one), ("two", two)):
        sm.export_trajectory(found, tool, tmp_path / name)
    first, second = (read_trajectory(tmp_path / name).pose for name in ("one", "two"))
    # The floor of ROS's user is turned by −90° against the paper's, and so is the front's heading on it.
    np.testing.assert_allclose(second[:, :2], ros(first[:, :2]), atol=1e-9)
    apart = second[:, 2] - first[:, 2] + 0.5 * np.pi
    np.testing.assert_allclose(np.cos(apart), 1.0, atol=1e-12)


def test_choreo_s_file_has_the_keys_of_its_schema(tmp_path: Path) -> None:
    """TrajectoryFile, Parameters, Waypoint and Sample of Choreo's src-core/src/spec/trajectory.rs."""
    found = sm.plan("ohio-kiwi", "paper", WAY, points=60, step_s=0.02)
    sm.export_trajectory(found, "choreo", tmp_path / "drive.traj")
    file = json.loads((tmp_path / "drive.traj").read_text(encoding="utf-8"))
    assert set(file) == {"name", "version", "snapshot", "params", "trajectory", "events"}
    assert file["name"] == "drive" and file["version"] == 3 and file["events"] == []
    assert set(file["params"]) == {"waypoints", "constraints", "targetDt"}
    waypoint = {
        "x",
        "y",
        "heading",
        "intervals",
        "split",
        "fixTranslation",
        "fixHeading",
        "overrideIntervals",
    }
    assert [set(w) for w in file["params"]["waypoints"]] == [waypoint] * 2
    held = file["trajectory"]
    assert held["sampleType"] == "Swerve" and held["splits"] == [0]
    keys = {"t", "x", "y", "heading", "vx", "vy", "omega", "ax", "ay", "alpha", "fx", "fy"}
    assert all(set(s) == keys and len(s["fx"]) == len(s["fy"]) == 4 for s in held["samples"])
    assert held["waypoints"] == [0.0, pytest.approx(found.duration_s)]


def test_plan_and_simulate_export_and_check_reads(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    way, table = tmp_path / "way.csv", tmp_path / "plan.csv"
    way.write_text("x_m,y_m,phi_rad\n0,0,0\n0.5,0.2,0.3\n", encoding="utf-8")
    drive = tmp_path / "drive.traj"
    words = ["plan", "ohio-kiwi", str(way), "--surface", "paper", "--points", "50", "--out", str(table)]
    assert status([*words, "--export", "choreo", str(drive)]) == 0
    assert f"written: {drive}" in capsys.readouterr().out
    checked = ["ohio-kiwi", str(drive), "--surface", "paper", "--margin", "0.05", "--strict"]
    assert status(["check", *checked]) == 0
    run = tmp_path / "run.json"
    words = ["simulate", "ohio-kiwi", str(table), "--surface", "paper", "--export", "pathplanner", str(run)]
    assert status(words) == 0
    assert read_trajectory(run).form == "PathPlanner"
    capsys.readouterr()
    assert status([*words[:-2], "trajopt", str(run)]) == 2
    assert (
        "--export: is 'trajopt', use one of: choreo, pathplanner, roadrunner, ros-path"
        in capsys.readouterr().err
    )


def test_a_pathplanner_state_at_rest_keeps_its_direction(tmp_path: Path) -> None:
    # The last one turned round, and its acceleration had the sign of a start.
    found = sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [0.3, 0, 0]], points=40)
    sm.export_trajectory(found, "pathplanner", tmp_path / "drive.json")
    states = json.loads((tmp_path / "drive.json").read_text(encoding="utf-8"))
    ways = np.array([s["pose"]["rotation"]["radians"] for s in states])
    assert states[0]["velocity"] == states[-1]["velocity"] == 0.0
    assert np.ptp(np.unwrap(ways)) < 0.01
    assert states[0]["acceleration"] > 0.0 > states[-1]["acceleration"]
    assert states[-1]["acceleration"] == pytest.approx(states[-2]["acceleration"], rel=0.2)


def test_a_bag_is_not_written_over(tmp_path: Path) -> None:
    tool_or_skip("ros-path")
    found = sm.plan("ohio-kiwi", "paper", [[0, 0, 0], [0.3, 0, 0]], points=40)
    sm.export_trajectory(found, "ros-path", tmp_path / "bag")
    with pytest.raises(InputError, match="is there already"):
        sm.export_trajectory(found, "ros-path", tmp_path / "bag")
    assert [p.name for p in tmp_path.iterdir()] == ["bag"]


OWN = Path(__file__).parents[2] / "data" / "trajectories"


@pytest.mark.parametrize(
    ("name", "count", "last"),
    [
        ("choreo-2025-own.traj", 6, (0.4352086605933893, 3.7245938005671024, 5.5799710196029215)),
        ("choreo-2024-own.traj", 6, (0.5007201674678906, 2.664790521147084, 6.648164727950773)),
        (
            "pathplanner-2023-own.wpilib.json",
            7,
            (0.21612934184959515, 1.0700678375430142, 3.0000105632535288),
        ),
    ],
)
def test_files_that_the_tools_wrote_are_read(name: str, count: int, last: tuple[float, float, float]) -> None:
    """First samples of files in the tools' own and in teams' repositories; sources beside them."""
    found = read_trajectory(OWN / name)
    assert len(found.t_s) == count
    # Choreo's version 2 moved the pose by the velocity of a step's end: 1.09 m/s in the mean of the first.
    contradicts = [note for note in found.notes if "the stated velocity contradicts the samples" in note]
    assert len(found.notes) == len(contradicts) == (name == "choreo-2025-own.traj")
    assert (float(found.t_s[-1]), *found.pose[-1, :2].tolist()) == last
    assert np.abs(np.diff(found.pose[:, 2])).max() < 0.01  # 180° and -179.99° follow each other


def shape_of(value: object) -> object:
    """Keys of objects and kinds of values, of lists that of the first element."""
    if isinstance(value, dict):
        return {key: shape_of(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [shape_of(value[0])] if value else []
    return (
        "number" if isinstance(value, int | float) and not isinstance(value, bool) else type(value).__name__
    )


def test_exports_have_the_form_of_the_tools_own_files(tmp_path: Path) -> None:
    found = sm.plan("ohio-kiwi", "paper", WAY, points=60, step_s=0.02)
    for tool, own in (
        ("pathplanner", "pathplanner-2023-own.wpilib.json"),
        ("choreo", "choreo-2025-own.traj"),
    ):
        sm.export_trajectory(found, tool, tmp_path / tool)
        ours, theirs = (
            shape_of(json.loads(f.read_text(encoding="utf-8"))) for f in (tmp_path / tool, OWN / own)
        )
        if tool == "choreo":
            assert isinstance(ours, dict) and isinstance(theirs, dict)
            # Version 3 dropped two keys of version 2; what a plan has no use for is empty or null.
            del theirs["pplib_commands"], theirs["trajectory"]["forcesAvailable"]
            for part in ("snapshot", "events"):
                del ours[part], theirs[part]
            for held in (ours, theirs):
                del held["params"]["constraints"], held["trajectory"]["splits"]
        assert ours == theirs, tool


def test_a_road_runner_log_has_the_fields_of_its_class(tmp_path: Path) -> None:
    """The public fields of LogFiles.LogFile that a follower fills (quickstart, version "quickstart1 v2")."""
    found = sm.plan("ohio-kiwi", "paper", WAY, points=60, step_s=0.02)
    sm.export_trajectory(found, "roadrunner", tmp_path / "drive.json")
    table = json.loads((tmp_path / "drive.json").read_text(encoding="utf-8"))
    filled = {"nsTimes", "targetXs", "targetYs", "targetHeadings", "xs", "ys", "headings"}
    empty = {f"{kind}Enc{what}" for kind in ("drive", "tracking") for what in ("Positions", "Vels")}
    head = {"version", "opModeName", "msInit", "nsInit", "nsStart", "nsStop"}
    assert set(table) == filled | empty | head | {"voltages"}
    assert table["version"] == "quickstart1 v2" and len({len(table[key]) for key in filled}) == 1
    assert table["targetXs"][-1] * 0.0254 == pytest.approx(1.2) and all(
        isinstance(t, int) for t in table["nsTimes"]
    )


def test_our_own_table_is_read_back_to_1e_9(tmp_path: Path) -> None:
    found = sm.plan("ohio-kiwi", "paper", WAY, points=60, step_s=0.02)
    found.write_files(table=tmp_path / "plan.csv")
    read = read_trajectory(tmp_path / "plan.csv")
    np.testing.assert_allclose(read.t_s, found.trajectory.t_s, atol=1e-9)
    np.testing.assert_allclose(read.pose, found.trajectory.pose, atol=1e-9)
