"""What a killed run leaves beside an output goes with the next run, and nothing of a run that lives."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import pytest

from slipmargin.io.folder import write_folder
from slipmargin.io.stage import NEW, OLD, staged
from slipmargin.io.writes import write_bytes, write_text
from slipmargin.study.pieces import clear

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no locks on folders")


def killed_while_writing(path: Path) -> None:
    """A process that is killed with something of an output written, and its predecessor taken away."""
    child = os.fork()
    if child == 0:
        with staged(path) as stage:
            (stage / NEW).write_text("half", encoding="utf-8")
            if path.exists():
                os.replace(path, stage / OLD)
            os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


def test_the_next_run_sweeps_what_a_killed_one_left(tmp_path: Path) -> None:
    for _ in range(2):
        killed_while_writing(tmp_path / "o.csv")
    assert len(names(tmp_path)) == 1  # the second swept what the first left
    write_text(tmp_path / "o.csv", "whole")
    assert names(tmp_path) == ["o.csv"]


def test_what_a_killed_run_took_away_comes_back(tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "dataset.toml").write_text("kept", encoding="utf-8")
    killed_while_writing(tmp_path / "set")
    assert not (tmp_path / "set").exists()
    with staged(tmp_path / "set"):
        assert (tmp_path / "set" / "dataset.toml").read_text(encoding="utf-8") == "kept"
    assert names(tmp_path) == ["set"]


def test_a_finished_piece_whose_writer_was_killed_leaves_no_folder(tmp_path: Path) -> None:
    """The stage of a piece that was in its place already kept the work folder for ever."""
    folder = tmp_path / "o.csv.work"
    folder.mkdir()
    piece = folder / f"piece-{0:032x}.json"
    killed_while_writing(piece)
    write_bytes(piece.with_name("mine.txt"), b"")
    piece.write_text("{}", encoding="utf-8")
    clear(folder)
    assert names(folder) == ["mine.txt"]


def test_a_run_that_lives_keeps_its_stage(tmp_path: Path) -> None:
    with staged(tmp_path / "o") as first:
        write_folder(tmp_path / "o", {"a": "1"})
        assert first.is_dir()
        with staged(tmp_path / "other.o"), staged(tmp_path / "o") as second:
            assert first.is_dir() and second.is_dir() and first != second
    assert names(tmp_path) == ["o"]
