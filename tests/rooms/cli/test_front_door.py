"""The front door: help, exit statuses, interruptions, closed pipes."""

from __future__ import annotations

import ctypes
import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import slipmargin_cli
import typer
from robot_files import GOOD
from slipmargin_cli import main
from slipmargin_cli.main import COMMANDS, status

from slipmargin.errors import MotionStopped, NoSolution

SCRIPT = Path(sys.executable).with_name("slipmargin")
THERE = [
    name
    for name, (target, _) in COMMANDS.items()
    if (Path(main.__file__).parent / f"{target.partition(':')[0].split('.')[1]}.py").exists()
]


def run(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(SCRIPT), *arguments], capture_output=True, text=True, timeout=60, check=False, **options
    )  # type: ignore[call-overload,no-any-return]


def with_command(monkeypatch: pytest.MonkeyPatch, function: object) -> None:
    """A command ``try-me`` that runs ``function``."""
    monkeypatch.setattr(main, "COMMANDS", {"try-me": ("slipmargin_cli.main:try_me", "Try.")})
    monkeypatch.setattr(main, "try_me", function, raising=False)


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["--help"]) == 0
    text = capsys.readouterr().out
    for name in THERE:
        assert f"\n  {name} " in text
    assert status([]) == 0
    assert capsys.readouterr().out == text


@pytest.mark.parametrize("name", THERE)
def test_every_command_documents_itself(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert status([name, "--help"]) == 0
    assert f"slipmargin {name}" in capsys.readouterr().out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["--version"]) == 0
    assert capsys.readouterr().out.startswith("slipmargin 0.")


@pytest.mark.parametrize(
    "failure",
    [
        NoSolution("pull at φ = 1", "the robot slips without any pull", "level the floor"),
        MotionStopped(1.25, "the robot tips over", "drive more slowly"),
    ],
)
def test_a_refusal_is_one_line(
    failure: Exception, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail() -> None:
        raise failure

    with_command(monkeypatch, fail)
    assert status(["try-me"]) == 2
    assert capsys.readouterr().err == f"error: {failure}\n"


def test_a_defect_is_one_line_that_says_how_to_report(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail() -> None:
        raise ZeroDivisionError("first\nsecond")

    with_command(monkeypatch, fail)
    monkeypatch.delenv("SLIPMARGIN_DEBUG", raising=False)
    assert status(["try-me"]) == 1
    text = capsys.readouterr().err
    assert text.count("\n") == 1
    assert text.startswith("internal error: ZeroDivisionError: first second (")
    assert "SLIPMARGIN_DEBUG=1" in text
    monkeypatch.setenv("SLIPMARGIN_DEBUG", "1")
    with pytest.raises(ZeroDivisionError):
        status(["try-me"])


@pytest.mark.parametrize("signal_", [KeyboardInterrupt, typer.Abort])
def test_an_interruption_is_quiet(
    signal_: type[BaseException], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stop() -> None:
        raise signal_

    with_command(monkeypatch, stop)
    assert status(["try-me"]) == 130
    assert capsys.readouterr() == ("", "")


def test_an_interruption_that_the_compiler_lost_is_quiet_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Python drops what a callback from C raises: Ctrl-C while LLVM compiled was an internal error."""

    def compiles() -> None:
        @ctypes.CFUNCTYPE(None)
        def notified() -> None:
            raise KeyboardInterrupt

        notified()
        raise RuntimeError("no compiled object yet")

    before = sys.unraisablehook
    with_command(monkeypatch, compiles)
    assert status(["try-me"]) == 130
    assert capsys.readouterr() == ("", "")
    assert sys.unraisablehook is before


def test_an_exit_status_of_a_command_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    def leave() -> None:
        raise typer.Exit(7)

    with_command(monkeypatch, leave)
    assert status(["try-me"]) == 7


def test_ctrl_c_while_modules_are_loaded_is_quiet(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the first fifths of a second it ended in a traceback, by the signal instead of 130."""

    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("slipmargin_cli.main.run", interrupted)
    with pytest.raises(SystemExit) as left:
        slipmargin_cli.run()
    assert left.value.code == 130


def test_interrupted_process_writes_nothing(tmp_path: Path) -> None:
    arguments = ["sweep", "ohio-kiwi", "--surface", "paper", "--step", "0.0005", "--out", "f.csv"]
    (tmp_path / "f.csv").write_text("before", encoding="utf-8")
    process = subprocess.Popen(
        [str(SCRIPT), *arguments], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    time.sleep(0.9)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    if process.returncode == 0:
        pytest.skip("it was done before it could be interrupted")
    assert (process.returncode, out, err) == (130, "", "")
    assert {p.name: p.read_text(encoding="utf-8") for p in tmp_path.iterdir()} == {"f.csv": "before"}


def test_a_reader_that_goes_away_does_not_stop_the_work(tmp_path: Path) -> None:
    script = (
        f"{SCRIPT} sweep ohio-kiwi --surface paper --step 0.01 --json f.json | head -n 1; "
        "echo ${PIPESTATUS[0]}"
    )
    done = subprocess.run(
        ["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.splitlines()[0].startswith("weakest")
    assert done.stdout.splitlines()[1] == "0"
    assert "Error" not in done.stderr and "Traceback" not in done.stderr
    assert json.loads((tmp_path / "f.json").read_text(encoding="utf-8"))["schema"] == 1


def test_as_a_process(tmp_path: Path) -> None:
    done = run("sweep", "ohio-kiwi", "--surface", "ice", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "error: command line: --surface: is 'ice', use one of: paper, carpet\n"


def test_sweep_says_the_answer_in_four_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert status(["sweep", "ohio-kiwi", "--surface", "paper", "--margin", "0.2", "--out", "f.csv"]) == 0
    out, err = capsys.readouterr()
    weakest, strongest, isotropic, recommended = out.splitlines()[:4]
    # docs/theory.md, section 2: 0.16705 m g at 0 degrees and 0.21296 at 90; m g = 29.43 N, 0.26 m g = 7.65 N.
    assert weakest.split()[:4] == ["weakest", "4.92", "N", "(0.1671"] and "φ = 0°" in weakest
    assert strongest.split()[:4] == ["strongest", "6.27", "N", "(0.2130"] and "φ = 90°" in strongest
    assert isotropic.split()[:3] == ["isotropic", "7.65", "N"] and "56 % more" in isotropic
    assert recommended.split()[:3] == ["recommended", "3.93", "N:"] and "20 %" in recommended
    # docs/theory.md, section 3: statics gives the rear wheel 0.2056 m g.
    assert err.startswith("warning: loads: ") and "0.2056 m g" in err and err.count("\n") == 1
    rows = (tmp_path / "f.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "phi_rad,f_max_N,f_low_N,f_high_N,limiting" and len(rows) == 92
    last = rows[-1].split(",")
    assert float(last[0]) == pytest.approx(math.pi / 2) and float(last[1]) == pytest.approx(6.2674, abs=2e-4)


@pytest.mark.parametrize("grip", ["box", "ellipse"])
@pytest.mark.parametrize("method", ["clarabel", "facets", "cvxpy"])
def test_methods_agree(method: str, grip: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    arguments = ["sweep", "omni4", "--surface", "floor", "--to", "360", "--step", "45", "--method", method]
    assert status([*arguments, "--grip", grip, "--json", "f.json"]) == 0
    assert json.loads((tmp_path / "f.json").read_text(encoding="utf-8"))["self_check"] < (
        1e-9 if grip == "box" else 1e-6
    )


def test_measured_pulls_stand_in_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text(
        "phi_rad,force_N\n0,5.0\n0,5.2\n0.1234567,5.5\n-6.1,5.6\n3.1,4.4\n", encoding="utf-8"
    )
    assert (
        status(
            [
                "sweep",
                "ohio-kiwi",
                "--surface",
                "paper",
                "--step",
                "15",
                "--measured",
                "p.csv",
                "--out",
                "f.csv",
                "--plot",
                "f.svg",
                "--json",
                "f.json",
            ]
        )
        == 0
    )
    assert "4 pulls at 3 orientations" in capsys.readouterr().out
    head, *rows = [line.split(",") for line in (tmp_path / "f.csv").read_text(encoding="utf-8").splitlines()]
    assert head[5:] == ["measured_N", "scatter_N", "residual_N", "pulls"]
    assert len(rows) == 9  # seven of the grid and two orientations between
    first, between = rows[0], rows[1]
    assert [float(c) for c in first[5:]] == pytest.approx([5.1, 0.1414214, 5.1 - float(first[1]), 2.0])
    assert float(between[0]) == pytest.approx(0.1234567) and between[6] == ""  # one pull has no scatter
    assert float(rows[2][7]) == pytest.approx(5.6 - float(rows[2][1])) and rows[2][8] == "1"
    assert (tmp_path / "f.svg").read_text(encoding="utf-8").startswith("<?xml")
    assert json.loads((tmp_path / "f.json").read_text(encoding="utf-8"))["residual_N"][3] is None


def test_json_to_stdout_is_json_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["polytope", "ohio-kiwi", "--surface", "paper", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    # docs/theory.md, section 2 and issue 2: the δ = 15° set has 28 vertices and 22 facets.
    assert len(found["vertices"]) == 28 and len(found["facets"]) == 22 and len(found["generators"]) == 6
    normals = np.array([f["normal"] for f in found["facets"]])
    offsets = np.array([f["offset"] for f in found["facets"]])
    slack = offsets - np.array(found["vertices"]) @ normals.T
    assert slack.min() > -1e-9 * offsets.max()
    from scipy.spatial import ConvexHull

    assert found["volume"] == pytest.approx(ConvexHull(np.array(found["vertices"])).volume, rel=1e-9)


def test_the_wheel_angle_can_be_set(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["sweep", "ohio-kiwi", "--surface", "paper", "--delta-deg", "30", "--json", "-"]) == 0
    turned = json.loads(capsys.readouterr().out)
    assert status(["sweep", "ohio-kiwi-symmetric", "--surface", "paper", "--json", "-"]) == 0
    built = json.loads(capsys.readouterr().out)
    assert turned["f_max_N"] == pytest.approx(built["f_max_N"], rel=1e-12)


def test_robots_and_effects_are_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["robots", "list"]) == 0
    listed = capsys.readouterr().out.splitlines()
    for line in listed:
        assert status(["robots", "show", line.split()[0]]) == 0
        text = capsys.readouterr().out
        assert "schema = 1" in text and "front (+" in text and "1 m/s forward" in text
    assert status(["robots", "show", "mecanum4", "--plot", str(tmp_path / "m.png")]) == 0
    assert (tmp_path / "m.png").read_bytes().startswith(b"\x89PNG")
    capsys.readouterr()
    assert status(["effects", "list"]) == 0
    for line in capsys.readouterr().out.splitlines():
        assert status(["effects", "show", line.split()[0]]) == 0
        assert f'name = "{line.split()[0]}"' in capsys.readouterr().out


def test_drawing_shows_numbers_where_the_wheels_are() -> None:
    from slipmargin.io.robot_file import read_recipe
    from slipmargin.report.drawing import drawing

    lines = drawing(read_recipe("ohio-kiwi").robot)
    at = {n: next((row, line.index(n)) for row, line in enumerate(lines) if n in line) for n in "123"}
    assert at["1"][0] == at["2"][0] < at["3"][0]  # front wheels above the rear one
    assert at["2"][1] < at["3"][1] < at["1"][1]  # wheel 1 on the right
    assert any("→" in line for line in lines)  # the rear wheel drives along +X


def test_environment_is_left_alone(tmp_path: Path) -> None:
    done = run(
        "sweep",
        "ohio-kiwi",
        "--surface",
        "paper",
        "--plot",
        "f.png",
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "TkAgg"},
    )
    assert done.returncode == 0 and sorted(os.listdir(tmp_path)) == ["f.png"]


def test_a_terminal_of_few_letters_is_enough(tmp_path: Path) -> None:
    done = run(
        "sweep",
        "ohio-kiwi",
        "--surface",
        "paper",
        "--step",
        "45",
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert done.returncode == 0 and "\\u03c6 [deg]" in done.stdout


def test_control_characters_do_not_reach_the_terminal(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text(
        GOOD.replace("[body]", '"\\u001b[31mred" = 2\n[body]'), encoding="utf-8"
    )
    done = run("robots", "show", "robot.toml", cwd=tmp_path)
    assert done.returncode == 2 and "\\x1b[31mred" in done.stderr and done.stderr.count("\n") == 1
