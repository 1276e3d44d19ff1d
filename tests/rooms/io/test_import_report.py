"""What an import says of the rows adds up: those of the file, those kept, and each one left out with why."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import foreign_logs as logs
import numpy as np
import pytest

import slipmargin as sm
from slipmargin.checks import Array
from slipmargin.io.importers.channels import Channel, Kind, Wanted, reading
from slipmargin.io.importers.plug import Reading, Summary

ROVER = sm.new_robot("rover", "mecanum").recipe.robot


def of_channels(t: Array, poses: Array, wheels: Array) -> Reading:
    channels = {
        "/Pose": Channel(kind=Kind.POSE, t_s=t, values=poses),
        "/Wheels": Channel(kind=Kind.SPEEDS, t_s=t, values=wheels),
    }
    return reading(Path("run.wpilog"), channels, Wanted(robot=ROVER))


def head(read: Reading) -> str:
    return Summary(format="x", readings=(read,)).lines()[0]


def test_poses_that_were_filled_in_are_no_rows_of_the_file() -> None:
    """More rows were kept than the file has, and a negative number was dropped."""
    t = np.repeat(np.arange(10.0), 5) + np.tile(0.1 * np.arange(5), 10)
    poses, wheels = np.outer(t, [0.1, 0.0, 0.1]), np.ones((50, 4))
    read = of_channels(t, poses, wheels)
    assert len(read.record.t_s) == 59 and (read.rows, read.kept) == (50, 50) and not read.dropped
    assert "50 rows, 50 kept, 0 dropped" in head(read)
    assert "/Pose holds from change to change: of 50 poses come 59 rows of the run" in read.notes
    assert Summary(format="x", readings=(read,)).as_json()["runs"][0]["kept"] == 50  # type: ignore[index]


def test_poses_that_repeat_or_are_none_are_told_apart() -> None:
    """Repeats were dropped without a reason, and a pose that is not finite without an entry."""
    t = 0.02 * np.arange(50)
    poses, wheels = np.outer(t, [0.1, 0.0, 0.1]), np.ones((50, 4))
    poses[48] = poses[47]
    poses[20:22, 1] = np.nan
    t[30] = 0.0
    wheels[7] = np.nan
    read = of_channels(t, poses, wheels)
    assert [(d.line, d.count, d.why) for d in read.dropped] == [
        (21, 2, "its pose is not finite"),
        (31, 1, "its stamp does not come after the one before"),
    ]
    assert "50 rows, 47 kept, 3 dropped" in head(read)
    assert any(note.startswith("/Pose holds from change to change: of 47 poses") for note in read.notes)
    assert "/Wheels: 2 of 50 samples left out, out of order, not finite or of another length" in read.notes


def test_a_reading_without_a_change_says_none() -> None:
    t = 0.02 * np.arange(50)
    read = of_channels(t, np.outer(t, [0.1, 0.0, 0.1]), np.ones((50, 4)))
    assert len(read.notes) == 2 and all("by its type" in note for note in read.notes)


def test_an_array_of_another_length_is_told(tmp_path: Path) -> None:
    """It was left out in silence; where it came first, all others were."""
    from wpiutil import DataLogWriter

    log = DataLogWriter(str(tmp_path / "run.wpilog"))
    pose, wheels = log.start("/Pose", "struct:Pose2d", "", 0), log.start("/Wheels", "double[]", "", 0)
    for k in range(50):
        log.appendRaw(pose, struct.pack("<3d", 0.01 * k, 0.0, 0.0), 20_000 * (k + 1))
        row = [float(k)] * (3 if k in (0, 7) else 4)
        log.appendRaw(wheels, struct.pack(f"<{len(row)}d", *row), 20_000 * (k + 1))
    log.flush()
    log.stop()
    found = sm.import_logs([tmp_path / "run.wpilog"], "wpilog", ROVER, wheels=["/Wheels:rad/s"])
    (read,) = found.read.readings
    assert "/Wheels: 2 of 50 samples left out, out of order, not finite or of another length" in read.notes


def test_lines_of_an_export_that_cannot_be_read_are_told(tmp_path: Path) -> None:
    file = logs.advantagescope(tmp_path / "run.csv", logs.run())
    lines = file.read_text(encoding="utf-8").split("\n")
    lines[7] = lines[7].replace(",", ";", 1)
    file.write_text("\n".join(lines), encoding="utf-8")
    (read,) = sm.import_logs([file], "advantagescope", ROVER).read.readings
    assert "1 line cannot be read, the first is line 8" in read.notes


def test_rows_of_a_tracker_and_frames_of_lerobot_that_are_left_out(tmp_path: Path) -> None:
    """The tracker's bad rows, and the frames whose time stands still, vanished."""
    pytest.importorskip("pyarrow", reason="pyarrow is not installed (extra [lerobot])")
    run = logs.run()
    t = run.t_s.copy()
    t[5] = t[4]
    folder = logs.lerobot(tmp_path / "kiwi", replace(run, t_s=t))
    file = logs.tracker(tmp_path / "tracker.csv", run)
    lines = file.read_text(encoding="utf-8").replace(",", ";").split("\n")
    lines[7] = lines[7].replace(";", ";x", 1)
    lines[9] = ";".join([*lines[9].split(";")[:3], ""])
    lines[3:3] = [lines[3].replace("100", "99", 1)]  # its time lies before the episode
    file.write_text("\n".join(lines), encoding="utf-8")
    named = {"time": "stamp", "x": "px:mm", "y": "py:mm", "heading": "yaw:deg", "tracker_start_s": 100.0}
    robot = sm.new_robot("kiwi", "lekiwi").recipe.robot
    (read,) = sm.import_logs([folder], "lerobot", robot, tracker=[file], **named).read.readings
    assert [(d.line, d.count) for d in read.dropped] == [(4, 1), (9, 1)]
    assert read.rows == 42 and read.kept == len(read.record.t_s) == 40 and read.lost_frames == 1
    told = "\n".join(read.notes)
    assert "rows counted here are the tracker's" in told
    assert "the tracker's file: cells are separated by ';' instead of ','" in told
    assert "1 of 41 frames left out, their times do not increase" in told


def test_parts_of_a_recording_that_make_no_run_are_told(tmp_path: Path) -> None:
    """They were left out, and every row was said to be kept."""
    t = 0.02 * np.arange(300)
    turned = 3.0 * np.clip(t - 2.0, 0.0, 1.5)
    rows = [
        f"{a:.2f},{0.1 * b:.6f},0,{0.2 * b:.6f},{b:.6f},{-b:.6f},{b:.6f}"
        for a, b in zip(t, turned, strict=True)
    ]
    file = tmp_path / "long.csv"
    file.write_text("\n".join(["t,x,y,h,a,b,c", *rows]), encoding="utf-8")
    named = {"time": "t", "x": "x", "y": "y", "heading": "h", "wheels": ["a:rad", "b:rad", "c:rad"]}
    found = sm.import_logs([file], "csv", "ohio-kiwi", segment_s=0.8, **named)
    assert [trial.name for trial in found.data_set.trials] == ["long_002", "long_003", "long_004"]
    lines = found.lines()
    assert f"{file}: 4 parts of 0.8 s left out, no wheel moves: from 0, 0.8, 4, 4.8 s" in lines
    assert f"{file}: 1 part of 0.8 s left out, shorter than 0.5 of that: from 5.6 s" in lines
