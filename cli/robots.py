"""``slipmargin robots``: the machines that come with the package, and robot files of your own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, PlotOpt, RobotArg, check_new_file, check_outputs, deliver
from .render import at_options, refuse, say

app = typer.Typer(
    help="The built-in robots, and robot files of your own.", rich_markup_mode=None, no_args_is_help=False
)


ForceOpt = Annotated[bool, typer.Option("--force", help="Replace a file that is there.")]


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

    check_outputs(plot=plot, reads=(robot,))
    found = sm.describe_robot(robot)
    if plot is not None:
        found.write(plot)
    say(*found.lines())


@app.command()
def check(robot: RobotArg, plot: PlotOpt = None, json: JsonOpt = None) -> None:
    """Say in words what each wheel does, draw the robot, and warn of numbers that a robot hardly has."""
    import slipmargin as sm

    check_outputs(json=json, plot=plot, reads=(robot,))
    deliver(sm.check_robot(robot), plot=plot, json=json)


@app.command()
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the robot, or of its file NAME.toml.")],
    type: Annotated[str, typer.Option("--type", metavar="T", help="lekiwi, kiwi, xdrive, mecanum or ssl.")],
    force: ForceOpt = False,
) -> None:
    """Write a complete, commented robot file of a type: typical values, marked as guesses.

    It is in the convention of ROS (x forward, y left, positive wheel speed along the drive direction) and
    names the three numbers to measure first.
    """
    import slipmargin as sm

    file = _place(Path(name), force)
    with at_options(name="NAME", type="--type"):
        found = sm.new_robot(file.stem, type)
    deliver(found, texts={file: found.text})


@app.command("from-urdf")
def from_urdf(
    urdf: Annotated[Path, typer.Argument(metavar="FILE", help="URDF or .xacro file.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Robot file to write (default: FILE's name, .toml)."),
    ] = None,
    xacro_args: Annotated[
        list[str] | None,
        typer.Option("--xacro-args", metavar="NAME:=VALUE", help="Argument of a .xacro file."),
    ] = None,
    force: ForceOpt = False,
) -> None:
    """Write the robot file of a URDF: wheel joints, axes, radii, masses, inertia, centre of mass.

    What a URDF cannot say (friction, mostly the rollers' angle) is guessed, marked and listed.  Needs the
    extra: pip install 'slipmargin[urdf]'.
    """
    import slipmargin as sm

    file = _place(out or Path(urdf.name.split(".")[0]), force, "NAME" if out is None else "--out")
    arguments = {}
    for word in (w for text in xacro_args or () for w in text.split()):
        key, found, value = word.partition(":=")
        if not found or not key:
            refuse("--xacro-args", f"is {word!r}", "write NAME:=VALUE")
        arguments[key] = value
    made = sm.robot_from_urdf(urdf, xacro_args=arguments or None)
    deliver(made, texts={file: made.text})


def _place(file: Path, force: bool, said: str = "NAME") -> Path:
    """The file to write, with its ending; one that is there already is refused."""
    if not file.name or file.name.startswith("."):
        refuse(said, f"is {str(file)!r}", "give a name that begins with a letter or a digit")
    file = file if file.suffix == ".toml" else file.with_name(f"{file.name}.toml")
    check_outputs(file)
    if not force:
        check_new_file(file, "choose another name, or replace it with --force")
    return file
