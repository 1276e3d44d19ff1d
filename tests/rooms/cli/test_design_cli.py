"""``slipmargin design``: the answer first, files whole, and a study that survives kill −9."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from slipmargin_cli.design import _kept_in
from slipmargin_cli.main import status

SCRIPT = Path(sys.executable).with_name("slipmargin")
QUICK = ["design", "ohio-kiwi", "--surface", "paper", "--vary", "delta_deg=15,30,35,40", "--static"]


def test_the_first_lines_are_the_answer(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(QUICK) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("best        delta_deg = 35: f_worst 0.18308 m g")
    assert lines[1].startswith("own         the file's design (delta_deg = 15): 0.16705 m g; +9.6 % with")
    # Mirrored, and pulled the other way, the robot is as weak: of four headings rounding picks one.
    assert lines[2].startswith("why         weakest at φ = ")
    side = {"62.5": "right", "242.5": "right", "117.5": "left", "297.5": "left"}
    assert f"{side[lines[2].split('φ = ')[1].split('°')[0]]} drive" in lines[2]
    assert lines[3].startswith("loads       equal loads: best at delta_deg = 35") and (
        "static loads: best at delta_deg = 30" in lines[3]
    )
    assert any(line.startswith("between     delta_deg = 35.72") for line in lines)
    rows = [line.split() for line in lines[-4:]]
    assert [row[0] for row in rows] == ["15", "30", "35", "40"]  # one row a design


def test_the_table_has_one_row_a_design(tmp_path: Path) -> None:
    out = tmp_path / "f.csv"
    assert status([*QUICK[:-1], "--out", str(out)]) == 0
    head, *rows = out.read_text(encoding="utf-8").splitlines()
    assert head.split(",")[:4] == ["delta_deg", "f_worst", "f_mean", "f_best"]
    assert {"yaw_moment_N_m", "start_worst_m_s2", "brake_worst_m_s2"} <= set(head.split(","))
    assert len(rows) == 4
    assert [p.name for p in tmp_path.iterdir()] == ["f.csv"]  # no work folder is left behind


def test_json_holds_everything(capsys: pytest.CaptureFixture[str]) -> None:
    assert status([*QUICK, "--json", "-", "--uncertain", "mu_drive=0.2:0.3"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["schema"] == 1 and data["best"]["design"] == {"delta_deg": 35.0}
    assert data["optimum"]["gain_over_grid"] >= 0.0 and data["optimum"]["self_check"] < 1e-9
    assert data["robust"]["worst_corner"] == {"mu_drive": 0.2} and data["robust"]["exact"]
    assert data["why"]["gives_way"] and data["front"]["rows"] and data["influence"]


def test_the_page_is_self_contained(tmp_path: Path) -> None:
    pages = []
    for name in ("a.html", "b.html"):
        assert status([*QUICK, "--html", str(tmp_path / name), "--plot", str(tmp_path / "f.png")]) == 0
        pages.append((tmp_path / name).read_text(encoding="utf-8").replace(name, ""))
    assert pages[0] == pages[1]
    assert "<svg" in pages[0] and "src=" not in pages[0] and "<script" not in pages[0]
    assert "wheel angle δ 35°" in pages[0] and "The answer" in pages[0]
    assert (tmp_path / "f.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (
            ["--vary", "delta=1"],
            "--vary delta: is not a quantity that can be varied, did you mean 'delta_deg'?",
        ),
        (["--vary", "delta_deg=5:1:1"], "--vary delta_deg: goes from 5 down to 1, swap the ends"),
        (["--vary", "delta_deg=88,89"], "command line: --vary: holds no possible design"),
        (["--vary", "delta_deg=1,2", "--surface", "ice"], "--surface: is 'ice'"),
        (["--vary", "delta_deg=1,2", "--objective", "speed"], "--objective: is 'speed'"),
        (["--vary", "delta_deg=1,2", "--front", "f_worst,speed"], "--front objective: is 'speed'"),
        (
            ["--vary", "delta_deg=1,2", "--uncertain", "mu_drive=2"],
            "--uncertain 'mu_drive=2': is no interval",
        ),
        (
            ["--vary", "delta_deg=1,2", "--uncertain", "delta_deg=1:2"],
            "--uncertain delta_deg: is varied as well",
        ),
        (["--vary", "delta_deg=1,2", "--jobs", "0"], "--jobs: is 0"),
        (["--vary", "delta_deg=1,2", "--out", "no/such/f.csv"], "there is no folder"),
        (["--vary", "delta_deg=1,2", "--plot", "f.doc"], "which is no picture"),
        ([], "--vary: is missing"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    surface = [] if "--surface" in arguments else ["--surface", "paper"]
    assert status(["design", "ohio-kiwi", *surface, *arguments]) == 2
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1
    assert told.err.startswith("error: ") and says in told.err


def design(folder: Path, *more: str) -> subprocess.Popen[bytes]:
    folder.mkdir(exist_ok=True)
    words = [
        "design",
        "ohio-kiwi",
        "--surface",
        "paper",
        "--vary",
        "delta_deg=0:57:0.5",
        "--jobs",
        "1",
        "--out",
        "f.csv",
    ]
    return subprocess.Popen(
        [str(SCRIPT), *words, *more],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--uncertain", "com_y_m=0:0.5"], "--uncertain: leaves no design"),
        (["--scheduler", "nonsense://x", "--objective", "start_worst_m_s2"], "--scheduler: "),
        (["--scheduler", "tcp://127.0.0.1:9"], "--scheduler: has nothing to do"),
    ],
)
def test_what_shows_only_later_is_placed_too(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert status([*QUICK, *arguments]) == 2
    assert f"error: command line: {says}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["ohio-kiwi", "--surface", "paper", "--vary", "com_y_m=9:10:1"], "--vary: holds no possible design"),
        (
            ["ohio-kiwi", "--surface", "paper", "--vary", "mass_kg=1,2", "--uncertain", "com_y_m=0:0.5"],
            "--uncertain: leaves no design",
        ),
    ],
)
def test_a_refused_study_leaves_no_pieces(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its own design was computed and kept in pieces before the refusal."""
    assert status(["design", *words, "--out", str(tmp_path / "o.csv")]) == 2
    assert says in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_pieces_are_spoken_of_where_there_are_some(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Interrupted before the first one it said that finished pieces are kept."""
    for name, said in (("lock", False), ("piece-0.json", True)):
        (tmp_path / name).touch()
        with pytest.raises(KeyboardInterrupt), _kept_in(tmp_path):
            raise KeyboardInterrupt
        assert ("finished pieces are kept" in capsys.readouterr().err) == said


def test_a_study_killed_halfway_goes_on_to_the_same_file(tmp_path: Path) -> None:
    """kill −9 in the middle: finished pieces are not computed again, the file is the same byte for byte."""
    whole = design(tmp_path / "whole")
    work = tmp_path / "killed" / "f.csv.work"
    process = design(tmp_path / "killed")
    deadline = time.monotonic() + 60.0
    while time.monotonic() < deadline and (not work.is_dir() or len(list(work.glob("piece-*.json"))) < 3):
        time.sleep(0.005)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    assert process.returncode == -signal.SIGKILL
    pieces = {p.name: p.stat().st_mtime_ns for p in work.glob("piece-*.json")}
    assert 3 <= len(pieces) < 15, "the study was not killed in its middle"
    assert not (tmp_path / "killed" / "f.csv").exists()
    again = design(tmp_path / "killed")
    said = again.communicate(timeout=120)[0].decode()
    assert again.returncode == 0
    assert f"{len(pieces)} of 15 pieces from an earlier run" in said
    assert not work.exists()
    whole.communicate(timeout=120)
    assert (tmp_path / "killed" / "f.csv").read_bytes() == (tmp_path / "whole" / "f.csv").read_bytes()


def test_an_objective_that_is_not_computed_is_spoken_of(capsys: pytest.CaptureFixture[str]) -> None:
    assert status([*QUICK, "--front", "start_worst_m_s2,brake_worst_m_s2"]) == 0
    said = capsys.readouterr().err
    assert "front: start_worst_m_s2, brake_worst_m_s2 is not computed in this study" in said
    assert status(QUICK) == 0 and "front" not in capsys.readouterr().err
