"""Documents that run, and files that can be read."""

from __future__ import annotations

import ast
import doctest
import json
import re
import shlex
import subprocess
from pathlib import Path

import pytest
from slipmargin_cli.main import COMMANDS, status

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SOURCES = sorted([*(ROOT / "slipmargin").rglob("*.py"), *(ROOT / "cli").rglob("*.py")])
LONGEST = 400
PYTHON = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
CONSOLE = re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL)


def tracked() -> list[Path]:
    try:
        done = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True, timeout=60
        )
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a git checkout")
    return [ROOT / name for name in done.stdout.split("\0") if name and (ROOT / name).is_file()]


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_files_stay_readable(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").count("\n")
    assert lines <= LONGEST, f"{lines} lines: split it"


Visible = ast.FunctionDef | ast.ClassDef


def public(body: ast.Module | ast.ClassDef, prefix: str = "") -> list[tuple[str, Visible]]:
    """Functions and classes that a user sees, and the methods of those classes."""
    found: list[tuple[str, Visible]] = []
    for node in body.body:
        if isinstance(node, Visible) and not node.name.startswith("_"):
            found.append((prefix + node.name, node))
            if isinstance(node, ast.ClassDef):
                found += public(node, f"{node.name}.")
    return found


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_everything_public_says_what_it_is(path: Path) -> None:
    module = ast.parse(path.read_text(encoding="utf-8"))
    silent = [] if ast.get_docstring(module) or not module.body else ["the module"]
    silent += [name for name, node in public(module) if not ast.get_docstring(node)]
    assert not silent, f"no docstring: {', '.join(silent)}"


def test_no_path_of_a_machine_is_in_the_tree() -> None:
    pattern = re.compile(r"(?<![\w.])/(?:work|home|root|Users)/\w|[A-Z]:\\Users")
    broken = []
    for path in tracked():
        if path == Path(__file__).resolve() or path.suffix in {".png", ".svg", ".pdf"}:
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        broken += [f"{name_of(path)}: {match[0]}" for match in pattern.finditer(text)]
    assert not broken, "; ".join(broken)


def test_the_readme_names_every_command() -> None:
    missing = [name for name in COMMANDS if f"slipmargin {name}" not in README]
    assert not missing, f"not in the README: {', '.join(missing)}"


@pytest.mark.parametrize("link", sorted(set(re.findall(r"\]\((?!https?:|#)([^)]+)\)", README))))
def test_links_of_the_readme_lead_somewhere(link: str) -> None:
    assert (ROOT / link).exists()


@pytest.mark.parametrize("block", CONSOLE, ids=range(len(CONSOLE)))
def test_the_readme_shows_real_output(
    block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Each ``$ slipmargin`` of a console block prints what stands below it; a line ``…`` stands for more."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    for shown in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, expected = shown.partition("\n")
        words = shlex.split(command, comments=True)
        if words[0] == "printf":  # how the reader makes an input file
            subprocess.run(command, shell=True, cwd=tmp_path, check=True, timeout=60)
        if words[0] != "slipmargin":
            continue
        assert status(words[1:]) == 0, command
        printed = capsys.readouterr().out.splitlines()
        wanted = expected.rstrip("\n").splitlines()
        if "…" in wanted:
            head = wanted[: wanted.index("…")]
            tail = wanted[wanted.index("…") + 1 :]
            assert printed[: len(head)] == head and (not tail or printed[-len(tail) :] == tail)
        else:
            assert printed == wanted


@pytest.mark.parametrize("block", PYTHON, ids=range(len(PYTHON)))
def test_the_readme_shows_real_answers(
    block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    test = doctest.DocTestParser().get_doctest(block, {}, "README.md", "README.md", 0)
    done = doctest.DocTestRunner(verbose=False).run(test)
    assert done.attempted > 0 and done.failed == 0, capsys.readouterr().out


def test_the_readme_says_what_the_engine_with_rollers_showed() -> None:
    rows = json.loads((ROOT / "benchmarks/results/rollers.json").read_text(encoding="utf-8"))
    starts = [row["slips"] for row in rows if "slips" in row]
    loads = [row[floor]["worst_percent"] for row in rows if "level" in row for floor in ("level", "slope")]
    assert all(not slips["0.95"] and slips["1.05"] for slips in starts)
    assert f"all {len(starts)} (`rollers.json`)" in README
    assert f"within {max(loads):.1f} % of m g / N (`rollers.json`)" in README
