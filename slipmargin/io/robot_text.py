"""A recipe as the text of a robot file that reads back to the same recipe."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from slipmargin.effects import AnyEffect, Recipe
from slipmargin.robot import Coefficients, Wheel

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def write_recipe(recipe: Recipe, comment: str = "") -> str:
    """The robot file of a recipe; ``comment`` stands at its top, one ``#`` a line."""
    robot, body = recipe.robot, recipe.robot.body
    lines = [f"# {line}".rstrip() for line in comment.splitlines()]
    lines += ["schema = 1", f"name = {_value(robot.name)}"]
    lines += _section(
        "[body]",
        {
            "mass_kg": body.mass_kg,
            "inertia_kg_m2": body.inertia_kg_m2,
            "com_m": body.com_m,
            "com_height_m": body.com_height_m,
        },
    )
    loads: dict[str, Any] = {"model": robot.load_rule.value}
    if robot.load_fractions is not None:
        loads["fractions"] = robot.load_fractions
    lines += _section("[loads]", loads)
    lines += _section(
        "[friction]",
        {"law": "atan", "k_s_per_m": robot.friction.k_s_per_m, "grip": robot.friction.grip.value},
    )
    if robot.motor is not None:
        motor = {"max_speed_rad_s": robot.motor.max_speed_rad_s}
        if robot.motor.stall_torque_N_m is not None:
            motor["stall_torque_N_m"] = robot.motor.stall_torque_N_m
        lines += _section("[motor]", motor)
    for wheel in robot.wheels:
        lines += _section("[[wheel]]", {key: getattr(wheel, key) for key in Wheel.__slots__})
    for surface in robot.surfaces:
        lines += _section(
            f"[surface.{_key(surface.name)}]",
            {"roller": _pair(surface.roller), "rigid": _pair(surface.rigid)},
        )
    for effect in recipe.effects:
        lines += _tables("effect", effect.to_table())
    return "\n".join(lines) + "\n"


def effect_text(effect: AnyEffect) -> str:
    """One effect as its ``[[effect]]`` table."""
    return "\n".join(_tables("effect", effect.to_table())).strip()


def _pair(c: Coefficients) -> dict[str, float]:
    return {"drive": c.drive, "transverse": c.transverse}


def _section(head: str, values: Mapping[str, Any]) -> list[str]:
    return ["", head, *(f"{_key(key)} = {_value(value)}" for key, value in values.items())]


def _tables(name: str, table: Mapping[str, Any]) -> list[str]:
    """``[[name]]`` with its plain keys, then its lists of tables as ``[[name.key]]``."""
    nested = {k: v for k, v in table.items() if _is_tables(v)}
    lines = _section(f"[[{name}]]", {k: v for k, v in table.items() if k not in nested})
    for key, rows in nested.items():
        for row in rows:
            lines += _tables(f"{name}.{_key(key)}", row)
    return lines


def _is_tables(value: Any) -> bool:
    return isinstance(value, list | tuple) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _value(key)


def _value(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
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
