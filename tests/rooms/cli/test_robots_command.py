"""``slipmargin robots new``, ``check`` and ``from-urdf``: robot files from what people have."""

from __future__ import annotations

import importlib.util
import json
import re
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.physics.convention import Convention
from slipmargin.report.robot_types import TYPES
from slipmargin.robot import Robot, Wheel

XACRO = Path(__file__).parents[2] / "data" / "urdf" / "mecanum.urdf.xacro"


@pytest.mark.parametrize("kind", TYPES)
def test_a_new_robot_is_complete_and_drives_as_its_file_says(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert status(["robots", "new", "mine", "--type", kind]) == 0
    assert "positive speed drives" in capsys.readouterr().out
    text = Path("mine.toml").read_text(encoding="utf-8")
    assert text.count("MEASURE FIRST (") == 4 and text.count("GUESS") > 8
    assert max(len(line) for line in text.splitlines()) <= 130
    robot = read_recipe(Path("mine.toml")).robot
    assert robot.name == "mine" and robot.convention is Convention.ROS
    assert sm.check_robot(robot).warnings == ()
    found = sm.bounds(robot, "floor", step_deg=45.0)
    assert found.recommended_m_s2 > 0.1
    assert status(["robots", "new", "mine", "--type", kind]) == 2
    assert "is there already" in capsys.readouterr().err
    assert status(["robots", "new", "mine.toml", "--type", kind, "--force"]) == 0


def test_an_unknown_type_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert status(["robots", "new", "mine", "--type", "mecanumm"]) == 2
    assert capsys.readouterr().err == (
        "error: command line: --type: is 'mecanumm', did you mean 'mecanum'? Known: lekiwi, kiwi, xdrive, "
        "mecanum, ssl\n"
    )
    assert not list(tmp_path.iterdir())


def test_lekiwi_turns_its_wheels_as_its_driver_does() -> None:
    """LeRobot's lekiwi.py: rows (cos a, sin a, R) with a = 240°, 0°, 120° less 90°, over the wheel radius."""
    a = np.deg2rad(np.array([240.0, 0.0, 120.0]) - 90.0)
    rows = np.column_stack([np.cos(a), np.sin(a), np.full(3, 0.125)]) / 0.05
    twist = np.array([0.2, -0.1, 0.7])  # forwards, left [m/s], yaw [rad/s]
    geometry = sm.new_robot("k", "lekiwi").recipe.robot.geometry
    np.testing.assert_allclose(geometry.wheel_speeds(twist), rows @ twist, rtol=1e-4)


@pytest.mark.parametrize("kind", TYPES)
def test_the_words_say_what_a_simulated_wheel_does(kind: str) -> None:
    robot = sm.new_robot("r", kind).recipe.robot
    said = sm.check_robot(robot).to_dict()["wheels"]
    for wheel, words in zip(robot.wheels, said, strict=True):
        way = np.deg2rad(wheel.drive_direction_deg)
        # The speed of the wheel that drives the robot along the wheel's own drive direction is positive.
        ahead, right = np.cos(way), -np.sin(way)
        assert ahead * words["forward"] + right * words["right"] > 0.0
        assert ("forwards" in words["says"]) == (ahead > 1e-6)
        assert ("backwards" in words["says"]) == (ahead < -1e-6)


def test_check_says_it_in_words_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "robot.png"
    assert status(["robots", "check", "mecanum4", "--plot", str(picture)]) == 0
    told = capsys.readouterr()
    assert "wheel front-left: mecanum, rollers -45°, positive speed drives backwards" in told.out
    assert "convention paper: +x to the right, +y forwards" in told.out
    assert picture.read_bytes().startswith(b"\x89PNG") and told.err == ""
    assert status(["robots", "check", "robotino", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["convention"] == "ros"
    assert [w["says"].split("drives ")[1] for w in found["wheels"]] == [
        "forwards, 30° to the right",
        "to the left",
        "backwards, 30° to the right",
    ]


def by_hand() -> Robot:
    """The robot of the xacro file, its numbers added up by hand."""
    made = sm.new_robot("rover", "mecanum").recipe.robot
    mass = 8.0 + 2.0 + 4 * 0.5
    com = np.array([8.0 * 0.01 + 2.0 * -0.05, 2.0 * 0.02]) / mass
    height = 0.06 + (8.0 * 0.05 + 2.0 * 0.02 + 2.0 * -0.01) / mass
    inertia = 0.18 + 0.001 + 4 * 0.0005
    for m, (x, y) in [
        (8.0, (0.01, 0.0)),
        (2.0, (-0.05, 0.02)),
        *((0.5, (a * 0.17, b * 0.15)) for a in (1, -1) for b in (1, -1)),
    ]:
        inertia += m * float(np.sum((np.array([x, y]) - com) ** 2))
    from dataclasses import replace

    motor = replace(made.motor, max_speed_rad_s=30.0, stall_torque_N_m=2.0)  # type: ignore[type-var]
    body = replace(made.body, mass_kg=mass, com_m=com, com_height_m=height, inertia_kg_m2=inertia)
    wheels: tuple[Wheel, ...] = tuple(replace(w, radius_m=0.05) for w in made.wheels)
    return replace(made, body=body, wheels=wheels, motor=motor)


def test_a_urdf_gives_the_limits_of_the_file_written_by_hand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("yourdfpy")
    out = tmp_path / "rover.toml"
    assert status(["robots", "from-urdf", str(XACRO), "--out", str(out)]) == 0
    told = capsys.readouterr().out
    assert "not known: roller_angle_deg of fl_wheel_joint" in told and "not known: the friction" in told
    found, hand = read_recipe(out).robot, by_hand()
    np.testing.assert_allclose(found.body.com_m, hand.body.com_m, atol=1e-6)
    assert found.body.com_height_m == pytest.approx(hand.body.com_height_m, abs=1e-6)
    assert found.body.inertia_kg_m2 == pytest.approx(hand.body.inertia_kg_m2, rel=1e-5)
    one, two = (sm.bounds(r, "floor", step_deg=15.0).bounds.full.starting_m_s2 for r in (found, hand))
    np.testing.assert_allclose(one, two, rtol=1e-4)
    one, two = (sm.sweep(r, "floor", step_deg=15.0).f_max_N for r in (found, hand))
    np.testing.assert_allclose(one, two, rtol=1e-5)


def test_the_joints_sign_and_xacro_arguments_are_obeyed(tmp_path: Path) -> None:
    pytest.importorskip("yourdfpy")
    out = tmp_path / "rover.toml"
    words = ["robots", "from-urdf", str(XACRO), "--out", str(out), "--xacro-args", "battery_kg:=4 sign:=-1"]
    assert status(words) == 0
    robot = read_recipe(out).robot
    assert robot.body.mass_kg == pytest.approx(14.0)
    assert [abs(w.drive_direction_deg) for w in robot.wheels] == [180.0] * 4
    assert [w.roller_angle_deg for w in robot.wheels] == [-45.0, 45.0, 45.0, -45.0]


def plain(text: str = "") -> str:
    """A three-wheel URDF without xacro: wheels at 60°, 180° and 300°, mesh wheels, rollers on the first."""
    rows = []
    for k, angle in enumerate((60.0, 180.0, 300.0), 1):
        a = np.deg2rad(angle)
        rows.append(
            f'<link name="w{k}"/><joint name="j{k}" type="continuous"><parent link="base_link"/>'
            f'<child link="w{k}"/>'
            f'<origin xyz="{0.125 * np.cos(a)} {0.125 * np.sin(a)} 0.04" rpy="0 0 {a}"/>'
            '<axis xyz="-1 0 0"/></joint>'
        )
    body = '<link name="base_footprint"/><link name="base_link"/><joint name="b" type="fixed">'
    body += '<parent link="base_footprint"/><child link="base_link"/></joint>'
    return f'<robot name="r">{body}{"".join(rows)}{text}</robot>'


def test_a_urdf_may_use_the_letters_of_any_language(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """A name outside ASCII was handed on as ``&#233;``, which is no XML, and the rest was guessed."""
    pytest.importorskip("yourdfpy")
    file = tmp_path / "r.urdf"
    file.write_text(plain('<link name="é" größe="1"/>'), encoding="utf-8")
    with caplog.at_level("ERROR"):
        assert len(sm.robot_from_urdf(file).recipe.robot.wheels) == 3
    assert not caplog.records


def test_a_bare_urdf_says_all_that_it_could_not_know(tmp_path: Path) -> None:
    pytest.importorskip("yourdfpy")
    file = tmp_path / "r.urdf"
    file.write_text(plain(), encoding="utf-8")
    found = sm.robot_from_urdf(file)
    robot = found.recipe.robot
    assert [w.radius_m for w in robot.wheels] == [0.04] * 3  # the axle's height over base_footprint
    assert [w.drive_direction_deg for w in robot.wheels] == pytest.approx([150.0, -90.0, 30.0])
    for wanted in ("mass, inertia", "top speed", "roller_angle_deg", "friction"):
        assert any(wanted in line for line in found.unknown), wanted
    assert found.text.count("GUESS") > 10


@pytest.mark.parametrize("slant", [45.0, -45.0, 30.0])
def test_rollers_that_are_joints_give_the_roller_angle(slant: float, tmp_path: Path) -> None:
    pytest.importorskip("yourdfpy")
    file, a = tmp_path / "r.urdf", np.deg2rad(slant)
    # Wheel 2 drives towards −y; its lowest roller's axle stands at the slant from there.
    axle = np.deg2rad(-90.0) + a
    axis = f"{-np.cos(axle)} {-np.sin(axle)} 0"  # in the wheel's frame, which is turned by 180°
    rollers = "".join(
        f'<link name="r{k}"/><joint name="rj{k}" type="continuous"><parent link="w2"/><child link="r{k}"/>'
        f'<origin xyz="0 0 {z}"/><axis xyz="{way}"/></joint>'
        for k, (z, way) in enumerate([(-0.03, axis), (0.03, "1 0 0")])
    )
    file.write_text(plain(rollers), encoding="utf-8")
    wheel = sm.robot_from_urdf(file).recipe.robot.wheels[1]
    assert wheel.roller_angle_deg == pytest.approx(slant, abs=1e-3) and wheel.rollers == 2


DAMAGED = {
    "is no XML": lambda t: t[:-20],
    "is <mujoco>, not <robot>": lambda t: t.replace("<robot", "<mujoco").replace("</robot", "</mujoco"),
    "names the link 'w9'": lambda t: t.replace('<child link="w2"/>', '<child link="w9"/>'),
    "2 wheels": lambda t: t.replace('<joint name="j2" type="continuous">', '<joint name="j2" type="fixed">'),
    "its axis has no direction": lambda t: t.replace('"-1 0 0"', '"0 0 0"', 1),
    "is no URDF that can be read": lambda t: t.replace('xyz="-1 0 0"', 'xyz="one"', 1),
    "0 wheels": lambda t: re.sub(r"<joint.*</joint>", "", t),
    "holds no link": lambda t: '<robot name="r"></robot>',
    "its own ancestor": lambda t: t.replace('<parent link="base_footprint"/>', '<parent link="w1"/>'),
}


@pytest.mark.parametrize("says", DAMAGED)
def test_damaged_urdf_is_refused_in_one_line(
    says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("yourdfpy")
    file, out = tmp_path / "r.urdf", tmp_path / "out.toml"
    file.write_text(DAMAGED[says](plain()), encoding="utf-8")
    assert status(["robots", "from-urdf", str(file), "--out", str(out)]) == 2
    told = capsys.readouterr().err
    assert says in told and told.count("\n") == 1 and str(file) in told
    assert not out.exists()


def test_damaged_xacro_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("xacrodoc")
    file = tmp_path / "r.urdf.xacro"
    file.write_text(
        XACRO.read_text(encoding="utf-8").replace("$(arg battery_kg)", "${no_such_name}"), encoding="utf-8"
    )
    assert status(["robots", "from-urdf", str(file), "--out", str(tmp_path / "r")]) == 2
    told = capsys.readouterr().err
    assert "xacro cannot expand it" in told and told.count("\n") == 1
    assert (
        status(["robots", "from-urdf", str(XACRO), "--out", str(tmp_path / "r"), "--xacro-args", "a=1"]) == 2
    )
    assert "write NAME:=VALUE" in capsys.readouterr().err


def test_without_the_library_the_cure_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(plain(), encoding="utf-8")
    found = importlib.util.find_spec
    monkeypatch.setattr(
        "slipmargin.io.extra.find_spec", lambda name: None if name == "yourdfpy" else found(name)
    )
    with pytest.raises(InputError, match=r"pip install 'slipmargin\[urdf\]'"):
        sm.robot_from_urdf(file)
