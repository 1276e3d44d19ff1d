"""``slipmargin robots``: the machines that come with the package, and what any robot file describes."""

from __future__ import annotations

import typer

from .drawing import drawing, speeds
from .options import PlotOpt, RobotArg
from .render import columns, say

app = typer.Typer(help="The built-in robots.", rich_markup_mode=None, no_args_is_help=False)


@app.command("list")
def listing() -> None:
    """Name the built-in robots, each with the first line of its file."""
    from slipmargin.io.robot_file import built_in_names, robot_text

    for name in built_in_names():
        say(f"{name:<22}{robot_text(name)[0].splitlines()[0].lstrip('# ')}")


@app.command()
def show(robot: RobotArg, plot: PlotOpt = None) -> None:
    """Print a robot's file and draw it: wheel numbers, drive directions, signs of the wheel speeds."""
    from slipmargin.io.robot_file import read_recipe, robot_text

    recipe = read_recipe(robot)
    say(robot_text(robot)[0].rstrip("\n"), "", *drawing(recipe.robot), "")
    say(
        "Arrows are the drive directions ŝ: a positive wheel speed moves the contact point along its arrow",
        "over the floor and so drives the robot the other way (⊕ centre of mass, + origin; the stroke inside",
        "a mecanum wheel is the axle of the roller on the floor).  Wheel speeds without slip [rad/s] for",
        "",
    )
    head = ("wheel", "name", "drive [deg]", "rollers [deg]", "1 m/s right", "1 m/s forward", "1 rad/s left")
    say(
        *columns(
            head,
            [
                (
                    str(i),
                    w.name,
                    f"{w.drive_direction_deg:g}",
                    f"{w.roller_angle_deg:g}",
                    *(f"{s + 0.0:+.2f}" if abs(s) > 5e-3 else "0" for s in speeds(w)),
                )
                for i, w in enumerate(recipe.robot.wheels, 1)
            ],
        )
    )
    if plot is not None:
        from slipmargin.plots.machine import machine_figure
        from slipmargin.plots.style import save

        save(machine_figure(recipe.build(recipe.robot.surfaces[0].name)), plot)
