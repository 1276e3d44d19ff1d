"""A robot file, read strictly: what it does not name does not exist, what it misnames is an error.

Places in errors are keys as in the file; wheels and effects are counted from 1, so
``wheel[2].radius_m`` is the key ``radius_m`` of the second ``[[wheel]]``.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.io.effect_table import read_effect
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import Table, nearest, parse_toml
from slipmargin.robot import (
    Body,
    Coefficients,
    FrictionLaw,
    GripShape,
    LoadRule,
    Motor,
    Robot,
    Surface,
    Wheel,
)

SCHEMA = 1
#: Friction laws a file may name.  Other laws are effects (``stribeck``, ``slip_ratio_friction`` …).
LAWS = ("atan",)
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
        known = ", ".join(built_in_names())
        guess = nearest(name, built_in_names())
        if fault.problem != "there is no such file":
            raise
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
    top = Table("", parse_toml(text))
    schema = top.whole("schema")
    if schema != SCHEMA:
        raise InputError("schema", f"is {schema}", f"this program reads schema = {SCHEMA}")
    name = top.text("name")
    body = _body(top.table("body", "add a [body] table with mass_kg and inertia_kg_m2"))
    rule, fractions = _loads(top)
    friction, motor = _friction(top), _motor(top)
    wheels = _named("wheel", [_wheel(table) for table in top.tables("wheel")])
    surfaces = _surfaces(top)
    effect_tables = top.tables("effect")
    top.done()
    robot = Robot(
        name=name,
        body=body,
        wheels=wheels,
        surfaces=surfaces,
        load_rule=rule,
        load_fractions=fractions,
        friction=friction,
        motor=motor,
    )
    _check_stands(robot)
    recipe = Recipe(
        robot=robot,
        effects=tuple(read_effect(table, tuple(w.name for w in wheels)) for table in effect_tables),
    )
    for surface in surfaces:
        _check_builds(recipe, surface.name)
    return recipe


def _body(table: Table) -> Body:
    mass, inertia = table.number("mass_kg", "kg"), table.number("inertia_kg_m2", "kg m²")
    com = table.numbers("com_m", 2, "m", (0.0, 0.0))
    height = table.number("com_height_m", "m", 0.0)
    table.done()
    try:
        return Body(mass_kg=mass, inertia_kg_m2=inertia, com_m=np.array(com), com_height_m=height)
    except InputError as fault:
        raise fault.within(table.place) from None


def _loads(top: Table) -> tuple[LoadRule, np.ndarray[Any, np.dtype[np.float64]] | None]:
    if not top.has("loads"):
        return LoadRule.EQUAL, None
    table = top.table("loads", "")
    rule = LoadRule(table.word("model", [r.value for r in LoadRule]))
    fractions = None
    if table.has("fractions"):
        fractions = np.array(table.numbers("fractions", None, "share of m g"))
    table.done()
    return rule, fractions


def _friction(top: Table) -> FrictionLaw:
    if not top.has("friction"):
        return FrictionLaw()
    table = top.table("friction", "")
    table.word("law", LAWS)
    steepness = table.number("k_s_per_m", "s/m", FrictionLaw().k_s_per_m)
    grip = GripShape(table.word("grip", [g.value for g in GripShape], GripShape.BOX.value))
    table.done()
    try:
        return FrictionLaw(k_s_per_m=steepness, grip=grip)
    except InputError as fault:
        raise fault.within(table.place) from None


def _motor(top: Table) -> Motor | None:
    if not top.has("motor"):
        return None
    table = top.table("motor", "")
    speed = table.number("max_speed_rad_s", "rad/s")
    stall = table.number("stall_torque_N_m", "N m") if table.has("stall_torque_N_m") else None
    table.done()
    try:
        return Motor(max_speed_rad_s=speed, stall_torque_N_m=stall)
    except InputError as fault:
        raise fault.within(table.place) from None


def _wheel(table: Table) -> Wheel:
    values: dict[str, Any] = {
        "name": table.text("name"),
        "position_m": np.array(table.numbers("position_m", 2, "m")),
        "drive_direction_deg": table.number("drive_direction_deg", "deg"),
        "radius_m": table.number("radius_m", "m"),
        "roller_angle_deg": table.number("roller_angle_deg", "deg", 0.0),
        "rollers": table.whole("rollers", 8),
        "rigid_fraction": table.number("rigid_fraction", "1", 0.0),
    }
    table.done()
    try:
        return Wheel(**values)
    except InputError as fault:
        raise fault.within(table.place) from None


def _named(key: str, wheels: list[Wheel]) -> tuple[Wheel, ...]:
    for i, wheel in enumerate(wheels):
        first = next(j for j, other in enumerate(wheels) if other.name == wheel.name)
        if first < i:
            raise InputError(
                f"{key}[{i + 1}].name",
                f"is {wheel.name!r}, the name of {key}[{first + 1}]",
                f"give each {key} its own name",
            )
    return tuple(wheels)


def _surfaces(top: Table) -> tuple[Surface, ...]:
    cure = "add a [surface.NAME] table with roller and rigid"
    section = top.table("surface", cure)
    found = []
    for name, value in section.raw().items():
        table = Table(f"surface.{name}", value)
        roller, rigid = (_coefficients(table, key) for key in ("roller", "rigid"))
        table.done()
        found.append(Surface(name=name, roller=roller, rigid=rigid))
    if not found:
        raise InputError("surface", "no surface is described", cure)
    return tuple(found)


def _coefficients(table: Table, key: str) -> Coefficients:
    pair = table.table(key, f"write {key} = {{ drive = 0.26, transverse = 0.09 }}")
    drive, transverse = pair.number("drive", "1"), pair.number("transverse", "1")
    pair.done()
    try:
        return Coefficients(drive=drive, transverse=transverse)
    except InputError as fault:
        raise fault.within(pair.place) from None


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
