"""Faults of the machine: one line, an exit status, nothing half-written."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest

SWEEP = ["sweep", "ohio-kiwi", "--surface", "paper", "--step", "45"]


def run(
    words: list[str], folder: Path, *python: str, most_bytes: int | None = None, **environment: str | None
) -> subprocess.CompletedProcess[str]:
    """A command as its own process; None takes a variable out of the environment."""
    env = {k: v for k, v in (os.environ | environment).items() if v is not None}
    env["PYTHONPATH"] = os.pathsep.join(p or os.getcwd() for p in sys.path)

    def limit() -> None:
        if most_bytes is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most_bytes, most_bytes))

    return subprocess.run(
        [sys.executable, *python, "-m", "slipmargin", *words],
        cwd=folder, env=env, capture_output=True, encoding="utf-8", errors="replace", timeout=300,
        preexec_fn=limit,
    )  # fmt: skip


def one_line(done: subprocess.CompletedProcess[str]) -> str:
    assert done.returncode == 2, done.stderr
    lines = done.stderr.splitlines()
    assert len(lines) == 1 and lines[0].startswith("error: "), done.stderr
    return lines[0]


def test_a_disk_without_room(tmp_path: Path) -> None:
    (tmp_path / "o.csv").write_text("as it was", encoding="utf-8")
    line = one_line(run([*SWEEP, "--out", "o.csv", "--json", "o.json"], tmp_path, most_bytes=64))
    assert "o." in line and "too large" in line
    assert {p.name: p.read_text(encoding="utf-8") for p in tmp_path.iterdir()} == {"o.csv": "as it was"}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full on this system")
def test_a_terminal_without_room(tmp_path: Path) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run(
            [sys.executable, "-m", "slipmargin", *SWEEP],
            stdout=full, stderr=subprocess.PIPE, encoding="utf-8", timeout=300,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)},
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1 and done.stderr.startswith("error: stdout: cannot be written")


@pytest.mark.parametrize(("closed", "status"), [(1, 0), (2, 0)])
def test_a_stream_that_is_closed(closed: int, status: int, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "slipmargin", *SWEEP]
    code = f"import os; os.close({closed}); os.execv({sys.executable!r}, {words!r})"
    env = os.environ | {"PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, env=env, capture_output=True, timeout=300
    )
    assert done.returncode == status and b"Traceback" not in done.stderr


def test_neither_home_nor_locale(tmp_path: Path) -> None:
    """No HOME, a locale without φ, and a cache that cannot be written."""
    words = [*SWEEP, "--out", "o.csv", "--plot", "o.svg"]
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    done = run(words, tmp_path, HOME=None, LANG=None, NUMBA_CACHE_DIR="/proc/no", **plain)
    assert done.returncode == 0, done.stderr
    assert done.stdout.isascii() and "\\u03c6" in done.stdout
    assert sorted(p.name for p in tmp_path.iterdir()) == ["o.csv", "o.svg"]


def test_a_home_that_cannot_be_written(tmp_path: Path) -> None:
    """matplotlib said in two lines where it keeps its fonts instead."""
    words = ["sweep", "omni4", "--surface", "floor", "--step", "45", "--plot", "o.svg"]
    done = run(words, tmp_path, HOME="/proc", XDG_CONFIG_HOME=None, XDG_CACHE_HOME=None, MPLCONFIGDIR=None)
    assert done.returncode == 0 and done.stderr == ""
    assert [p.name for p in tmp_path.iterdir()] == ["o.svg"]


def test_optimised_and_with_warnings_as_errors(tmp_path: Path) -> None:
    done = run([*SWEEP, "--json", "o.json", "--plot", "o.svg"], tmp_path, "-O", "-W", "error")
    assert done.returncode == 0, done.stderr


def test_a_folder_that_is_gone(tmp_path: Path) -> None:
    line = one_line(run([*SWEEP, "--out", str(tmp_path / "gone" / "o.csv")], tmp_path))
    assert "there is no folder" in line


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="there is no /proc on this system")
def test_a_folder_in_which_nothing_can_be_made(tmp_path: Path) -> None:
    one_line(run(["reproduce", "--out", "/proc/here"], tmp_path))
    one_line(run([*SWEEP, "--out", "/proc/o.csv"], tmp_path))
