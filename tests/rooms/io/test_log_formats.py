"""One run in the logs of WPILib, AdvantageScope, Road Runner and LeRobot is read as it was."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import foreign_logs as logs
import numpy as np
import pytest
from conventions import robot_in_ros
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.data_set import read_data_set
from slipmargin.robot import Robot

RUN = logs.run()


def rover(paper: bool = False) -> Robot:
    """The run's robot, or the same machine as a user of the paper's axes describes it."""
    robot = sm.new_robot("rover", "mecanum").recipe.robot
    if not paper:
        return robot
    there = sm.read_robot("mecanum4").robot
    names = {"front-left": "fl", "front-right": "fr", "rear-left": "rl", "rear-right": "rr"}
    wheels = tuple(replace(w, name=names.get(w.name, w.name), radius_m=logs.RADIUS_M) for w in there.wheels)
    return replace(there, wheels=wheels)


def one(file: Path, format: str, robot: Robot, **options: object) -> Record:
    (record,) = sm.import_logs([file], format, robot, **options).data_set.trials
    return record


def same_run(record: Record, held: logs.Run = RUN, front: float = 0.0, sign: float = 1.0) -> None:
    """The record is the run, its heading turned by the front's direction and its wheels by a sign."""
    np.testing.assert_allclose(record.t_s, held.t_s, atol=1e-6)
    np.testing.assert_allclose(record.pose[:, :2], held.pose[:, :2], atol=1e-9)
    turns = np.round((record.pose[0, 2] - held.pose[0, 2]) / (2.0 * math.pi)) * 2.0 * math.pi
    np.testing.assert_allclose(record.pose[:, 2] - turns, held.pose[:, 2] - front, atol=1e-9)
    if record.theta is not None:
        np.testing.assert_allclose(record.theta, sign * held.theta, atol=1e-9)
    if record.omega is not None:
        np.testing.assert_allclose(record.omega, sign * held.omega, atol=1e-6)


def frc() -> None:
    pytest.importorskip("wpiutil", reason="robotpy-wpiutil is not installed (extra [frc])")


@pytest.mark.parametrize("wheels", ["positions", "speeds"])
def test_a_wpilog(wheels: str, tmp_path: Path) -> None:
    frc()
    found = sm.import_logs([logs.wpilog(tmp_path / "run.wpilog", RUN, wheels=wheels)], "wpilog", rover())
    (record,) = found.data_set.trials
    same_run(record)
    assert (record.theta is None) == (wheels == "speeds")
    told = "\n".join(found.lines())
    assert "/Vision/Pose is taken as the pose" in told and "/Drive/Wheels (mecanum wheel" in told


def test_a_wpilog_with_a_number_for_each_wheel(tmp_path: Path) -> None:
    frc()
    file = logs.wpilog(tmp_path / "run.wpilog", RUN, wheels="numbers")
    with pytest.raises(InputError, match=r"no channel is clearly wheels.*/Drive/front_left"):
        one(file, "wpilog", rover())
    words = [f"/Drive/{c}:rpm" for c in logs.CORNERS]
    same_run(one(file, "wpilog", rover(), wheels=words, pose="/Vision/Pose"))
    words[1] = "-" + words[1]
    record = one(file, "wpilog", rover(), wheels=words)
    assert record.omega is not None and record.omega[3, 1] < 0.0 < record.omega[3, 0]


def test_a_wpilog_that_holds_its_value_while_the_robot_stands(tmp_path: Path) -> None:
    frc()
    held = logs.run(still=10)
    record = one(logs.wpilog(tmp_path / "run.wpilog", held, wheels="positions"), "wpilog", rover())
    for column, values in ((record.pose[:, 0], held.pose[:, 0]), (record.theta, held.theta)):
        assert column is not None
        there = np.interp(record.t_s, held.t_s, values if values.ndim == 1 else values[:, 0])
        np.testing.assert_allclose(column if column.ndim == 1 else column[:, 0], there, atol=1e-9)
    assert len(record.t_s) < len(held.t_s)  # what did not change was not logged


@pytest.mark.parametrize("table", [True, False])
def test_an_export_of_advantagescope(table: bool, tmp_path: Path) -> None:
    same_run(one(logs.advantagescope(tmp_path / "run.csv", RUN, table=table), "advantagescope", rover()))


@pytest.mark.parametrize(("unit", "per"), [("m/s", logs.RADIUS_M), ("rad/s", 1.0), ("rpm", 30.0 / math.pi)])
def test_the_wheels_of_a_mecanum_drive_in_the_unit_that_is_said(
    unit: str, per: float, tmp_path: Path
) -> None:
    """A channel that is speeds by its name was read in m/s whatever was said: in rad/s 20 times too fast."""
    held = replace(RUN, omega=RUN.omega * per / logs.RADIUS_M)
    file = logs.advantagescope(tmp_path / "run.csv", held)
    same_run(one(file, "advantagescope", rover(), wheels=[f"/Drive/WheelSpeeds:{unit}"]))


def test_a_unit_that_a_channel_cannot_have_is_refused(tmp_path: Path) -> None:
    file = logs.advantagescope(tmp_path / "run.csv", RUN)
    with pytest.raises(InputError, match=r"--wheel: has the unit 'furlong', use one of: rad, .*, or m, m/s"):
        one(file, "advantagescope", rover(), wheels=["/Drive/WheelSpeeds:furlong"])
    with pytest.raises(InputError, match="is a pose, whose heading is in rad, leave :deg out"):
        one(file, "advantagescope", rover(), pose="/Vision/Pose:deg")
    same_run(one(file, "advantagescope", rover(), pose="/Vision/Pose:rad"))


def test_a_log_of_road_runner(tmp_path: Path) -> None:
    file = logs.roadrunner(tmp_path / "run.json", RUN)
    same_run(one(file, "roadrunner", rover()))
    metres = one(file, "roadrunner", rover(), length_unit="m")
    np.testing.assert_allclose(metres.pose[:, 0], RUN.pose[:, 0] / 0.0254, rtol=1e-12)


def test_a_data_set_of_lerobot(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed (extra [lerobot])")
    folder = logs.lerobot(tmp_path / "kiwi", RUN)
    tracker = logs.tracker(tmp_path / "tracker.csv", RUN)
    options = {"time": "stamp", "x": "px:mm", "y": "py:mm", "heading": "yaw:deg", "tracker_start_s": 100.0}
    robot = sm.new_robot("kiwi", "lekiwi").recipe.robot
    record = one(folder, "lerobot", robot, tracker=[tracker], **options)
    np.testing.assert_allclose(record.pose, RUN.pose, atol=1e-8)
    assert record.omega is not None
    np.testing.assert_allclose(record.omega, RUN.omega[:, :3], atol=1e-6)
    turned = replace(robot, wheels=tuple(robot.wheels[i] for i in (2, 0, 1)))
    again = one(folder, "lerobot", turned, tracker=[tracker], **options)
    assert again.omega is not None
    np.testing.assert_allclose(again.omega, RUN.omega[:, [2, 0, 1]], atol=1e-6)
    file = folder / "data" / "chunk-000" / "episode_000000.parquet"
    assert len(one(file, "lerobot", robot, tracker=[tracker], **options).t_s) == len(RUN.t_s)
    with pytest.raises(InputError, match="say with --tracker-start"):
        one(folder, "lerobot", robot, tracker=[tracker], **{**options, "tracker_start_s": 0.0})
    with pytest.raises(InputError, match="wheels alone show no slip"):
        one(folder, "lerobot", robot)
    with pytest.raises(InputError, match="give LeKiwi's robot file"):
        one(folder, "lerobot", sm.new_robot("x", "xdrive").recipe.robot, tracker=[tracker], **options)


def test_an_episode_is_picked(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed (extra [lerobot])")
    folder = logs.lerobot(tmp_path / "kiwi", RUN, episodes=2)
    tracker = logs.tracker(tmp_path / "tracker.csv", RUN)
    file, out = tmp_path / "kiwi.toml", tmp_path / "set"
    file.write_text(sm.new_robot("kiwi", "lekiwi").text, encoding="utf-8")
    words = [
        "import",
        "lerobot",
        str(folder),
        "--robot",
        str(file),
        "--out",
        str(out),
        "--tracker",
        str(tracker),
    ]
    words += [
        "--time",
        "stamp",
        "--x",
        "px:mm",
        "--y",
        "py:mm",
        "--heading",
        "yaw:deg",
        "--tracker-start",
        "100",
    ]
    assert status(words) == 2
    assert status([*words, "--episode", "1"]) == 0
    assert read_data_set(out).trials[0].name == "kiwi_episode1"


@pytest.mark.parametrize("format", ["wpilog", "advantagescope", "roadrunner"])
def test_the_same_log_for_a_robot_file_in_the_paper_s_convention(format: str, tmp_path: Path) -> None:
    """Its front is +Y, and a positive wheel speed moves the contact along the drive direction."""
    if format == "wpilog":
        frc()
    file = getattr(logs, format)(tmp_path / "run", RUN)
    robot = rover(paper=True)
    ahead = [math.sin(math.radians(w.drive_direction_deg)) for w in robot.wheels]
    assert np.ptp(ahead) == 0.0
    names = [w.name for w in robot.wheels]
    order = [names.index(n) for n in ("fl", "fr", "rl", "rr")]
    record = one(file, format, robot)
    signals = {
        f: None if getattr(record, f) is None else getattr(record, f)[:, order] for f in ("theta", "omega")
    }
    same_run(replace(record, **signals), front=0.5 * math.pi, sign=-np.sign(ahead[0]))
    same_run(replace(one(file, format, robot_in_ros(robot)), **signals), sign=-np.sign(ahead[0]))


@pytest.mark.parametrize("format", ["wpilog", "advantagescope"])
def test_swerve_is_refused(format: str, tmp_path: Path) -> None:
    if format == "wpilog":
        frc()
    file = getattr(logs, format)(tmp_path / "run", RUN, swerve=True)
    with pytest.raises(InputError, match="swerve modules, slipmargin is for omni and mecanum wheels"):
        one(file, format, rover())


def test_other_robots_and_twice_the_same_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = logs.roadrunner(tmp_path / "run.json", RUN)
    with pytest.raises(InputError, match="name the robot file's four wheels fl, fr, rl and rr"):
        one(file, "roadrunner", sm.read_robot("ohio-kiwi").robot)
    robot, out = tmp_path / "rover.toml", tmp_path / "set"
    robot.write_text(sm.new_robot("rover", "mecanum").text, encoding="utf-8")
    copy = tmp_path / "copy.json"
    copy.write_text(file.read_text(encoding="utf-8"), encoding="utf-8")
    words = ["import", "roadrunner", str(file), str(copy), "--robot", str(robot), "--out", str(out)]
    assert status(words) == 0
    assert f"is the same log as {file}" in capsys.readouterr().out
    assert len(read_data_set(out).trials) == 1
    assert status(words) == 2
    assert "replace it with --force" in capsys.readouterr().err
    assert status([*words, "--force"]) == 0


def test_a_csv_without_a_header_by_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [
        f"{t:.3f};{x};{y};{h};" + ";".join(map(str, w))
        for t, (x, y, h), w in zip(RUN.t_s, RUN.pose, RUN.theta, strict=True)
    ]
    file, robot, out = tmp_path / "run.csv", tmp_path / "rover.toml", tmp_path / "set"
    file.write_text("\n".join(rows), encoding="utf-8")
    robot.write_text(sm.new_robot("rover", "mecanum").text, encoding="utf-8")
    words = ["import", "csv", str(file), "--robot", str(robot), "--out", str(out)]
    wheels = [w for name in "abcd" for w in ("--wheel", f"{name}:rad")]
    named = [*words, "--time", "t", "--x", "x", "--y", "y", "--heading", "h", *wheels]
    assert status(named) == 2
    assert "the first line is 8 numbers, so there is no header" in capsys.readouterr().err
    numbers = ["--time", "#1", "--x", "#2", "--y", "#3", "--heading", "#4"]
    wheels = [w for k in range(5, 9) for w in ("--wheel", f"#{k}:rad")]
    assert status([*words, *numbers, *wheels[:-1], "#9:rad"]) == 2
    assert "has 8 columns, so there is no #9" in capsys.readouterr().err
    assert status([*words, *numbers, *wheels]) == 0
    (trial,) = read_data_set(out).trials
    assert len(trial.t_s) == len(RUN.t_s)
    np.testing.assert_allclose(trial.theta, RUN.theta, atol=1e-9)
