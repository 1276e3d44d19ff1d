"""``bounds``, ``plan`` and ``check`` from the command line: columns, verdicts, refusals without a file."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

from slipmargin.io.robot_file import read_recipe
from slipmargin.io.robot_text import write_recipe

WAY = "x_m,y_m,phi_rad\n0,0,0\n0.5,0.3,0.5\n1.0,0,0\n"
COLUMNS = (
    "t_s,x_m,y_m,phi_rad,vx_m_s,vy_m_s,wz_rad_s,ax_m_s2,ay_m_s2,alpha_rad_s2,"
    "omega1_rad_s,omega2_rad_s,omega3_rad_s,use1,use2,use3"
)


@pytest.fixture
def way(tmp_path: Path) -> Path:
    (tmp_path / "way.csv").write_text(WAY, encoding="utf-8")
    return tmp_path / "way.csv"


def rows(file: Path) -> dict[str, np.ndarray]:
    with file.open(encoding="utf-8") as text:
        table = list(csv.DictReader(text))
    return {name: np.array([float(row[name]) for row in table]) for name in table[0]}


def test_plan_then_check(way: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, told = tmp_path / "t.csv", tmp_path / "c.json"
    assert (
        status(
            [
                "plan",
                "ohio-kiwi",
                str(way),
                "--surface",
                "paper",
                "--points",
                "100",
                "--out",
                str(out),
                "--plot",
                str(tmp_path / "p.png"),
                "--verify",
            ]
        )
        == 0
    )
    said = capsys.readouterr().out
    assert said.startswith("duration") and "simulated   on rollers: does not slip" in said
    assert "with its rigid sectors" in said and (tmp_path / "p.png").stat().st_size > 10_000
    assert out.read_text(encoding="utf-8").splitlines()[0] == COLUMNS
    table = rows(out)
    assert max(table[f"use{i}"].max() for i in (1, 2, 3)) <= 0.9 * (1.0 + 1e-6)
    assert table["t_s"][0] == 0.0 and np.all(np.diff(table["t_s"]) > 0.0)
    assert (
        status(["check", "ohio-kiwi", str(out), "--surface", "paper", "--margin", "0.1", "--json", str(told)])
        == 0
    )
    verdict = json.loads(told.read_text(encoding="utf-8"))
    assert verdict["admissible"] and verdict["max_use"] <= 0.9 and verdict["time_scale_needed"] == 1.0
    assert np.array(verdict["use"]).shape == (len(table["t_s"]), 3)
    assert "admissible" in capsys.readouterr().out


def test_check_names_the_cure(way: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    t = np.linspace(0.0, 1.0, 101)
    poses = np.column_stack([t, 0.5 * t**2, 0 * t, 0 * t])  # 1 m/s² along X: twice the limit
    file = tmp_path / "fast.csv"
    np.savetxt(file, poses, delimiter=",", header="t_s,x_m,y_m,phi_rad", comments="")
    assert (
        status(
            [
                "check",
                "ohio-kiwi",
                str(file),
                "--surface",
                "paper",
                "--plot",
                str(tmp_path / "c.svg"),
                "--out",
                str(tmp_path / "full.csv"),
            ]
        )
        == 0
    )
    said = capsys.readouterr().out
    assert "not admissible" in said and "wheel rear" in said and "stretch time by 1.4" in said
    assert (tmp_path / "full.csv").read_text(encoding="utf-8").splitlines()[0] == COLUMNS
    assert status(["check", "ohio-kiwi", str(file), "--surface", "paper", "--robust"]) == 0
    assert "none by slowing down" in capsys.readouterr().out


def test_bounds_says_the_four_lines_and_exports(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, yaml = tmp_path / "b.csv", tmp_path / "f.yaml"
    assert (
        status(
            [
                "bounds",
                "ohio-kiwi",
                "--surface",
                "paper",
                "--step",
                "15",
                "--out",
                str(out),
                "--export",
                "nav2",
                str(yaml),
                "--plot",
                str(tmp_path / "b.pdf"),
            ]
        )
        == 0
    )
    said = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in said[:4]] == ["traction", "motor", "isotropic", "recommended"]
    assert "0.5017" in said[0] and "max_accel" in yaml.read_text(encoding="utf-8")
    assert out.read_text(encoding="utf-8").startswith("heading_rad,starting_m_s2,turning_m_s2,braking_m_s2,")
    assert status(["bounds", "ohio-kiwi", "--surface", "paper", "--step", "45", "--json", "-"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["starting_m_s2"][0] == pytest.approx(0.5017, abs=5e-5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x_m,y_m,phi_rad\n0,0,0\n", "waypoint: 1 waypoint is no path"),
        ("x_m,y_m,phi_rad\n0,0,0\n1,0,0\n1,0,0\n", "waypoint 3: repeats waypoint 2"),
        ("x_m,y_m,phi_rad\n0,0,0\n1,nan,0\n", "3:2: y_m is 'nan'"),
        ("x_m,y_m,phi_rad\n0,0,0\n1,0,0\n0,0,0.01\n", "waypoint 2: is a kink"),
        ("x_m,y_m\n0,0\n1,0\n", "'phi_rad' is missing"),
    ],
)
def test_bad_waypoints_leave_no_file(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out = tmp_path / "way.csv", tmp_path / "t.csv"
    file.write_text(text, encoding="utf-8")
    assert status(["plan", "ohio-kiwi", str(file), "--surface", "paper", "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {file}: ") and words in said and said.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--blend", "0"], "waypoint 2: is a kink"),
        (["--blend", "0.1", "--closed"], "--blend: is given with --closed"),
        (["--start-speed", "50"], "start speed: is 50 m/s at x 0 m"),
        (["--max-speed", "-1"], "--max-speed"),
        (["--max-yaw-rate", "0"], "--max-yaw-rate"),
        (["--margin", "0.6"], "use a margin below 0.46"),
        (["--robust"], "more than the 0.9 allowed"),
        (["--points", "3"], "points: is 3"),
        (["--step", "0"], "--step: is 0"),
        (["--step", "100"], "--step: is 100 s and gives 2 rows"),
    ],
)
def test_impossible_plans_are_refused(
    options: list[str], words: str, way: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "t.csv"
    assert status(["plan", "ohio-kiwi", str(way), "--surface", "paper", "--out", str(out), *options]) == 2
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize("options", [["--step", "0"], ["--export", "moveit", "x.yaml"], ["--plot", "b.bmp"]])
def test_bounds_refuses_before_it_writes(
    options: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert status(["bounds", "ohio-kiwi", "--surface", "paper", *options]) == 2
    assert "error: " in capsys.readouterr().err and not list(tmp_path.iterdir())


TRAJECTORIES = Path(__file__).parents[2] / "data" / "trajectories"


@pytest.mark.parametrize("name", ["choreo-2025.traj", "choreo-2024.traj", "pathplanner.wpilib.json"])
def test_strict_exits_1_when_not_admissible(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["check", "ohio-kiwi", str(TRAJECTORIES / name), "--surface", "paper"]
    assert status([*arguments, "--strict"]) == 0
    assert capsys.readouterr().out.startswith("admissible: uses at most 0.90")
    tight = [*arguments, "--margin", "0.3"]
    assert status(tight) == 0
    said = capsys.readouterr().out
    assert said.startswith("not admissible: uses at most 0.90") and "of a wheel's grip, 0.7 allowed" in said
    out = tmp_path / "full.csv"
    assert status([*tight, "--strict", "--out", str(out)]) == 1
    streams = capsys.readouterr()
    assert streams.out.startswith(said) and out.exists()  # the same words, and the files are written
    assert "error" not in streams.err
    assert status([*tight, "--strict", "--json", "-"]) == 1
    assert json.loads(capsys.readouterr().out)["admissible"] is False


def test_a_verdict_that_smoothing_makes_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    t = np.linspace(0.0, 2.0, 201)
    jerky = np.column_stack([t, 0.1 * t**2 + 5e-4 * (-1.0) ** np.arange(201), 0 * t, 0 * t])
    file, out, page = tmp_path / "jerky.csv", tmp_path / "c.json", tmp_path / "c.html"
    np.savetxt(file, jerky, delimiter=",", header="t_s,x_m,y_m,phi_rad", comments="")
    words = ["check", "ohio-kiwi", str(file), "--surface", "paper", "--strict"]
    assert status([*words, "--smooth", "4"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: command line: --smooth: is 4 s, which averages") and said.count("\n") == 1
    assert status(words) == 1
    rough = capsys.readouterr().out.splitlines()[0]
    assert status([*words, "--smooth", "0.2", "--json", str(out), "--report", str(page)]) == 0
    smooth = capsys.readouterr().out
    assert (
        smooth.startswith("admissible: ") and f"smoothing   over 0.2 s decides: without it {rough}" in smooth
    )
    assert json.loads(out.read_text(encoding="utf-8"))["unsmoothed"]["admissible"] is False
    assert "Smoothing over" in page.read_text(encoding="utf-8")


def test_strict_does_not_hide_bad_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.traj"
    file.write_text("hello", encoding="utf-8")
    assert status(["check", "ohio-kiwi", str(file), "--surface", "paper", "--strict"]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {file}: is no trajectory of a known form, give a CSV with")
    assert said.count("\n") == 1
    sample = str(TRAJECTORIES / "choreo-2024.traj")
    assert status(["check", "ohio-kiwi", sample, "--surface", "paper", "--topic", "/plan"]) == 2
    assert capsys.readouterr().err.startswith("error: command line: --topic: is for ROS bags")


def test_the_exit_status_is_in_the_help(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["check", "--help"]) == 0
    assert "with --strict 1 when not admissible" in " ".join(capsys.readouterr().out.split())


def test_the_page_on_ci_shows_real_output(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (Path(__file__).parents[3] / "docs" / "how-to" / "check-in-ci.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "auto.traj").write_bytes((TRAJECTORIES / "choreo-2025.traj").read_bytes())
    (block,) = re.findall(r"```console\n(.*?)```", page, flags=re.DOTALL)
    shown = re.split(r"^\$ slipmargin ", block, flags=re.MULTILINE)[1:]
    codes = []
    for command, _, expected in (part.partition("\n") for part in shown):
        codes.append(status(command.split()))
        assert capsys.readouterr().out.partition("\n\n")[0].strip() == expected.strip()
    assert codes == [0, 1]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that a command runs in, with the waypoints of a metre ahead."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "way.csv").write_text("x_m,y_m,phi_rad\n0,0,0\n1,0,0\n", encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            ["plan", "ohio-kiwi", "way.csv", "--surface", "paper", "--out", "way.csv"],
            "is read as well as written",
        ),
        (["sweep", "own.toml", "--surface", "paper", "--report", "own.toml"], "is read as well as written"),
        (
            ["bounds", "ohio-kiwi", "--surface", "paper", "--report", "a", "--json", "./a"],
            "is asked for twice",
        ),
        (
            ["plan", "ohio-kiwi", "way.csv", "--surface", "paper", "--out", "m", "--export", "choreo", "m"],
            "is asked for twice",
        ),
        (
            ["simulate", "ohio-kiwi", "way.csv", "--surface", "paper", "--export", "choreo", "way.csv"],
            "is read as well as written",
        ),
        (
            [
                "simulate",
                "ohio-kiwi",
                "way.csv",
                "--surface",
                "paper",
                "--out",
                "m",
                "--export",
                "choreo",
                "m",
            ],
            "is asked for twice",
        ),
        (["next-run", "ds", "--space", "2x2", "--json", "ds/robot.toml"], "is read as well as written"),
        (["next-run", "ds", "--space", "2x2", "--out", "ds"], "is read as well as written"),
        (["diagnose", "ds", "--out", "ds"], "is read as well as written"),
        (["diagnose", "ds", "--out", "new", "--json", "ds/robot.toml"], "is read as well as written"),
        (
            [
                *["monitor", "own.toml", "way.csv", "--surface", "paper", "--train", "ds"],
                *["--report", "ds/robot.toml"],
            ],
            "is read as well as written",
        ),
        (
            [
                *["import", "csv", "way.csv", "--robot", "own.toml", "--surface", "paper", "--out", "ds"],
                *["--force", "--json", "ds/robot.toml"],
            ],
            "lies in the data set that is written",
        ),
        (
            [
                *["import", "csv", "way.csv", "--robot", "own.toml", "--surface", "paper", "--out", "new"],
                *["--json", "way.csv"],
            ],
            "is read as well as written",
        ),
        (["export", "urdf", "own.toml"], "is there already"),
    ],
)
def test_no_output_takes_the_place_of_another_file(
    words: list[str], told: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Waypoints were replaced by their plan, and of two outputs of one name the first was lost."""
    robot = write_recipe(read_recipe("ohio-kiwi"))
    (here / "ds").mkdir()
    for name in ("own.toml", "ds/robot.toml", "ohio-kiwi.urdf"):
        (here / name).write_text(robot, encoding="utf-8")
    before = {p: p.read_bytes() for p in here.rglob("*") if p.is_file()}
    assert status(words) == 2
    assert told in capsys.readouterr().err
    assert {p: p.read_bytes() for p in here.rglob("*") if p.is_file()} == before


def test_of_a_motion_and_its_export_all_are_written_or_none(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The file for another tool was written first, whatever became of the others."""
    words = [
        "plan",
        "ohio-kiwi",
        "way.csv",
        "--surface",
        "paper",
        "--points",
        "20",
        "--export",
        "choreo",
        "m",
    ]
    monkeypatch.setattr("slipmargin.api.plan.PlanResult.to_json", lambda self: 1 / 0)
    assert status([*words, "--json", "m.json"]) == 1
    assert {p.name for p in here.iterdir()} == {"way.csv"}
    monkeypatch.undo()
    monkeypatch.chdir(here)
    assert status([*words, "--json", "m.json"]) == 0
    assert {p.name for p in here.iterdir()} == {"way.csv", "m", "m.json"}
    assert "written: m\n" in capsys.readouterr().out


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["plan", "ohio-kiwi", "way.csv", "--points", "100000000"], "command line: --points: asks for 1e+08"),
        (["plan", "ohio-kiwi", "way.csv", "--points", "1"], "command line: --points: is 1, use at least 10"),
        (["bounds", "ohio-kiwi", "--step", "1e-6"], "command line: --step: asks for 1.08e+09 wheels times"),
        (["stop", "ohio-kiwi", "--step", "0.01"], "command line: --step: asks for 3.6e+04 directions"),
    ],
)
def test_a_step_that_asks_for_too_much_is_refused_not_waited_for(
    words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A plan with 10^8 points was killed for want of memory, and one point was a fault of the waypoints."""
    assert status([*words, "--surface", "paper"]) == 2
    assert told in capsys.readouterr().err


def test_a_sweep_says_where_it_did_not_look(capsys: pytest.CaptureFixture[str]) -> None:
    """What is recommended holds for the orientations swept: of one it was 40 % above the weakest."""
    assert status(["sweep", "mecanum4", "--surface", "floor", "--step", "200"]) == 0
    assert "of all orientations the weakest was not swept" in capsys.readouterr().err
    assert status(["sweep", "mecanum4", "--surface", "floor", "--to", "360"]) == 0
    assert status(["sweep", "ohio-kiwi", "--surface", "paper"]) == 0
    assert "not swept" not in capsys.readouterr().err


def test_a_path_on_a_slope_is_planned_below_a_lower_speed_where_the_search_fails_above(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Tightening the motors' share of one interval had ended in "no admissible motion"."""
    robot, places = tmp_path / "m.toml", tmp_path / "way.csv"
    assert status(["robots", "new", str(tmp_path / "m"), "--type", "mecanum"]) == 0
    slope = '\n[[effect]]\nname = "floor_tilt"\ntilt_x_rad = 0.06\ntilt_y_rad = 0\n'
    robot.write_text(robot.read_text(encoding="utf-8") + slope, encoding="utf-8")
    places.write_text("x_m,y_m,phi_rad\n0,0,0\n1,1,0\n2,1,1\n", encoding="utf-8")
    words = ["plan", str(robot), str(places), "--surface", "floor", "--points", "60"]
    assert status([*words, "--json", str(tmp_path / "p.json")]) == 0
    found = json.loads((tmp_path / "p.json").read_text(encoding="utf-8"))
    assert found["duration_s"] < 3.2 and "a lower speed" in capsys.readouterr().err
