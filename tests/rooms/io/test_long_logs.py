"""Logs of any length: what is read in blocks is what is read row by row, and too many rows are refused."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from slipmargin_cli.main import status

from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io import table
from slipmargin.io.importers import loose_table
from slipmargin.io.importers.loose_table import increasing, read_loose
from slipmargin.notice import heard


def log(path: Path, rows: int, *, word: str = "7") -> Path:
    lines = [f"{10 * k},{k % 7},{word},{-0.5 * k}" for k in range(rows)]
    path.write_text("t,x,mode,y\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def test_blocks_are_read_as_rows_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = log(tmp_path / "l.csv", 500)
    quick = read_loose(path, ("t", "x", "y"), ",")
    monkeypatch.setattr(loose_table._Rows, "_quick", lambda rows, block, ended: None)
    slow = read_loose(path, ("t", "x", "y"), ",")
    np.testing.assert_array_equal(quick.values, slow.values)
    np.testing.assert_array_equal(quick.lines, slow.lines)
    assert (quick.names, quick.rows, quick.dropped) == (slow.names, slow.rows, slow.dropped)


def test_a_column_that_nobody_asks_for_may_hold_words(tmp_path: Path) -> None:
    found = read_loose(log(tmp_path / "l.csv", 20, word="AUTO"), ("t", "y"), ",")
    assert found.names == ("t", "y") and len(found.values) == 20 and not found.dropped


@pytest.mark.parametrize("bad", ["1,2,3", "1,2,3,4,5", "1,2,3,", "1,2,3,0x10", "1,2,3,four"])
def test_one_bad_row_is_dropped_from_a_block(bad: str, tmp_path: Path) -> None:
    path = log(tmp_path / "l.csv", 50)
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[20] = bad.replace("1,", "190,", 1)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    found = read_loose(path, ("t", "y"), ",")
    assert found.rows == 50 and 21 not in found.lines[np.isfinite(found.values[:, 1])]


def test_one_wrong_time_takes_no_more_memory_than_the_log() -> None:
    """It took 130 bytes a row: with ten million rows more than everything else."""
    t = np.arange(100_000.0)
    t[50_000] = 7.0
    tracemalloc.start()
    try:
        keep, _ = increasing(t)
        assert tracemalloc.get_traced_memory()[1] < 64 * len(t)
    finally:
        tracemalloc.stop()
    np.testing.assert_array_equal(keep, np.delete(np.arange(len(t)), 50_000))


def test_who_listens_hears_how_far_a_file_is_read(tmp_path: Path) -> None:
    said: list[tuple[str, float]] = []
    path = log(tmp_path / "l.csv", 50_000)
    with heard(lambda file, share: said.append((file, share))):
        read_loose(path, ("t",), ",")
    read_loose(path, ("t",), ",")
    shares = [share for _, share in said]
    assert len(said) == 2 and said[0][0] == "reading l.csv" and 0.0 < shares[0] < shares[1] <= 1.0


def test_too_many_rows_are_refused_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(table, "ROWS", 100)
    path = tmp_path / "c.csv"
    path.write_text("t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n" + "0,0,0,0\n" * 101, encoding="utf-8")
    assert status(["simulate", "ohio-kiwi", str(path), "--surface", "paper"]) == 2
    told = capsys.readouterr().err
    assert "more than 100 rows" in told and "SLIPMARGIN_WORK=10" in told and told.count("\n") == 1
    monkeypatch.setenv("SLIPMARGIN_WORK", "10")
    assert len(table.read_columns(path, required=("t_s",)).values) == 101


def test_lines_end_as_anywhere() -> None:
    found = table.columns_from_text("t_s,x_m\r\n1,2\r3,4\n\n5,6", required=("t_s", "x_m"))
    assert found.values.tolist() == [[1, 2], [3, 4], [5, 6]] and found.lines.tolist() == [2, 3, 5]


def test_the_first_rows_of_a_run_hold_a_pose() -> None:
    pose = np.zeros((50, 3))
    pose[:30] = np.nan
    run = Record(name="r", t_s=np.arange(50.0), pose=pose, omega=np.zeros((50, 3)))
    assert run.first() is run
    cut = run.first(10)
    assert len(cut.t_s) == 40 and cut.omega is not None and len(cut.omega) == 40
    with pytest.raises(InputError):
        Record(name="r", t_s=run.t_s[:10], pose=pose[:10])
