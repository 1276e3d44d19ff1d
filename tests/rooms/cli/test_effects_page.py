"""docs/effects.md is what the catalogue says today."""

from __future__ import annotations

from pathlib import Path

import pytest
from slipmargin_cli.main import status

from slipmargin.effects.catalogue import CATALOGUE

PAGE = Path(__file__).resolve().parents[3] / "docs" / "effects.md"


def test_page_is_current(capsys: pytest.CaptureFixture[str]) -> None:
    assert status(["effects", "list", "--markdown"]) == 0
    said = capsys.readouterr().out
    written = PAGE.read_text(encoding="utf-8")
    assert said == written, "run: slipmargin effects list --markdown > docs/effects.md"


def test_every_effect_has_its_section() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for effect in CATALOGUE:
        section = text.split(f"\n## {effect.name}\n")[1].split("\n## ")[0]
        assert effect.source in section and effect.confirm in section
        assert all(f"| `{p.name}` |" in section for p in effect.parameters)
