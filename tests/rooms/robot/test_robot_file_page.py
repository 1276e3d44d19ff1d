"""docs/robot-file.md is what the fields of the robot say today."""

from __future__ import annotations

from pathlib import Path

from slipmargin.io.toml_table import parse_toml
from slipmargin.report.robot_file_page import robot_file_page
from slipmargin.robot.fields import keys
from slipmargin.robot.sections import SECTIONS

PAGE = Path(__file__).resolve().parents[3] / "docs" / "robot-file.md"
ROBOTS = Path(__file__).resolve().parents[3] / "slipmargin" / "robots"


def test_page_is_current() -> None:
    cure = "write slipmargin.report.robot_file_page.robot_file_page() to docs/robot-file.md"
    assert PAGE.read_text(encoding="utf-8") == robot_file_page(), cure


def test_every_key_of_the_built_in_robots_has_its_row() -> None:
    text = PAGE.read_text(encoding="utf-8")
    seen = 0
    for path in sorted(ROBOTS.glob("*.toml")):
        held = parse_toml(path.read_text(encoding="utf-8"))
        held["[wheel]"] = held.pop("wheel")[0]
        held["surface.NAME"] = next(iter(held.pop("surface").values()))
        for table, values in held.items():
            if isinstance(values, dict):
                section = text.split(f"\n## `[{table}]`\n")[1].split("\n## ")[0]
                assert all(f"| `{key}` |" in section for key in values), table
                seen += len(values)
    assert seen > 50


def test_every_key_says_what_it_is() -> None:
    for section in SECTIONS:
        for key in keys(section.kind, section.table).values():
            assert key.meaning and len(key.meanings) == len(key.choices), key.name
