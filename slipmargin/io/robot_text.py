"""A recipe as the text of a robot file that reads back to the same recipe."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from enum import Enum
from typing import Any

import numpy as np

from slipmargin.effects import AnyEffect, Recipe
from slipmargin.robot import Surface, Uncertain, UncertainArray
from slipmargin.robot.fields import Kind, keys
from slipmargin.robot.sections import SECTIONS

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def write_recipe(recipe: Recipe, comment: str = "") -> str:
    """The robot file of a recipe; ``comment`` stands at its top, one ``#`` a line."""
    robot = recipe.robot
    lines = [f"# {_printable(line)}".rstrip() for line in comment.splitlines()]
    lines += ["schema = 1", *_lines(_keys(robot))]
    for section in SECTIONS[1:]:
        found = getattr(robot, section.path) if section.path else robot
        for thing in found if isinstance(found, tuple) else [found] if found is not None else []:
            heading = section.heading
            if isinstance(thing, Surface):
                heading = heading.replace("NAME", _key(thing.name))
            lines += ["", heading, *_lines(_keys(thing, section.table))]
    for effect in recipe.effects:
        lines += _tables("effect", effect.to_table())
    return "\n".join(lines) + "\n"


def effect_text(effect: AnyEffect) -> str:
    """One effect as its ``[[effect]]`` table."""
    return "\n".join(_tables("effect", effect.to_table())).strip()


def _keys(thing: Any, table: str = "") -> dict[str, Any]:
    """File key → value of the keys of a part of the robot that stand in ``table`` and are set."""
    found = {}
    for field, key in keys(type(thing), table).items():
        value = getattr(thing, field)
        if value is not None:
            found[key.name] = _keys(value) if key.kind is Kind.TABLE else value
    return found


def _lines(values: Mapping[str, Any]) -> list[str]:
    return [f"{_key(key)} = {_value(value)}" for key, value in values.items()]


def _tables(name: str, table: Mapping[str, Any]) -> list[str]:
    """``[[name]]`` with its plain keys, then its lists of tables as ``[[name.key]]``."""
    nested = {k: v for k, v in table.items() if _is_tables(v)}
    lines = ["", f"[[{name}]]", *_lines({k: v for k, v in table.items() if k not in nested})]
    for key, rows in nested.items():
        for row in rows:
            lines += _tables(f"{name}.{_key(key)}", row)
    return lines


def _is_tables(value: Any) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _printable(text: str) -> str:
    """The text without control characters, which no comment of a TOML file may hold."""
    return "".join(c if c.isprintable() or c == "\t" else " " for c in text)


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _value(key)


def quoted(text: str) -> str:
    """Text as TOML writes it, whatever stands in it."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, Uncertain):
        value = value.written()
    if isinstance(value, UncertainArray):
        value = list(value.each)
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, np.ndarray):
        return _value(value.tolist())
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    assert isinstance(value, Iterable), f"{value!r} has no form in a robot file"
    return "[" + ", ".join(_value(v) for v in value) + "]"
