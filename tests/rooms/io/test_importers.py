"""Robotino logs: signs and units by hand, every kind of damage named and nothing good lost."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from real_logs import EXCERPT, WHOLE, logs, needs_whole

import slipmargin as sm
from slipmargin.checks import Array
from slipmargin.data.odometry import wheel_path
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.importers.loose_table import increasing, read_loose
from slipmargin.io.importers.plug import import_files
from slipmargin.io.importers.robotino import RobotinoImporter
from slipmargin.io.importers.smooth import smooth_angles
from slipmargin.io.importers.units import factor
from slipmargin.io.robot_file import read_recipe
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import rotate_rows
from slipmargin.robot import Robot
from slipmargin.robot.turned import robot_in

SSL = EXCERPT.parent / "robojackets_excerpt" / "enc_vis_excerpt.txt"
LOG = EXCERPT / "gray_0.1" / "heading_155.csv"
READ = RobotinoImporter().read


def damaged(tmp_path: Path, change: object) -> Path:
    """A copy of the log with its lines changed by ``change``."""
    lines = LOG.read_text(encoding="utf-8").split("\n")
    path = tmp_path / "damaged.csv"
    path.write_text("\n".join(change(lines)), encoding="utf-8")  # type: ignore[operator]
    return path


def test_signs_and_units_by_hand(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    names = "t;m1setvel;m2setvel;m3setvel;m1pos;m2pos;m3pos;m1cur;m2cur;m3cur;xpos;ypos;ang;"
    units = "ms;rad/s;rad/s;rad/s;ticks;ticks;ticks;A;A;A;pix;pix;deg;"
    path.write_text(
        "\n".join(
            [
                "long;" * 13,
                units,
                names,
                "0;16;0;-16;0;0;0;1;2;3;100;200;359;",
                "500;16;0;-16;16000;0;-32000;1;2;3;110;190;361;",
                "",
            ]
        ),
        encoding="utf-8",
    )
    record = READ(path).record
    np.testing.assert_allclose(record.t_s, [0.0, 0.5])
    assert record.theta is not None and record.omega_cmd is not None and record.current is not None
    # A motor counts up where its wheel carries the robot counter-clockwise, the built-in file's θ clockwise.
    np.testing.assert_allclose(record.theta[1], [-math.pi, 0.0, 2.0 * math.pi])
    np.testing.assert_allclose(record.omega_cmd[0], [-1.0, 0.0, 1.0])
    np.testing.assert_allclose(record.current[0], [1.0, 2.0, 3.0])
    # Image y points down; the front's heading, φ of this file, is a + 90°, unwrapped.
    np.testing.assert_allclose(record.pose[1, :2] - record.pose[0, :2], [10 * 1.8405e-3, 10 * 1.8372e-3])
    np.testing.assert_allclose(record.pose[:, 2], np.deg2rad([449.0, 451.0]))


@needs_whole
def test_body_increments_agree_with_the_makers_own() -> None:
    # Birth certificate: columns dx, dy [mm] of the log, computed by its authors between their samples (of
    # which some are not in the log), in the body frame of the later one.
    path = WHOLE / "gray_0.1" / "heading_045.csv"
    table = read_loose(path, ("t", "dx", "dy"), ";")
    pose = READ(path).record.pose
    step, phi = np.diff(pose[:, :2], axis=0), pose[1:, 2]
    mine = 1000.0 * np.stack(
        [
            np.cos(phi) * step[:, 0] + np.sin(phi) * step[:, 1],
            -np.sin(phi) * step[:, 0] + np.cos(phi) * step[:, 1],
        ],
        axis=1,
    )
    theirs = np.stack([table["dx"], table["dy"]], axis=1)[1:]
    off = np.abs(mine - theirs)[np.isfinite(mine).all(axis=1)].max(axis=1)
    assert np.mean(off < 0.005) > 0.98


def test_wheels_and_camera_turn_and_go_the_same_way() -> None:
    from slipmargin.data.odometry import body_path, wheel_path
    from slipmargin.io.robot_file import read_recipe

    contacts = read_recipe("robotino").build("gray").geometry
    for path in logs(EXCERPT / "table_0.1"):
        record = READ(path).record
        assert record.theta is not None
        wheels, camera = wheel_path(contacts, record.theta)[-1], body_path(record.pose)[-1]
        ratio = complex(*camera[:2]) / complex(*wheels[:2])
        assert 0.85 < abs(ratio) < 0.95 and abs(math.atan2(ratio.imag, ratio.real)) < 0.06
        heading = math.radians(int(path.stem.split("_")[1]))
        assert abs(np.angle(complex(*camera[:2]) * np.exp(-1j * heading))) < 0.12


def test_a_whole_log_is_read_whole() -> None:
    reading = READ(LOG)
    rows = len(LOG.read_text(encoding="utf-8").split("\n")) - 4
    assert reading.rows == rows == len(reading.record.t_s)
    assert not reading.dropped and not reading.notes
    assert dict(reading.facts)["ticks_per_turn_by_logged_speed"] == pytest.approx(1978, rel=0.02)


def test_cut_in_the_middle_of_a_row(tmp_path: Path) -> None:
    text = LOG.read_text(encoding="utf-8")
    for cut, told in ((60, "cut ("), (len("1;"), "closing separator")):
        path = tmp_path / "cut.csv"
        path.write_text(text.rstrip("\n")[:-cut], encoding="utf-8")
        reading = READ(path)
        assert reading.rows - len(reading.record.t_s) == 1 == len(reading.dropped)
        assert told in reading.dropped[0].why
        assert reading.dropped[0].line == len(text.split("\n")) - 1


def test_cut_inside_the_file(tmp_path: Path) -> None:
    reading = READ(damaged(tmp_path, lambda ls: [*ls[:50], ls[50][:40], *ls[51:]]))
    assert [(d.line, d.count) for d in reading.dropped] == [(51, 1)]
    assert len(reading.record.t_s) == reading.rows - 1


@pytest.mark.parametrize("mark", [",", "\t", "|"])
def test_wrong_separator_everywhere(tmp_path: Path, mark: str) -> None:
    reading = READ(damaged(tmp_path, lambda ls: [line.replace(";", mark) for line in ls]))
    assert len(reading.record.t_s) == reading.rows == READ(LOG).rows
    assert repr(mark) in reading.notes[0]
    np.testing.assert_array_equal(reading.record.pose, READ(LOG).record.pose)


def test_wrong_separator_in_some_rows_and_decimal_commas(tmp_path: Path) -> None:
    reading = READ(damaged(tmp_path, lambda ls: [*ls[:20], ls[20].replace(";", ","), *ls[21:]]))
    assert len(reading.record.t_s) == reading.rows and "separated otherwise" in reading.notes[0]
    reading = READ(damaged(tmp_path, lambda ls: [*ls[:3], *(line.replace(".", ",") for line in ls[3:])]))
    assert "decimal comma" in reading.notes[0]
    np.testing.assert_array_equal(reading.record.pose, READ(LOG).record.pose)


def test_lost_marker(tmp_path: Path) -> None:
    def lose(lines: list[str]) -> list[str]:
        out = list(lines)
        for k, cells in ((60, ("", "", "")), (61, ("nan", "nan", "nan")), (62, ("0", "0", "0"))):
            row = out[k].split(";")
            row[19:22] = cells
            out[k] = ";".join(row)
        return out

    reading = READ(damaged(tmp_path, lose))
    assert len(reading.record.t_s) == reading.rows and reading.lost_frames == READ(LOG).lost_frames + 3
    assert not reading.record.seen[57:60].any()
    assert reading.record.theta is not None and np.isfinite(reading.record.theta).all()  # wheels are kept


def test_a_repeated_camera_frame_is_no_new_pose(tmp_path: Path) -> None:
    def repeat(lines: list[str]) -> list[str]:
        out = list(lines)
        row, before = out[70].split(";"), out[69].split(";")
        row[19:22] = before[19:22]
        out[70] = ";".join(row)
        return out

    assert READ(damaged(tmp_path, repeat)).lost_frames == READ(LOG).lost_frames + 1


def test_reversed_time(tmp_path: Path) -> None:
    whole = READ(LOG)
    reading = READ(damaged(tmp_path, lambda ls: [*ls[:3], *ls[:2:-1]]))
    assert "reverse order" in reading.notes[0]
    np.testing.assert_array_equal(reading.record.t_s, whole.record.t_s)
    one = READ(damaged(tmp_path, lambda ls: [*ls[:30], ls[31], ls[30], *ls[32:]]))  # two rows swapped
    assert [d.count for d in one.dropped] == [1] and "does not come after" in one.dropped[0].why
    wild = READ(damaged(tmp_path, lambda ls: [*ls[:30], "9e9" + ls[30][ls[30].index(";") :], *ls[31:]]))
    assert [(d.line, d.count) for d in wild.dropped] == [(31, 1)]  # one wild stamp costs one row


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda ls: ls[3:], "no line names the columns"),
        (lambda ls: [*ls[:2], ls[2].replace("xpos", "xpoz"), *ls[3:]], "3:1: the column 'xpos' is missing"),
        (lambda ls: [*ls[:3], *(line[:30] for line in ls[3:])], "no row that can be read"),
        (lambda ls: ls[:4], "only one row"),
        (lambda ls: ["", ls[1].replace("ms", "fortnight"), *ls[2:]], "t: has the unit 'fortnight'"),
        (lambda ls: [""], "no line names the columns"),
    ],
)
def test_what_cannot_be_read_is_refused_in_one_line(tmp_path: Path, change: object, told: str) -> None:
    with pytest.raises(InputError) as refusal:
        import_files(RobotinoImporter(), [damaged(tmp_path, change)])
    assert told in str(refusal.value) and "damaged.csv" in str(refusal.value)


def test_a_run_without_the_marker_is_refused(tmp_path: Path) -> None:
    def blind(lines: list[str]) -> list[str]:
        return [
            *lines[:3],
            *(";".join([*line.split(";")[:19], "", "", "", "0", "0", "0", ""]) for line in lines[3:] if line),
        ]

    with pytest.raises(InputError, match="no row holds the marker"):
        READ(damaged(tmp_path, blind))


def test_one_bad_file_does_not_cost_the_others(tmp_path: Path) -> None:
    (tmp_path / "notes.csv").write_text("not a log\n", encoding="utf-8")
    summary = import_files(RobotinoImporter(), [LOG, tmp_path / "notes.csv", tmp_path / "gone.csv"])
    assert len(summary.records) == 1 and len(summary.refused) == 2
    text = "\n".join(summary.lines())
    assert "notes.csv: not used" in text and "there is no such file" in text
    assert summary.as_json()["refused"]
    with pytest.raises(InputError, match="no log is given"):
        import_files(RobotinoImporter(), [])


def test_logs_of_one_name_do_not_hide_each_other() -> None:
    twice = [EXCERPT / "gray_0.1" / "heading_005.csv", EXCERPT / "table_0.1" / "heading_005.csv"]
    names = [r.name for r in import_files(RobotinoImporter(), twice).records]
    assert names == ["gray_0.1_heading_005", "table_0.1_heading_005"]


def test_the_same_log_twice_is_used_once(tmp_path: Path) -> None:
    log = EXCERPT / "gray_0.1" / "heading_005.csv"
    copy = tmp_path / "another-name.csv"
    copy.write_bytes(log.read_bytes())
    found = import_files(RobotinoImporter(), [log, copy])
    assert len(found.records) == 1
    assert found.lines()[-1].startswith(f"{copy}: not used") and f"same log as {log}" in found.lines()[-1]


def test_smoothing_takes_the_tremble_and_leaves_the_motion() -> None:
    # A wheel that speeds up evenly, read with stamps that are up to 16 ms too late.
    random = np.random.default_rng(3)
    t = np.cumsum(random.uniform(0.029, 0.033, 400))

    def true(at: np.ndarray) -> np.ndarray:
        return np.stack([2.0 * at + 0.3 * at**2, -1.0 * at], axis=1)

    raw = true(t - random.choice([0.0, 0.016], len(t)))
    late = true(t - 0.008)
    angle, speed = smooth_angles(t, raw, 0.2)
    # The mean of n samples trembles by 1/√n as much; a parabola through a dozen is worth about four.
    assert np.std(angle - late, axis=0) == pytest.approx(np.std(raw - late, axis=0) / 2.0, rel=0.1)
    jerks = np.diff(raw[:, 1]) / np.diff(t)
    assert np.std(jerks) > 6.0 * np.std(speed[:, 1])
    exact, slope = smooth_angles(t, true(t), 0.2)  # a parabola is left as it is
    np.testing.assert_allclose(exact, true(t), atol=1e-9)
    np.testing.assert_allclose(slope[:, 0], 2.0 + 0.6 * t, atol=1e-8)
    alone, steep = smooth_angles(np.array([0.0, 9.0, 20.0]), np.array([[0.0], [9.0], [20.0]]), 0.2)
    np.testing.assert_allclose((alone[:, 0], steep[:, 0]), ([0.0, 9.0, 20.0], [1.0, 1.0, 1.0]))


def test_constants_are_checked() -> None:
    with pytest.raises(InputError, match="ticks_per_turn"):
        RobotinoImporter(ticks_per_turn=0.0)
    with pytest.raises(InputError, match="smooth_s"):
        RobotinoImporter(smooth_s=-1.0)
    with pytest.raises(InputError, match="'parsec'"):
        factor("x", "length", "parsec")


@settings(max_examples=60, deadline=None)
@given(st.lists(st.one_of(st.floats(-5, 5), st.just(float("nan"))), min_size=1, max_size=40))
def test_increasing_keeps_the_most_it_can(values: list[float]) -> None:
    t = np.array(values)
    keep, notes = increasing(t)
    assert notes or np.all(np.diff(keep) > 0)
    assert np.all(np.diff(t[keep]) > 0)
    if not notes:  # second road: dynamic programming in O(n²)
        best = [0] * len(t)
        for i in range(len(t)):
            if math.isfinite(t[i]):
                earlier = [best[j] for j in range(i) if math.isfinite(t[j]) and t[j] < t[i]]
                best[i] = 1 + max(earlier, default=0)
        assert len(keep) == max(best)


@settings(max_examples=60, deadline=None)
@given(st.binary(max_size=300))
def test_no_bytes_crash_the_reader(tmp_path_factory: pytest.TempPathFactory, junk: bytes) -> None:
    lines = LOG.read_bytes().split(b"\n")
    path = tmp_path_factory.mktemp("junk") / "x.csv"
    path.write_bytes(b"\n".join([*lines[:20], junk, *lines[20:24]]))
    reading = READ(path)
    assert reading.rows - sum(d.count for d in reading.dropped) == len(reading.record.t_s)
    assert len(reading.record.t_s) >= 21  # every good row is there


@needs_whole
def test_the_whole_campaign_is_read_without_loss() -> None:
    files = [path for floor in ("table_0.1", "gray_0.1", "gray_0.2") for path in logs(WHOLE / floor)]
    summary = import_files(RobotinoImporter(), files)
    assert len(summary.records) == 216 and not summary.refused
    assert all(not r.dropped and not r.notes for r in summary.readings)
    assert summary.facts()["ticks_per_turn_by_logged_speed"] == pytest.approx(1978, abs=10)


def reversed_drives(robot: Robot) -> Robot:
    """The same machine by a user to whom every drive direction is the other end of the wheel."""
    return replace(
        robot,
        wheels=tuple(replace(w, drive_direction_deg=w.drive_direction_deg + 180.0) for w in robot.wheels),
    )


def on_floor(robot: Robot, record: Record) -> Array:
    """The front's heading, and how wheel angles and commands alone would move the robot on the floor."""
    assert record.theta is not None
    kept = np.isfinite(record.pose).all(axis=1)
    ways = [np.diff(wheel_path(robot.geometry, record.theta)[kept], axis=0)]
    if record.omega_cmd is not None:
        ways.append(record.omega_cmd[kept][1:] @ robot.geometry.no_slip_map().T)
    phi = record.pose[kept][1:, 2]
    return np.column_stack([robot.convention.yaw_of_phi(phi), *(rotate_rows(phi, way) for way in ways)])


@pytest.mark.parametrize(
    "same",
    [
        lambda robot: robot_in(robot, Convention.PAPER),
        lambda robot: reversed_drives(robot_in(robot, Convention.PAPER)),
        reversed_drives,
    ],
)
def test_any_robot_file_of_the_same_robotino_tells_the_same_of_a_log(
    same: Callable[[Robot], Robot],
) -> None:
    """In the paper's axes φ was 90° off, and wheels turned the wrong way where the file turns them round."""
    shipped = read_recipe("robotino").robot
    robot = same(shipped)
    found, known = (on_floor(r, RobotinoImporter(robot=r).read(LOG).record) for r in (robot, shipped))
    np.testing.assert_allclose(found, known, atol=1e-9)


@pytest.mark.parametrize(
    "same",
    [
        lambda robot: robot_in(robot, Convention.ROS),
        lambda robot: reversed_drives(robot_in(robot, Convention.ROS)),
        reversed_drives,
    ],
)
def test_any_robot_file_of_the_same_ssl_robot_tells_the_same_of_a_log(same: Callable[[Robot], Robot]) -> None:
    """In ROS's axes every wheel turned the wrong way."""
    shipped = read_recipe("robojackets-2018").robot
    robot = same(shipped)
    found, known = (
        on_floor(r, sm.import_logs([SSL], "robojackets", r).read.records[0]) for r in (robot, shipped)
    )
    np.testing.assert_allclose(found, known, atol=1e-9)


def test_a_robot_of_other_wheels_is_refused_by_its_count() -> None:
    with pytest.raises(InputError, match="wheel: mecanum4 has 4 wheels, the log 3, give the file"):
        RobotinoImporter(robot=read_recipe("mecanum4").robot).read(LOG)
