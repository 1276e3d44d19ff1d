"""Help has examples that can be typed; terminals get short tables and are told of compilation."""

from __future__ import annotations

import os
import pty
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer
from slipmargin_cli.examples import EXAMPLES
from slipmargin_cli.main import COMMANDS, application, status

import slipmargin as sm

WAY = "x_m,y_m,phi_rad\n0,0,0\n1,0,0\n"
SPEEDS = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s,omega4_rad_s\n0,3,3,3,3\n0.5,0,0,0,0\n"
#: Examples that need a reader's own logs, a browser, the time of a whole search or an option's package.
NOT_RUN = {"diagnose", "next-run", "reproduce", "explore", "monitor"} | {
    name for name in EXAMPLES if name.startswith("import ")
}


def leaves(command: Any, name: str = "") -> dict[str, Any]:
    """Every command that does something: its words → the parser."""
    under = getattr(command, "commands", {})
    if not under:
        return {name: command}
    found: dict[str, Any] = {}
    for word, one in under.items():
        found |= leaves(one, f"{name} {word}".strip())
    return found


def every_command() -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in COMMANDS:
        top = typer.main.get_command(application([name]))
        found |= leaves(top.commands[name], name)  # type: ignore[attr-defined]
    return found


def test_every_command_has_an_example() -> None:
    assert set(every_command()) == set(EXAMPLES)


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_help_ends_with_its_examples(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert status([*name.split(), "--help"]) == 0
    shown = capsys.readouterr().out
    assert all(f"\n    {line}\n" in shown for line in EXAMPLES[name])


@pytest.mark.parametrize("name", ["", "robots", "import", "export", "effects", "surfaces"])
def test_lists_of_commands_are_not_cut(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert status([*name.split(), "--help"]) == 0
    assert "..." not in capsys.readouterr().out.partition("Commands:")[2]


@pytest.mark.parametrize("name", list(EXAMPLES))
def test_the_options_of_an_example_exist(name: str) -> None:
    known = {word for one in every_command()[name].params for word in one.opts}
    for line in EXAMPLES[name]:
        words = shlex.split(line)
        assert words[: 1 + len(name.split())] == ["slipmargin", *name.split()]
        assert {word for word in words if word.startswith("--")} <= known


def test_examples_can_be_typed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a folder with the files that they name, each example does its work."""
    monkeypatch.chdir(tmp_path)
    assert status(["robots", "new", "mybot", "--type", "mecanum"]) == 0
    pulled = sm.sweep("mybot.toml", "floor", to_deg=350.0, step_deg=30.0)
    rows = [f"{a:.4f},{f:.2f}" for a, f in zip(pulled.phi_rad, pulled.f_max_N, strict=True)]
    pulls = "\n".join(["phi_rad,force_N", *rows, ""])
    for name, text in (("way", WAY), ("speeds", SPEEDS), ("pulls", pulls)):
        Path(f"{name}.csv").write_text(text, encoding="utf-8")
    urdf = Path(__file__).parents[2] / "data" / "urdf" / "mecanum.urdf.xacro"
    Path("mybot.urdf.xacro").write_bytes(urdf.read_bytes())
    for name, lines in EXAMPLES.items():
        if name in NOT_RUN or (name == "robots from-urdf" and not _can_read_urdf()):
            continue
        for line in lines:
            words = list(shlex.split(line)[1:])
            if name in {"robots new", "robots from-urdf"}:
                words.append("--force")
            words += ["--out", "other.toml"] if name == "robots from-urdf" else []
            assert status(words) == 0, line


def _can_read_urdf() -> bool:
    from importlib.util import find_spec

    return find_spec("yourdfpy") is not None


@pytest.mark.parametrize(
    "words",
    [
        ["sweep", "ohio-kiwi", "--surface", "paper"],
        ["sweep", "ohio-kiwi", "--surface", "paper", "--to", "360", "--step", "0.5"],
        ["design", "ohio-kiwi", "--surface", "paper", "--vary", "delta_deg=0:60:1", "--static"],
    ],
)
def test_a_terminal_shows_at_most_twelve_rows(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert status(words) == 0
    table = capsys.readouterr().out.rstrip("\n").rpartition("\n\n")[2].split("\n")
    assert len(table) <= 1 + 12 + 1
    said = re.fullmatch(r"(\d+) of (\d+) rows; --out FILE writes all", table[-1])
    assert said is not None and int(said[1]) == len(table) - 2 < int(said[2])


def test_bounds_show_at_most_twelve_directions(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["bounds", "mecanum4", "--surface", "floor"]) == 0
    blocks = capsys.readouterr().out.split("\n\n")
    lines = blocks[1].split("\n")
    assert len(lines) <= 14 and lines[-1].endswith("of 360 rows; --out FILE writes all")
    assert any(line.split()[0] == "45°" for line in lines[1:-1])  # the weakest is always there


CODE = """
import sys
from slipmargin_cli import main
main.announce_compilation()
from slipmargin.physics.compiled import fast
@fast
def double(x):
    return 2.0 * x
for _ in range(2):
    double(1.0)
    double(1)
"""


def test_compilation_is_announced_once_on_a_terminal(tmp_path: Path) -> None:
    """With an empty cache one line is said; with nobody at a terminal none."""
    script = tmp_path / "once.py"
    script.write_text(CODE, encoding="utf-8")
    quiet = _run(script, tmp_path / "one", terminal=False)
    assert quiet == ""
    assert _run(script, tmp_path / "two", terminal=True).count("compiling once, about 10 s") == 1


def _run(script: Path, cache: Path, *, terminal: bool) -> str:
    ours, theirs = pty.openpty() if terminal else (-1, subprocess.PIPE)
    env = {
        **os.environ,
        "NUMBA_CACHE_DIR": str(cache),
        "PYTHONPATH": os.pathsep.join(p for p in sys.path if p),
    }
    done = subprocess.run([sys.executable, str(script)], stderr=theirs, env=env, timeout=120, check=True)
    if not terminal:
        return done.stderr.decode()
    os.close(theirs)
    try:
        return os.read(ours, 4096).decode()
    except OSError:
        return ""
    finally:
        os.close(ours)
