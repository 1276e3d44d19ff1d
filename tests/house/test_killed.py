"""The script that kills runs: a short run of it, and that it sees what it looks for."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
import killed

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there is no signal 9")


def test_killed_runs_leave_whole_files_and_end_with_the_same_bytes(tmp_path: Path) -> None:
    found = tmp_path / "killed.json"
    words = [sys.executable, killed.__file__, "--count", "46", "--only", "import,import --force"]
    done = subprocess.run([*words, "--json", str(found)], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    counts = json.loads(found.read_text(encoding="utf-8"))["all"]
    assert counts["killed"] >= 1 and counts["killed"] + counts.get("had ended", 0) >= 6


@pytest.mark.parametrize(
    ("left", "fault"),
    [({"o.csv": b"half"}, "half a file"), ({"o.csv.work/piece.json": b'{"rows'}, "half a file"), ({}, None)],
)
def test_half_files_are_seen(
    left: dict[str, bytes], fault: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    good = {"o.csv": b"whole"}

    def again(words: tuple[str, ...], folder: Path) -> int:
        shutil.rmtree(folder / "o.csv.work", ignore_errors=True)
        killed.fill(folder, good)
        return 0

    monkeypatch.setattr(killed, "started", again)
    monkeypatch.setattr(killed, "_ended", int)
    killed.fill(tmp_path, left)
    assert killed.faults(killed.Job(("sweep",)), good, {}, tmp_path) == ([fault] if fault else [])


def test_a_folder_that_vanishes_while_it_is_looked_at_is_no_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A command sweeps its stage while its folder is watched: 1 of 100 watches had ended there."""
    (tmp_path / "stage").mkdir()
    look = os.scandir

    def vanishing(path: str | Path) -> object:
        if Path(path).name == "stage":
            raise FileNotFoundError(path)
        return look(path)

    monkeypatch.setattr(os, "scandir", vanishing)
    assert killed.names(tmp_path) == {"stage"}
