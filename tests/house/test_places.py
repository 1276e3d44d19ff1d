"""CONTRIBUTING's table "One idea, one place": the places exist and hold what the table says."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TEXT = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
SECTION = TEXT.partition("## One idea, one place")[2].partition("\n## ")[0]
FOUND = re.findall(r"^\| ([^|]+) \| `([^`]+)`(?:: ([\w, ]+))?", SECTION, flags=re.MULTILINE)
ROWS = [(idea, place, names.strip()) for idea, place, names in FOUND]
#: Functions and classes of the physics room in the table (a constant's name may be used for something else).
SHARED = sorted(
    {
        name
        for _, place, names in ROWS
        for name in names.split(", ")
        if place.startswith("slipmargin/physics/") and name and not name.isupper()
    }
)
#: The same name for another idea: limits of many designs with all wheels on rigid material.
HOMONYMS = {"on_rigid": {"slipmargin/study/statics.py"}}


def defined(path: Path) -> set[str]:
    """The names that a module defines at its top."""
    found: set[str] = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        targets = node.targets if isinstance(node, ast.Assign) else []
        found |= {name.id for name in targets if isinstance(name, ast.Name)}
    return found


def test_the_table_is_read() -> None:
    assert len(ROWS) >= 15
    for idea in (
        "kinematics",
        "frames",
        "friction laws",
        "wheel loads",
        "rigid sectors",
        "F_emax",
        "chi",
        "robot",
    ):
        assert any(idea in row[0] for row in ROWS), idea


@pytest.mark.parametrize(("idea", "place", "names"), ROWS, ids=[row[0][:30] for row in ROWS])
def test_each_idea_is_where_the_table_says(idea: str, place: str, names: str) -> None:
    assert (ROOT / place).is_file(), f"{idea}: {place} is not there"
    if names:
        wanted = set(names.split(", "))
        assert wanted <= defined(ROOT / place), f"{place} lacks {', '.join(wanted - defined(ROOT / place))}"


@pytest.mark.parametrize("name", SHARED)
def test_no_other_module_defines_it_again(name: str) -> None:
    homes = {place for _, place, names in ROWS if name in names.split(", ")} | HOMONYMS.get(name, set())
    others = [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / "slipmargin").rglob("*.py"))
        if name in defined(path) and str(path.relative_to(ROOT)) not in homes
    ]
    assert not others, f"{name} is defined again in {', '.join(others)}"
