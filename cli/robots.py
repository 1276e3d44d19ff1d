"""``slipmargin robots``: the machines that come with the package, and what any robot file describes."""

from __future__ import annotations

import typer

from .options import PlotOpt, RobotArg, check_outputs
from .render import say

app = typer.Typer(help="The built-in robots.", rich_markup_mode=None, no_args_is_help=False)


@app.command("list")
def listing() -> None:
    """Name the built-in robots, each with the first line of its file."""
    import slipmargin as sm

    for name, line in sm.built_in_robots().items():
        say(f"{name:<22}{line}")


@app.command()
def show(robot: RobotArg, plot: PlotOpt = None) -> None:
    """Print a robot's file and draw it: wheel numbers, drive directions, signs of the wheel speeds."""
    import slipmargin as sm

    check_outputs(plot=plot)
    found = sm.describe_robot(robot)
    if plot is not None:
        found.write(plot)
    say(*found.lines())
