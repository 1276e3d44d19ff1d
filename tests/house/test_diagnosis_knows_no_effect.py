"""The diagnosis works from what effects say of themselves: it names none of them."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from slipmargin.effects.catalogue import CATALOGUE

SOURCES = sorted((Path(__file__).resolve().parents[2] / "slipmargin" / "diagnosis").glob("*.py"))


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_no_effect_is_imported_or_named(source: Path) -> None:
    names, classes = {e.name for e in CATALOGUE}, {e.__name__ for e in CATALOGUE}
    modules = {e.__module__ for e in CATALOGUE}
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            assert node.module not in modules, f"imports {node.module}"
        if isinstance(node, ast.Import):
            assert not modules & {alias.name for alias in node.names}
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            assert node.value not in names, f"line {node.lineno} names {node.value}"
        if isinstance(node, ast.Name):
            assert node.id not in classes, f"line {node.lineno} names {node.id}"


def test_there_is_something_to_read() -> None:
    assert len(SOURCES) > 20 and len(CATALOGUE) > 20
