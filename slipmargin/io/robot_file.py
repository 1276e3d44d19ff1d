"""A robot file, read strictly: what it does not name does not exist, what it misnames is an error.

Places in errors are keys as in the file; wheels and effects are counted from 1, so
``wheel[2].radius_m`` is the key ``radius_m`` of the second ``[[wheel]]``.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.io.effect_table import read_effect
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import Table, document, nearest, one_of
from slipmargin.robot import Body, FrictionLaw, LoadRule, Motor, Robot, Surface, Wheel
from slipmargin.robot.fields import Kind, keys
from slipmargin.robot.library import LIBRARY, published
from slipmargin.robot.mistakes import refuse_impossible

T = TypeVar("T")
_BUILT_IN = Path(__file__).resolve().parent.parent / "robots"


def built_in_names() -> tuple[str, ...]:
    """The names of the robots that come with the package, sorted."""
    return tuple(sorted(path.stem for path in _BUILT_IN.glob("*.toml")))


def robot_text(robot: Path | str) -> tuple[str, str]:
    """The text of a robot file, or of a built-in robot, and what to call it in errors.

    Raises
    ------
    InputError
        Where it is neither a file nor a built-in name.
    """
    name = str(robot)
    if isinstance(robot, str) and name in built_in_names():
        return read_text(_BUILT_IN / f"{name}.toml"), f"built-in robot {name}"
    try:
        return read_text(Path(robot)), name
    except InputError as fault:
        if not isinstance(robot, str) or fault.problem != "there is no such file":
            raise
        known = ", ".join(built_in_names())
        guess = nearest(name, built_in_names())
        raise InputError(
            "",
            "there is no such file and no built-in robot of that name",
            f"did you mean {guess!r}?" if guess else f"give a file or one of: {known}",
            name or "ROBOT",
        ) from None


def read_recipe(robot: Path | str) -> Recipe:
    """The robot, with the effects its file lists.

    Parameters
    ----------
    robot : path or str
        A file; a ``str`` may also be the name of a built-in robot, which then wins.

    Raises
    ------
    InputError
        With file, key (or ``line:column``), what is wrong and what to do.
    """
    text, source = robot_text(robot)
    try:
        return recipe_from_text(text)
    except InputError as fault:
        raise fault.in_file(source) from None


def recipe_from_text(text: str) -> Recipe:
    """The robot and effects that the text of a robot file describes.

    Raises
    ------
    InputError
        With key or ``line:column``, what is wrong and what to do.
    """
    top = document(text, "`slipmargin robots new NAME --type T` writes one to start from")
    body = _part(top.table("body", "add a [body] table with mass_kg and inertia_kg_m2"), Body)
    loads = _values(top.table("loads", ""), Robot, "loads") if top.has("loads") else {}
    if body.com_height_m > 0.0:
        loads.setdefault("load_rule", LoadRule.QUASI_STATIC)
    friction = _part(top.table("friction", ""), FrictionLaw) if top.has("friction") else FrictionLaw()
    motor = _part(top.table("motor", ""), Motor) if top.has("motor") else None
    wheels = tuple(_part(table, Wheel) for table in top.tables("wheel"))
    surfaces = _surfaces(top, any(w.rigid_fraction > 0.0 for w in wheels))
    effect_tables = top.tables("effect")
    robot = Robot(
        body=body,
        wheels=wheels,
        surfaces=surfaces,
        friction=friction,
        motor=motor,
        **loads,
        **_values(top, Robot),
    )
    refuse_impossible(robot)
    _check_stands(robot)
    recipe = Recipe(
        robot=robot,
        effects=tuple(read_effect(table, tuple(w.name for w in wheels)) for table in effect_tables),
    )
    for surface in surfaces:
        _check_builds(recipe, surface.name)
    return recipe


def _part(table: Table, kind: type[T], **more: Any) -> T:
    """The part of a robot that a table describes; ``more`` are its fields that are no keys.

    Raises
    ------
    InputError
        Placed at a key that is missing, unknown or refused.
    """
    values = _values(table, kind)
    try:
        return kind(**values, **more)
    except InputError as fault:
        raise fault.within(table.place) from None


def _values(table: Table, kind: type, section: str = "") -> dict[str, Any]:
    """Field → value of the keys that a table holds; the dataclass checks the values."""
    found: dict[str, Any] = {}
    for field, key in keys(kind, section).items():
        if not table.has(key.name) and not key.required:
            continue
        if key.kind is Kind.WORD:
            found[field] = key.from_word(table.word(key.name, key.choices))
        elif key.kind is Kind.TABLE:
            assert key.of is not None
            found[field] = _part(table.table(key.name, key.cure), key.of)
        else:
            found[field] = table.take(key.name, key.cure)
    table.done()
    return found


def _surfaces(top: Table, sectors: bool) -> tuple[Surface, ...]:
    cure = "add a [surface.NAME] table with roller and rigid"
    found = top.table("surface", cure).raw()
    if not found:
        raise InputError("surface", "no surface is described", cure)
    tables = {
        name: Table(f"surface.{name}", _from_library(f"surface.{name}", value, sectors))
        for name, value in found.items()
    }
    return tuple(_part(table, Surface, name=name) for name, table in tables.items())


def _from_library(place: str, raw: Any, sectors: bool) -> Any:
    """A surface's table with what its published surface gives, under what the table itself gives.

    Without rigid sectors nothing asks for coefficients of rigid material: those of the roller stand there.
    """
    if not isinstance(raw, dict) or "library" not in raw:
        return raw
    names = [entry.name for entry in LIBRARY]
    entry = published(one_of(f"{place}.library", raw["library"], names))
    assert entry is not None
    for key in ("roller", "rigid"):
        if key in raw and not isinstance(raw[key], dict):
            cure = f"write {key} = {{ drive = …, transverse = … }}, or leave it to the library"
            raise InputError(f"{place}.{key}", f"is {raw[key]!r}, not a table", cure)
    own = {key: value for key, value in raw.items() if isinstance(value, dict)}
    made = {key: {**entry.tables().get(key, {}), **own.get(key, {})} for key in ("roller", "rigid")}
    for name in entry.missing:
        if name not in made["roller"]:
            raise InputError(
                f"{place}.roller.{name}",
                f"is not published for {entry.name!r}",
                f"measure it and write roller = {{ {name} = … }} (docs/how-to/measure-friction.md)",
            )
    if not made["rigid"] and sectors:
        raise InputError(
            f"{place}.rigid",
            f"is not published for {entry.name!r}, but a wheel has rigid sectors",
            "write rigid = { drive = …, transverse = … }, or set rigid_fraction = 0",
        )
    return {**raw, **made, "rigid": made["rigid"] or made["roller"]}


def _check_stands(robot: Robot) -> None:
    """The centre of mass lies above the wheels' polygon: else the robot tips over where it stands."""
    arm = np.array([w.position_m for w in robot.wheels]) - robot.body.com_m
    angles = np.sort(np.arctan2(arm[:, 1], arm[:, 0]))
    gap = np.max(np.diff(np.append(angles, angles[0] + 2 * math.pi)))
    if gap > math.pi + 1e-9:
        raise InputError(
            "body.com_m",
            f"is {robot.body.com_m.tolist()}, outside the wheels' polygon",
            "move it between the wheels: this robot falls over",
        )


def _check_builds(recipe: Recipe, surface: str) -> None:
    """Every effect fits this robot: what only shows when the model is built, said of its effect."""
    kept = Recipe(robot=recipe.robot)
    kept.build(surface)
    for i, effect in enumerate(recipe.effects, 1):
        kept = kept.with_effects(effect)
        try:
            kept.build(surface)
        except InputError as fault:
            raise fault.within(f"effect[{i}]") from None
