"""Robots: reading one, naming those built in, describing one, and the model that the other functions ask."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.result import Result
from slipmargin.effects import Recipe
from slipmargin.errors import InputError
from slipmargin.robot import GripShape, Robot

if TYPE_CHECKING:
    from slipmargin.checks import Array
    from slipmargin.limits.motion_state import Contact
    from slipmargin.limits.uncertainty import Draws, SlipChance
    from slipmargin.model import Model
    from slipmargin.plots.style import Figure

#: The chance for which a number is printed where none is asked for [1].
USUAL_CHANCE = 0.01
#: What every function takes as a robot: a file or built-in name, a recipe, or a bare robot.
RobotLike = Recipe | Robot | Path | str


def read_robot(
    robot: RobotLike,
    *,
    wheel_angle_deg: float | None = None,
    grip: str | None = None,
    load_model: str | None = None,
    rigid_sectors: bool = True,
) -> Recipe:
    """A robot with the effects its file lists, and changes to it where they are asked for.

    Parameters
    ----------
    robot : str, Path, Recipe or Robot
        The name of a built-in robot (it wins over a file of the same name), a robot file, or a robot that
        has been read already.
    wheel_angle_deg : float, optional
        Angle δ of the front wheels of a three-wheel robot [deg].
    grip : str, optional
        Shape of each wheel's set of friction forces: ``box`` (eq. 17 of the paper), ``disc-strip`` or
        ``ellipse``.
    load_model : str, optional
        How the weight is shared between the wheels: ``equal`` (as published), ``static`` or
        ``quasi-static``.
    rigid_sectors : bool
        False: leave out the rigid sectors that the file gives its wheels.

    Returns
    -------
    Recipe
        The robot (``recipe.robot``) and its effects (``recipe.effects``).

    Raises
    ------
    InputError
        With the file, the key, what is wrong and what to do.

    Examples
    --------
    >>> import slipmargin as sm
    >>> robot = sm.read_robot("ohio-kiwi", wheel_angle_deg=30.0)
    >>> robot.robot.name, [wheel.name for wheel in robot.robot.wheels]
    ('ohio-kiwi', ['right', 'left', 'rear'])
    """
    from slipmargin.io.robot_file import read_recipe
    from slipmargin.io.toml_table import one_of
    from slipmargin.robot import LoadRule
    from slipmargin.robot.layout import with_wheel_angle

    if isinstance(robot, Robot):
        robot = Recipe(robot=robot)
    recipe = robot if isinstance(robot, Recipe) else read_recipe(robot)
    machine = recipe.robot
    if grip is not None:
        shape = GripShape(one_of("grip", grip, [g.value for g in GripShape]))
        machine = replace(machine, friction=replace(machine.friction, grip=shape))
    if wheel_angle_deg is not None:
        try:
            machine = with_wheel_angle(machine, wheel_angle_deg)
        except InputError as fault:
            place = "wheel_angle_deg" if fault.place == "delta_deg" else fault.place
            raise InputError(place, fault.problem, fault.cure) from None
    if load_model is not None:
        known = [rule.value for rule in LoadRule if rule is not LoadRule.FIXED]
        rule = LoadRule(one_of("load_model", load_model, known))
        machine = replace(machine, load_rule=rule, load_fractions=None)
    if not rigid_sectors:
        machine = replace(machine, wheels=tuple(replace(w, rigid_fraction=0.0) for w in machine.wheels))
    return replace(recipe, robot=machine)


def model_of(
    robot: RobotLike,
    surface: str,
    *,
    spread: tuple[str, ...] = (),
    band: bool = False,
) -> tuple[Model, tuple[str, ...]]:
    """The model of a robot on a surface, and the warnings that it deserves.

    ``spread`` and ``band`` say which uncertain numbers the caller draws from, as begin their keys
    (:mod:`slipmargin.robot.warnings`), and whether it uses the band of loads.  What it does not use is a
    warning too.

    Raises
    ------
    InputError
        Placed in the robot's file, or at ``surface`` where the robot has none of that name.
    """
    from slipmargin.io.toml_table import one_of

    recipe = read_robot(robot)
    one_of("surface", surface, [s.name for s in recipe.robot.surfaces])
    return recipe.build(surface), warnings_of(recipe, surface, spread=spread, band=band)


def contact_of(model: Model, robust: bool) -> tuple[Contact, tuple[str, ...]]:
    """What the wheels are taken to stand on, and a warning where ``robust`` changes nothing."""
    from slipmargin.limits.motion_state import Contact

    if not robust:
        return Contact.ROLLERS, ()
    if (model.grip.rigid_fraction > 0.0).any():
        return Contact.UNKNOWN, ()
    return Contact.UNKNOWN, ("robust has no effect: no wheel has rigid material between its rollers",)


def held_wheels(model: Model) -> tuple[str, ...]:
    """A warning where grip bears more than the motors hold: limits of wheels that are held are no pushes."""
    g, given = model.geometry, model.drives.stall_torques(model.count)
    bears = model.grip_torques_N_m()
    first = int((bears / given).argmax())
    radius, stall = g.radius_m[first], given[first]
    if stall >= bears[first]:
        return ()
    return (
        f"motors: these are limits of wheels that are held; the grip of wheel {g.names[first]} bears "
        f"{bears[first] / radius:.3g} N along its drive direction, and a motor of {stall:.3g} N m pushes "
        f"with {stall / radius:.3g} N there, so that the robot may push less: see bounds",
    )


def warnings_of(
    recipe: Recipe,
    surface: str,
    *,
    spread: tuple[str, ...] = (),
    band: bool = False,
) -> tuple[str, ...]:
    """What a robot file contradicts, what of it has no effect, and what the caller does not use."""
    from slipmargin.robot.warnings import cut_off, unused, warnings

    ignored = unused(recipe.robot, surface, spread=spread, band=band)
    return (
        *warnings(recipe.robot),
        *cut_off(recipe.robot, surface),
        *ignored,
        *_partly_used(recipe),
        *_steepness_without_effect(recipe, surface),
    )


def _partly_used(recipe: Recipe) -> tuple[str, ...]:
    """A sentence for each effect of a robot file that does not count everywhere."""
    from slipmargin.effects import Effect

    found = {e.name: (isinstance(e, Effect) and e.counts_in) or e.part.counts_in for e in recipe.effects}
    return tuple(f"effect {name}: counts in {where}" for name, where in found.items() if where)


def _steepness_without_effect(recipe: Recipe, surface: str) -> tuple[str, ...]:
    """A sentence for each effect that makes friction across the rollers steep where that is not read."""
    from slipmargin.physics.variables import Target

    if not recipe.effects or (grip := recipe.build(surface).grip).coupled_part < 1.0:
        return ()
    alone = ((e.name, replace(recipe, effects=(e,)).build(surface).grip.multipliers) for e in recipe.effects)
    return tuple(
        f"effect {name}: how steep friction is across the rollers has no effect, since the grip "
        f'"{grip.shape.value}" has one law for all directions, as steep as along the grip'
        for name, terms in alone
        if any(term.target is Target.STIFFNESS_TRANSVERSE for term in terms)
    )


def checked_margin(margin: float) -> float:
    """The safety margin (1 − grip utilisation), at least 0 and below 1.

    Raises
    ------
    InputError
        Placed at ``margin``.
    """
    if not 0.0 <= margin < 1.0:
        raise InputError("margin", f"is {margin:g}", "give a share of the grip from 0 to below 1")
    return float(margin)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drawing:
    """What a command that draws from a robot's spreads was asked: a chance, or None, and a seed."""

    recipe: Recipe
    chance: float | None
    seed: int

    @staticmethod
    def of(
        recipe: Recipe, surface: str, chance: float | None, seed: int
    ) -> tuple[Drawing | None, tuple[str, ...]]:
        """None where no number of the robot on this surface has a spread; and what has no effect, in words.

        Raises
        ------
        InputError
            For a seed below 0, or a chance out of range or without a spread.
        """
        from slipmargin.checks import from_zero
        from slipmargin.limits.uncertainty import checked_chance
        from slipmargin.robot.warnings import uncertain_keys

        from_zero("seed", seed)
        if not uncertain_keys(recipe.robot, surface):
            exact = f"every number of the robot on surface {surface!r} is exact"
            if chance is None:
                return None, (f"seed has no effect: {exact}",) if seed else ()
            raise InputError(
                "chance",
                f"has no effect: {exact}",
                'write a spread in the robot file, drive = "0.26 ± 0.02" or drive = [0.24, 0.28]',
            )
        chance = None if chance is None else checked_chance(chance)
        return Drawing(recipe=recipe, chance=chance, seed=seed), ()

    def drawn(self, model: Model) -> Draws:
        """The draws, around a model of the recipe."""
        from slipmargin.limits.uncertainty import DRAWS, draws

        return draws(self.recipe.robot, model, DRAWS, self.seed)

    def counted(
        self, model: Model, lowest: Callable[[Draws], Array], recommended: float
    ) -> tuple[SlipChance | None, tuple[str, ...]]:
        """The chance of slip by the draws' own limits, or None and why it is not computed.

        Raises
        ------
        InputError
            Where it is not computed although a chance was asked for.
        """
        from slipmargin.limits.uncertainty import counted

        try:
            limits = lowest(self.drawn(model))
        except InputError as fault:
            if self.chance is not None:
                raise
            return None, (str(fault),)
        chance = USUAL_CHANCE if self.chance is None else self.chance
        return counted(limits, recommended, chance=chance, seed=self.seed), ()


def built_in_robots() -> dict[str, str]:
    """The robots that come with the package: name → the first line of its file.

    Examples
    --------
    >>> import slipmargin as sm
    >>> list(sm.built_in_robots())[:2]
    ['mecanum4', 'ohio-kiwi']
    """
    from slipmargin.io.robot_file import built_in_names, robot_text

    return {name: robot_text(name)[0].splitlines()[0].lstrip("# ") for name in built_in_names()}


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RobotDescription(Result):
    """A robot's file, its drawing in characters and the wheel speeds that move it."""

    recipe: Recipe
    text: str

    def summary(self) -> str:
        """Name, number of wheels and surfaces."""
        robot = self.recipe.robot
        floors = ", ".join(s.name for s in robot.surfaces)
        return f"robot {robot.name}: {len(robot.wheels)} wheels, {robot.body.mass_kg:g} kg, on {floors}"

    def lines(self) -> list[str]:
        """The file, the drawing and the table of wheel speeds."""
        from slipmargin.report.drawing import drawing, wheel_table

        return [self.text.rstrip("\n"), "", *drawing(self.recipe.robot), "", *wheel_table(self.recipe.robot)]

    def to_dict(self) -> dict[str, Any]:
        """The robot file as data."""
        from slipmargin.io.toml_table import parse_toml

        return parse_toml(self.text)

    def plot(self) -> Figure:
        """The robot from above."""
        from slipmargin.plots.machine import machine_figure

        return machine_figure(self.recipe.build(self.recipe.robot.surfaces[0].name))


def describe_robot(robot: RobotLike) -> RobotDescription:
    """A robot's file, a drawing of it, and the wheel speeds that move it without slip.

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
    >>> sm.describe_robot("ohio-kiwi")
    <robot ohio-kiwi: 3 wheels, 3 kg, on paper, carpet>
    """
    if isinstance(robot, Recipe | Robot):
        from slipmargin.io.robot_text import write_recipe

        recipe = read_robot(robot)
        return RobotDescription(recipe=recipe, text=write_recipe(recipe))
    from slipmargin.io.robot_file import robot_text

    return RobotDescription(recipe=read_robot(robot), text=robot_text(robot)[0])
