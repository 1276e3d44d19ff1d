"""``slipmargin bounds``: accelerations and cornering speeds that do not slip."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import DeltaOpt, GripOpt, JsonOpt, MarginOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import say, warn


def bounds(
    robot: RobotArg,
    surface: SurfaceOpt,
    margin: MarginOpt = 0.1,
    delta_deg: DeltaOpt = None,
    grip: GripOpt = None,
    step: Annotated[float, typer.Option(metavar="DEG", help="Step of the directions [deg].")] = 1.0,
    robust: Annotated[
        bool,
        typer.Option("--robust", help=("Whichever wheels stand on rigid sectors (default: all on rollers).")),
    ] = False,
    export: Annotated[
        tuple[str, Path] | None,
        typer.Option(
            metavar="TOOL FILE", help=("Write the limits as nav2, roadrunner, pathplanner, choreo or json.")
        ),
    ] = None,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
) -> None:
    """Acceleration limits in motion by direction: speeding up, turning, braking, cornering, spinning.

    In motion the rollers turn and their friction is drag, so the pull limit divided by the mass is not an
    acceleration limit.  Directions are the robot's own: 0° to the right, 90° forward.
    """
    from .bounds_run import report, run_bounds
    from .machine import machine

    model, warning = machine(robot, surface, delta_deg, grip)
    found = run_bounds(model, margin, step, robust, export, (out, plot, json))
    found.write(out, plot)
    if warning:
        warn(warning)
    if not put_json(json, found.as_json()):
        files = (out, plot, None if export is None else export[1])
        say(*report(found, table=out is None), *(f"written: {name}" for name in files if name))
