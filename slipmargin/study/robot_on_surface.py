"""A design: a robot with its effects on one surface.  A study varies it and computes its limits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects import Recipe
from slipmargin.model import Model
from slipmargin.robot import Robot


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RobotOnSurface:
    """A recipe (robot and effects) on a named surface."""

    recipe: Recipe
    surface: str

    @property
    def robot(self) -> Robot:
        """The robot as its data sheet says."""
        return self.recipe.robot

    def with_robot(self, robot: Robot) -> RobotOnSurface:
        """The same effects and floor on another robot."""
        return replace(self, recipe=replace(self.recipe, robot=robot))

    def build(self) -> Model:
        """The model that limits, paths and the simulator see.

        Raises
        ------
        InputError
            If the loads are impossible or an effect does not fit.
        """
        return self.recipe.build(self.surface)
