"""Documents that run, and files that can be read."""

from __future__ import annotations

import ast
import doctest
import importlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
from robotino import WEIGHED_KG

sys.path.insert(0, str(Path(__file__).resolve().parent))
from slipmargin_cli.main import COMMANDS, status

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
#: The README and every page of the site that is kept in the repository.
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SOURCES = sorted([*(ROOT / "slipmargin").rglob("*.py"), *(ROOT / "cli").rglob("*.py")])
LONGEST = 400
#: Pages whose examples a test of their own runs: the theory is one session, the other needs a file.
RUN_ELSEWHERE = {"theory.md", "check-in-ci.md"}
LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)#]+)(?:#[^)]*)?\)")


def blocks(language: str) -> list[tuple[Path, str]]:
    """Each page with all its blocks in a language, one after the other: they run as one session."""
    found = []
    for page in PAGES:
        parts = re.findall(
            rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE
        )
        if parts and page.name not in RUN_ELSEWHERE and (page.name, language) != ("README.md", "console"):
            found.append((page, "".join(parts)))
    return found


def page_id(value: object) -> str:
    return name_of(value) if isinstance(value, Path) else ""


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


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_lead_somewhere(page: Path) -> None:
    made = {ROOT / "docs" / "reference" / name for name in ("help.md", "python.md")}  # when the site is built
    broken = []
    for link in LINK.findall(page.read_text(encoding="utf-8")):
        target = (page.parent / link).resolve()
        if target.suffix == ".ipynb":  # notebooks of the site are made from the scripts
            target = ROOT / "notebooks" / f"{target.stem}.py"
        if not target.exists() and target not in made:
            broken.append(link)
    assert not broken, broken


def test_the_page_of_commands_names_every_command() -> None:
    page = (ROOT / "docs" / "reference" / "commands.md").read_text(encoding="utf-8")
    missing = [name for name in COMMANDS if f"slipmargin {name}" not in page]
    assert not missing, f"not on the page: {', '.join(missing)}"


@pytest.mark.parametrize(("page", "block"), blocks("console"), ids=page_id)
def test_console_blocks_show_real_output(
    page: Path,
    block: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Each ``$ slipmargin`` of a page prints what stands below it; a line ``…`` stands for more."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    for shown in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        command, _, expected = shown.partition("\n")
        words = shlex.split(command, comments=True)
        if words[0] in {"printf", "cat"}:  # how the reader makes an input file, and looks at an output
            done = subprocess.run(
                command, shell=True, cwd=tmp_path, check=True, timeout=60, capture_output=True, text=True
            )
            printed = done.stdout.splitlines()
        elif words[0] == "slipmargin":
            assert status(words[1:]) == 0, command
            printed = capsys.readouterr().out.splitlines()
        else:
            continue
        assert shows(expected, printed)


def shows(expected: str, printed: list[str]) -> bool:
    """Whether lines were printed as a page shows them; a line ``…`` stands for any number of lines."""
    parts = re.split(r"^…$", expected.strip("\n"), flags=re.MULTILINE)
    pattern = r"(?:.*\n)*?".join(
        re.escape(part.strip("\n") + "\n" if part.strip("\n") else "") for part in parts
    )
    return re.fullmatch(pattern, "".join(f"{line}\n" for line in printed)) is not None


def test_the_first_lines_of_the_readme_work_as_printed(tmp_path: Path) -> None:
    """From a fresh copy, in a shell, with nothing on the path but what the lines themselves put there."""
    activate = Path(sys.prefix) / "bin" / "activate"
    if not activate.is_file():
        pytest.skip("not in a virtual environment")
    copy = tmp_path / "slipmargin"
    for file in tracked():
        target = copy / file.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, target)
    (copy / ".venv").mkdir()
    (copy / ".venv" / "bin").symlink_to(activate.parent)
    (copy / ".venv" / "installed").touch()  # what `make install` makes, after half a minute of downloads
    text = "".join(re.findall(r"^```console\n(.*?)^```", README, flags=re.DOTALL | re.MULTILINE))
    shown = [part.partition("\n") for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]]
    mark = "---8<---"
    script = "set -e\n" + "".join(f"echo '{mark}'\n{command}\n" for command, _, _ in shown)
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "COLUMNS": "80", "LANG": "C.UTF-8"}
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=copy,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    for (command, _, expected), printed in zip(shown, done.stdout.split(f"{mark}\n")[1:], strict=True):
        assert command.startswith("make ") or shows(expected, printed.splitlines()), f"{command}\n{printed}"


def test_three_robots_from_nothing_to_an_exported_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the README alone: each row of its table makes a file for a tool in at most four commands."""
    rows = re.findall(r"^\| (LeKiwi|FTC mecanum|RoboCup SSL) \| (.+) \|$", README, flags=re.MULTILINE)
    assert len(rows) == 3
    for name, cell in rows:
        commands = [shlex.split(line) for line in re.findall(r"`(slipmargin [^`]+)`", cell)]
        assert 1 <= len(commands) <= 4 and "--export" in commands[-1]
        folder = tmp_path / name.replace(" ", "-")
        folder.mkdir()
        monkeypatch.chdir(folder)
        for words in commands:
            assert status(words[1:]) == 0, words
        assert Path(commands[-1][-1]).read_text(encoding="utf-8").strip()


@pytest.mark.parametrize("page", [*PAGES, *sorted((ROOT / "notebooks").glob("*.py"))], ids=page_id)
def test_sentences_are_short(page: Path) -> None:
    """Half of the sentences of a page and of a notebook have fewer than twenty words.

    What else the site has is made of docstrings and of help texts.
    """
    pytest.importorskip("pysbd")
    from reading import median_words, notebook_prose

    text = page.read_text(encoding="utf-8")
    assert median_words(notebook_prose(text) if page.suffix == ".py" else text) < 20


#: Files that the site does not link: the glossary itself, and pages that are outside the site.
SITE = [page for page in PAGES if page.name not in {"README.md", "glossary.md"}]


def terms_module() -> ModuleType:
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        return importlib.import_module("terms")
    finally:
        sys.path.remove(str(ROOT / "docs"))


@pytest.mark.parametrize("page", SITE, ids=page_id)
def test_terms_are_linked_where_a_page_first_uses_them(page: Path) -> None:
    """As the site is built: the first use of every term in running text leads to the glossary."""
    made = terms_module()
    text = made.linked(page.read_text(encoding="utf-8"), "")
    anchors = set(
        re.findall(
            r'id="(term-[a-z-]+)"', made.anchored((ROOT / "docs/glossary.md").read_text(encoding="utf-8"))
        )
    )
    targets = re.findall(r"glossary\.md#(term-[a-z-]+)", text)
    assert set(targets) <= anchors and len(targets) == len(set(targets))
    left = {made.terms()[term] for term, _, _ in made.first_uses(page.read_text(encoding="utf-8"))}
    assert left == set(targets)


def test_the_readme_uses_no_term_before_it_is_explained() -> None:
    """No word of the glossary stands in the README's prose without a link."""
    assert not terms_module().first_uses(README)


def test_a_term_is_linked_once_and_never_in_code() -> None:
    made = terms_module()
    page = "# Load transfer\n\n`load transfer` and load transfer, then load transfer.\n"
    link = "[load transfer](../glossary.md#term-load-transfer)"
    wanted = f"# Load transfer\n\n`load transfer` and {link}, then load transfer.\n"
    assert made.linked(page, "../") == wanted


def test_long_sentences_would_be_found() -> None:
    pytest.importorskip("pysbd")
    from reading import median_words

    long = "This sentence goes on " + "and on " * 10 + "until nobody knows where it began."
    assert median_words(f"# A page\n\n{long} {long} It is short.\n") > 20
    assert median_words("```\n" + "code " * 40 + "\n```\n\n| a | table |\n\nIt is short.\n") == 3


def test_the_readme_is_short_and_its_figures_are_measured() -> None:
    prose = re.sub(r"^```.*?^```", "", README, flags=re.DOTALL | re.MULTILINE)
    assert len(prose.split()) < 900
    result = json.loads((ROOT / "benchmarks/results/robotino.json").read_text(encoding="utf-8"))
    rows = result["rows"]
    errors = {row["model"]: 100 * row["errors"]["held out"]["displacement"] for row in rows}
    first, scaled, last = (rows[i]["model"] for i in (0, 1, -1))
    assert f"{errors[first]:.0f} % of the distance" in README and f"{errors[last]:.1f} % off" in README
    assert f"{errors[scaled]:.1f} % with its scale refitted" in README
    loads = [result["physical"][f"load on wheel {i} [kg]"] for i in (1, 2, 3)]
    one, two, three = (load["value"] for load in loads)
    assert f"{one:.2f}, {two:.2f} and {three:.2f} kg" in README
    for load, weighed in zip(loads, WEIGHED_KG, strict=True):
        assert load["low"] <= weighed <= load["high"] and f"{weighed:.3f}" in README


def test_the_story_of_the_real_robot_tells_measured_figures() -> None:
    page = (ROOT / "docs/explanation/real-robot.md").read_text(encoding="utf-8")
    result = json.loads((ROOT / "benchmarks/results/robotino.json").read_text(encoding="utf-8"))
    errors = result["rows"][-1]["errors"]
    shown = [f"{100 * errors[part]['displacement']:.1f} %" for part in ("fitted", "headings", "speed")]
    held = errors["held out"]
    shown.append(f"**{100 * held['displacement']:.2f} %** | {held['heading_deg']:.1f}°")
    assert " | ".join(shown) in page and f"{100 * held['length']:.2f} % off in length alone" in page
    for of_run in result["standing"].values():
        current = of_run["current of wheels 1 and 3 [A]"]
        too_far = (of_run["predicted too far [%]"], of_run["the headings beside it, mean [%]"])
        row = f"| {current:.2f} | {too_far[0]:+.1f} % | {too_far[1]:+.1f} % |".replace("-", "−")
        assert row in page
    without = errors["held out but heading_000 at 0.2 m/s"]["displacement"]
    assert f"Without the last of them the held-out error is {100 * without:.2f} %" in page
    before, after = result["limits"]["before"], result["limits"]["after"]
    weakest, least = "weakest pull [μ m g]", "least acceleration from rest [μ g]"
    assert f"weakest pull is {before[weakest]:.2f} before and {after[weakest]:.2f} after" in page
    assert f"from rest is {before[least]:.2f} μ g before and {after[least]:.2f} μ g after" in page
    currents = [result["currents"][f"wheel {i}: correlation"] for i in (1, 2, 3)]
    assert "correlations of {:.3f}, {:.3f} and {:.3f}".format(*currents) in page
    over_gear = [result["currents"][f"wheel {i}: drive coefficient over gear efficiency"] for i in (1, 2, 3)]
    steps = (ROOT / "notebooks/real_data.py").read_text(encoding="utf-8")
    assert f"coefficient is about {sum(over_gear) / 3:.1f} times the gear" in steps


@pytest.mark.parametrize(("page", "block"), blocks("python"), ids=page_id)
def test_python_blocks_show_real_answers(
    page: Path,
    block: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    test = doctest.DocTestParser().get_doctest(block, {}, page.name, str(page), 0)
    done = doctest.DocTestRunner(verbose=False).run(test)
    assert done.attempted > 0 and done.failed == 0, capsys.readouterr().out


@pytest.mark.parametrize("name", ["benchmarks", "constants"])
def test_the_pages_of_benchmarks_are_what_their_script_makes(name: str) -> None:
    done = subprocess.run(
        [sys.executable, "benchmarks/page.py", name],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    assert done.stdout == (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")


def test_the_scripts_of_pictures_name_what_there_is() -> None:
    """docs/pictures.py imported a function that had been removed, and no picture could be drawn again."""
    script = ast.parse((ROOT / "docs" / "pictures.py").read_text(encoding="utf-8"))
    taken = [node for node in ast.walk(script) if isinstance(node, ast.ImportFrom)]
    ours = [node for node in taken if (node.module or "").startswith("slipmargin")]
    assert len(ours) >= 3
    for node in ours:
        module = importlib.import_module(node.module or "")
        assert [name.name for name in node.names if not hasattr(module, name.name)] == []


def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    """As ``make docs`` does, with notebooks that were not run."""
    pytest.importorskip("mkdocs")
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    shutil.copytree(ROOT / "docs", tmp_path / "docs", ignore=shutil.ignore_patterns("notebooks"))
    (tmp_path / "docs" / "notebooks").mkdir()
    for notebook in sorted((ROOT / "notebooks").glob("*.py")):
        target = tmp_path / "docs" / "notebooks" / f"{notebook.stem}.ipynb"
        make = [
            sys.executable,
            "-m",
            "jupytext",
            "--quiet",
            "--to",
            "ipynb",
            "--output",
            str(target),
            str(notebook),
        ]
        subprocess.run(make, check=True, timeout=60, capture_output=True)
    build = [sys.executable, "-m", "mkdocs", "build", "--quiet"]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONWARNINGS": "ignore"}
    done = subprocess.run(
        build, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300, env=environment
    )
    assert done.returncode == 0, done.stdout + done.stderr
    pages = list((tmp_path / "site").rglob("*.html"))
    assert len(pages) > 20
    other_hosts = [
        f"{page.name}: {link}"
        for page in pages
        for link in re.findall(
            r'<(?:script|link|img)[^>]+(?:src|href)="(https?://[^"]+)"', page.read_text("utf-8")
        )
    ]
    assert not other_hosts, other_hosts


def test_what_the_fuzz_found_is_told() -> None:
    found = json.loads((ROOT / "benchmarks" / "results" / "fuzz.json").read_text(encoding="utf-8"))
    cases = sum(sum(counts.values()) for counts in found["counts"].values())
    kinds = [case["what"] for case in found["bad"]]
    said = " ".join((ROOT / "SECURITY.md").read_text(encoding="utf-8").split())
    assert cases == found["next"]
    assert f"with {len(kinds)} of its {cases // 1000} {cases % 1000:03d} inputs" in said
    assert f"{kinds.count('hang')} took longer than 20 s, {kinds.count('internal')} met a defect" in said
