"""The worked examples of docs/how-to/three-robots.md: what their commands print, and the files they write."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
from slipmargin_cli.main import status

ROOT = Path(__file__).parents[3]
ROBOTS = ROOT / "tests" / "data" / "robots"
PAGE = (ROOT / "docs" / "how-to" / "three-robots.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```text\n\$ slipmargin (.*?)\n(.*?)…\nwritten: (.*?)\n```", PAGE, flags=re.S)
NUMBER = r"-?\d+(?:\.\d+)?"


def same(one: str, other: str) -> None:
    """Words alike, numbers to a unit of their last printed digit or two parts in a thousand."""
    assert re.sub(NUMBER, "#", one) == re.sub(NUMBER, "#", other)
    ours, theirs = ([float(n) for n in re.findall(NUMBER, text)] for text in (one, other))
    assert ours == pytest.approx(theirs, rel=2e-3, abs=1e-4)


@pytest.mark.parametrize(("command", "printed", "file"), BLOCKS, ids=[b[2] for b in BLOCKS])
def test_the_page_says_what_the_command_does(
    command: str,
    printed: str,
    file: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = shlex.split(command)
    shutil.copy(ROBOTS / words[1], tmp_path)
    monkeypatch.chdir(tmp_path)
    assert status(words) == 0
    same(capsys.readouterr().out.split("\n\n")[0], printed.rstrip())
    written = (tmp_path / file).read_text(encoding="utf-8")
    same(written, (ROBOTS / file).read_text(encoding="utf-8"))
    assert (ROBOTS / file).read_text(encoding="utf-8").rstrip() in PAGE


def test_there_are_three() -> None:
    assert len(BLOCKS) == 3
