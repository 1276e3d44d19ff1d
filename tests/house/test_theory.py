"""docs/theory.md: its examples run, and whoever cites it points to a section that exists."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "theory.md"
TEXT = PAGE.read_text(encoding="utf-8")
SECTIONS = {int(n) for n in re.findall(r"^## (\d+)\. ", TEXT, flags=re.MULTILINE)}
#: The only form in which the page is cited: what a reader can follow, and this test can check.
CITATION = re.compile(r"docs/theory\.md, sections? (\d+)(?: and (\d+))?")
#: Every way in which a section of the page has been named.
MENTION = re.compile(r"\btheory(?:\.md| notes)?[,:]? (?:sections? \d|three grip)", flags=re.IGNORECASE)
FOLDERS = ("slipmargin", "cli", "tests", "benchmarks", "notebooks", "docs")


def joined(path: Path) -> str:
    """A file's text with each line break and what it begins a line with as one space: citations wrap."""
    return re.sub(r"\s*\n\s*(?:#:? ?)?", " ", path.read_text(encoding="utf-8"))


def citing() -> list[Path]:
    files = [
        p for folder in FOLDERS for p in (ROOT / folder).rglob("*") if p.suffix in {".py", ".md", ".toml"}
    ]
    mine = {PAGE, Path(__file__).resolve()}
    return sorted(p for p in files if p.resolve() not in mine and MENTION.search(joined(p)))


def examples() -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", TEXT, flags=re.DOTALL | re.MULTILINE)


def test_the_examples_of_the_page_print_what_stands_there(capsys: pytest.CaptureFixture[str]) -> None:
    session = doctest.DocTestParser().get_doctest("\n".join(examples()), {}, PAGE.name, str(PAGE), 0)
    assert len(session.examples) > 40
    with np.printoptions():
        failed = doctest.DocTestRunner(verbose=False).run(session).failed
    assert not failed, capsys.readouterr().out


def test_every_python_block_is_an_example() -> None:
    for block in examples():
        assert block.startswith(">>> ") and block.endswith("\n\n"), f"not run by the test: {block[:60]}"


def test_sections_are_numbered_without_gaps() -> None:
    assert sorted(SECTIONS) == list(range(1, len(SECTIONS) + 1))
    listed = {int(n) for n in re.findall(r"\[(\d) [^\]]+\]\(#", TEXT)}
    assert listed == SECTIONS


@pytest.mark.parametrize("path", citing(), ids=lambda p: str(p.relative_to(ROOT)))
def test_who_cites_the_page_names_a_section_that_exists(path: Path) -> None:
    text = joined(path)
    for found in MENTION.finditer(text):
        cited = CITATION.match(text, found.start() - len("docs/"))
        assert cited, f"write 'docs/theory.md, section n': …{text[found.start() - 20 : found.end() + 20]}…"
        assert {int(n) for n in cited.groups() if n} <= SECTIONS, f"no such section: {cited[0]}"


def test_tests_that_the_page_names_exist() -> None:
    named = set(re.findall(r"`((?:tests|slipmargin|benchmarks)/[\w/]+\.py)`", TEXT))
    assert named and all((ROOT / name).is_file() for name in named), named
