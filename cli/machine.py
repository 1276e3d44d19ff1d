"""ROBOT, --surface, --delta-deg and --grip: from words on the command line to a model."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from slipmargin.effects import Recipe
    from slipmargin.model import Model


def recipe_of(
    robot: str, surface: str | None = None, delta_deg: float | None = None, grip: str | None = None
) -> tuple[Recipe, str | None]:
    """The recipe that the shared arguments name, and the warnings it deserves (None: none).

    Raises
    ------
    InputError
        Placed in the robot's file, or at the option that does not fit it.
    """
    from slipmargin.errors import InputError
    from slipmargin.io.robot_file import read_recipe
    from slipmargin.io.toml_table import one_of
    from slipmargin.robot import GripShape
    from slipmargin.robot.layout import with_wheel_angle
    from slipmargin.robot.warnings import warnings

    recipe = read_recipe(robot)
    try:
        if surface is not None:
            one_of("--surface", surface, [s.name for s in recipe.robot.surfaces])
        if grip is not None:
            shape = GripShape(one_of("--grip", grip, [g.value for g in GripShape]))
            friction = replace(recipe.robot.friction, grip=shape)
            recipe = replace(recipe, robot=replace(recipe.robot, friction=friction))
        if delta_deg is not None:
            recipe = replace(recipe, robot=with_wheel_angle(recipe.robot, delta_deg))
    except InputError as fault:
        place = "--delta-deg" if fault.place == "delta_deg" else fault.place
        raise InputError(place, fault.problem, fault.cure, "command line") from None
    return recipe, "; ".join(warnings(recipe.robot)) or None


def machine(
    robot: str, surface: str, delta_deg: float | None = None, grip: str | None = None
) -> tuple[Model, str | None]:
    """The model that the shared arguments name, and the warnings it deserves (None: none)."""
    recipe, warning = recipe_of(robot, surface, delta_deg, grip)
    return recipe.build(surface), warning
