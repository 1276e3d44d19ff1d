"""Robot files made and explained: a new one of a known type, one from a URDF, and what each wheel does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, read_robot
from slipmargin.effects import Recipe
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.plots.style import Figure


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RobotCheck(Result):
    """A robot in words: axes, what each wheel does, a drawing, wheel speeds and warnings."""

    recipe: Recipe
    warnings: tuple[str, ...]

    def summary(self) -> str:
        """Name, wheels and convention."""
        robot = self.recipe.robot
        x, y = robot.convention.axes
        return (
            f"robot {robot.name}: {len(robot.wheels)} wheels, {robot.body.mass_kg:g} kg; convention "
            f"{robot.convention.value}: +x {x}, +y {y}"
        )

    def lines(self) -> list[str]:
        """What each wheel does, the drawing, and wheel speeds for three motions."""
        from slipmargin.report.drawing import drawing, wheel_table, wheel_words

        robot = self.recipe.robot
        return [self.summary(), *wheel_words(robot), "", *drawing(robot), "", *wheel_table(robot)]

    def to_dict(self) -> dict[str, Any]:
        """The same as data; wheel speeds [rad/s] for 1 m/s right, 1 m/s forwards, 1 rad/s to the left."""
        from slipmargin.report.drawing import speeds, wheel_words

        robot = self.recipe.robot
        return {
            "schema": 1,
            "robot": robot.name,
            "convention": robot.convention.value,
            "wheels": [
                {"name": w.name, "says": said, "right": row[0], "forward": row[1], "turn_left": row[2]}
                for w, said, row in zip(robot.wheels, wheel_words(robot), speeds(robot), strict=True)
            ],
            "warnings": list(self.warnings),
        }

    def plot(self) -> Figure:
        """The robot from above."""
        from slipmargin.plots.machine import machine_figure

        return machine_figure(self.recipe.build(self.recipe.robot.surfaces[0].name))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RobotFile(Result):
    """The text of a new robot file, and what could not be known."""

    recipe: Recipe
    text: str
    unknown: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def summary(self) -> str:
        """Name and wheels."""
        robot = self.recipe.robot
        return f"robot file of {robot.name}: {len(robot.wheels)} wheels, {robot.body.mass_kg:g} kg"

    def lines(self) -> list[str]:
        """What each wheel does, and what is not known."""
        from slipmargin.report.drawing import wheel_words

        return [
            self.summary(),
            *wheel_words(self.recipe.robot),
            *(f"not known: {line}" for line in self.unknown),
            "values marked GUESS are typical, not measured; the file says which three to measure first",
        ]

    def to_dict(self) -> dict[str, Any]:
        """The robot file as data."""
        from slipmargin.io.toml_table import parse_toml

        return {**parse_toml(self.text), "not_known": list(self.unknown)}


def check_robot(robot: RobotLike) -> RobotCheck:
    """What each wheel of a robot does, in words, with a drawing and the warnings that the robot deserves.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        A built-in name, a robot file, or a robot that has been read already.

    Raises
    ------
    InputError
        With the file, the key, what is wrong and what to do.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.check_robot("mecanum4").lines()[1]
    'wheel front-right: mecanum, rollers +45°, positive speed drives backwards'
    """
    from slipmargin.robot.warnings import warnings

    recipe = read_robot(robot)
    return RobotCheck(recipe=recipe, warnings=warnings(recipe.robot))


def new_robot(name: str, type: str) -> RobotFile:
    """A complete robot file of a known type with typical values, in the convention of ROS.

    Parameters
    ----------
    name : str
        Name of the robot.
    type : str
        ``lekiwi``, ``kiwi``, ``xdrive``, ``mecanum`` or ``ssl``.

    Raises
    ------
    InputError
        For a type that is not known, or a blank name.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.new_robot("rover", "mecanum").lines()[1]
    'wheel fl: mecanum, rollers -45°, positive speed drives forwards'
    """
    from slipmargin.io.robot_file import recipe_from_text
    from slipmargin.io.toml_table import one_of
    from slipmargin.report.robot_draft import draft_text
    from slipmargin.report.robot_types import TYPES, draft_of

    if not name.strip() or not name.isprintable():
        raise InputError("name", f"is {name!r}", "give the robot a name")
    text = draft_text(draft_of(name, TYPES[one_of("type", type, TYPES)]))
    return RobotFile(recipe=recipe_from_text(text), text=text)


def robot_from_urdf(file: Path | str, *, xacro_args: Mapping[str, str] | None = None) -> RobotFile:
    """A robot file from a URDF: wheel joints with their axes and radii, masses, inertia, centre of mass.

    Friction, and what else a URDF cannot say, is guessed and marked so; ``unknown`` lists it.

    Parameters
    ----------
    file : str or Path
        A URDF, or a ``.xacro`` file.
    xacro_args : mapping, optional
        Arguments of the xacro file.

    Raises
    ------
    InputError
        Where it is no URDF with three wheels or more, or ``yourdfpy`` (``slipmargin[urdf]``) is missing.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.robot_from_urdf("rover.urdf").unknown  # doctest: +SKIP
    """
    from slipmargin.io.robot_file import recipe_from_text
    from slipmargin.io.urdf_file import read_urdf
    from slipmargin.report.robot_draft import draft_text
    from slipmargin.report.urdf_draft import urdf_draft
    from slipmargin.robot.warnings import warnings

    found = read_urdf(Path(file), xacro_args)
    draft, unknown = urdf_draft(found.name, found)
    text = draft_text(draft)
    try:
        recipe = recipe_from_text(text)
    except InputError as fault:
        raise fault.in_file(str(file)) from None
    return RobotFile(recipe=recipe, text=text, unknown=tuple(unknown), warnings=warnings(recipe.robot))
