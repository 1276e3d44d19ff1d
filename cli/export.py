"""``slipmargin export``: a robot with its friction as a simulator's model file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import complete
from .options import JsonOpt, RobotArg, check_outputs, deliver
from .render import at_options


def export(
    format: Annotated[str, typer.Argument(metavar="FORMAT", help="sdf, urdf (Gazebo) or mjcf (MuJoCo).")],
    robot: RobotArg,
    surface: Annotated[
        str | None,
        typer.Option(
            "--surface",
            metavar="S",
            help="Surface (default: the file's first).",
            autocompletion=complete.surfaces,
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="File to write (default: ROBOT.FORMAT).")
    ] = None,
    json: JsonOpt = None,
) -> None:
    """Write a simulator's model of a robot: friction, slip compliances, masses and wheels of the robot file.

    Gazebo gets mu, mu2 and fdir1 of each wheel, MuJoCo wheels with rollers; axes are those of REP 103.
    """
    import slipmargin as sm

    with at_options(format="FORMAT", surface="--surface"):
        found = sm.export_simulator(robot, format, surface)
    ending = {"sdf": ".sdf", "urdf": ".urdf", "mjcf": ".xml"}[format]
    file = out or Path(f"{found.robot.name}{ending}")
    check_outputs(file, json)
    deliver(found, texts={file: found.text}, json=json)
