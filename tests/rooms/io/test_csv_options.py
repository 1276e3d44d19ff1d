"""``import csv`` by options: the columns of any CSV named on the command line."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

import slipmargin as sm
from slipmargin.io.data_set import read_data_set

COLUMNS = ["--time", "ms:ms", "--x", "px:mm", "--y", "-py:mm", "--heading", "yaw:deg"]
WHEELS = ["--wheel", "fl:rpm", "--wheel", "-fr:rpm", "--wheel", "rl:deg/s", "--wheel", "rr"]
ANGLES = ["--wheel", "fl:turn", "--wheel", "-fr:deg", "--wheel", "rl:ticks=4096", "--wheel", "rr:rad"]
TURN = 2.0 * math.pi


def log(folder: Path, mark: str = ",", head: str = "ms,px,py,yaw,fl,fr,rl,rr") -> Path:
    rows = [head, *(f"{50 * k},{10 * k},{-5 * k},{k},60,-60,{4096 * k},{0.1 * k}" for k in range(40))]
    file = folder / "run.csv"
    file.write_text("\n".join(rows).replace(",", mark) + "\n", encoding="utf-8")
    return file


@pytest.fixture
def robot(tmp_path: Path) -> str:
    file = tmp_path / "rover.toml"
    file.write_text(sm.new_robot("rover", "mecanum").text, encoding="utf-8")
    return str(file)


@pytest.mark.parametrize(
    ("mark", "wheels", "field", "known"),
    [
        (",", WHEELS, "omega", [TURN, TURN, 4096 * TURN / 360.0, 0.1]),
        (";", ANGLES, "theta", [60 * TURN, 60 * TURN / 360.0, TURN, 0.1]),
    ],
)
def test_columns_units_and_signs(
    mark: str, wheels: list[str], field: str, known: list[float], tmp_path: Path, robot: str
) -> None:
    file, out = log(tmp_path, mark), tmp_path / "set"
    words = ["import", "csv", str(file), "--robot", robot, "--out", str(out), *COLUMNS, "--separator", mark]
    assert status([*words, *wheels]) == 0
    (trial,) = read_data_set(out).trials
    np.testing.assert_allclose(trial.t_s[:3], [0.0, 0.05, 0.1])
    np.testing.assert_allclose(
        trial.pose[1], [0.01, 0.005, math.radians(1.0)], atol=1e-9
    )  # as the file rounds
    assert (trial.omega is None) == (field == "theta") and (trial.theta is None) == (field == "omega")
    np.testing.assert_allclose(getattr(trial, field)[1], known)


def test_angles_of_some_wheels_and_speeds_of_others_are_refused(
    tmp_path: Path, robot: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The set was written, and no command could use it."""
    file, out = log(tmp_path), tmp_path / "set"
    words = ["import", "csv", str(file), "--robot", robot, "--out", str(out), *COLUMNS]
    assert status([*words, *WHEELS[:4], *ANGLES[4:]]) == 2
    told = capsys.readouterr().err
    assert "run: has angles of some wheels and speeds of others, give angles or speeds of every wheel" in told
    assert not out.exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([*COLUMNS], "--wheel: is missing"),
        ([*COLUMNS[:2], *WHEELS], "--x: is missing: wheels alone show no slip"),
        ([*COLUMNS[2:], *WHEELS], "--time: is missing"),
        ([*COLUMNS, *WHEELS[:6]], "--wheel: are 3, give one for each of 4 wheels"),
        ([*COLUMNS, *WHEELS[:6], "--wheel", "rr:furlong"], "--wheel: has the unit 'furlong'"),
        ([*COLUMNS, *WHEELS[:6], "--wheel", "rr:ticks=no"], "write COLUMN:ticks=4096"),
        ([*COLUMNS, *WHEELS[:6], "--wheel", "-:rad"], "write COLUMN or COLUMN:UNIT"),
        ([*COLUMNS[:-1], "yaw:mm", *WHEELS], "--heading: has the unit 'mm'"),
        ([*COLUMNS[:1], "t:ms", *COLUMNS[2:], *WHEELS], "the column 't' is missing"),
        ([*COLUMNS, *WHEELS, "--separator", "x"], "--separator: is 'x'"),
        ([*COLUMNS, *WHEELS, "--map", "map.toml"], "--map: is given together with time"),
    ],
)
def test_what_is_missing_or_wrong_is_said_in_one_line(
    words: list[str], says: str, tmp_path: Path, robot: str, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "set"
    file = log(tmp_path)
    assert status(["import", "csv", str(file), "--robot", robot, "--out", str(out), *words]) == 2
    told = capsys.readouterr().err
    assert says in told and told.count("\n") == 1 and not out.exists()


def test_a_log_without_a_header_is_explained(
    tmp_path: Path, robot: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = log(tmp_path, head="0,0,0,0,60,-60,0,0")
    words = ["import", "csv", str(file), "--robot", robot, "--out", str(tmp_path / "set"), *COLUMNS, *WHEELS]
    assert status(words) == 2
    assert "no line names the columns ms, px, py, yaw" in capsys.readouterr().err
