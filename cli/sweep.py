"""``slipmargin sweep``: how hard the robot can be pulled at each orientation before a wheel slips."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import DeltaOpt, GripOpt, JsonOpt, MarginOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import say, warn

From = Annotated[float, typer.Option("--from", metavar="DEG", help="First orientation [deg].")]
To = Annotated[float, typer.Option("--to", metavar="DEG", help="Last orientation [deg].")]
Step = Annotated[float, typer.Option("--step", metavar="DEG", help="Step [deg].")]


def sweep(
    robot: RobotArg,
    surface: SurfaceOpt,
    start: From = 0.0,
    stop: To = 90.0,
    step: Step = 1.0,
    delta_deg: DeltaOpt = None,
    grip: GripOpt = None,
    margin: MarginOpt = 0.1,
    method: Annotated[str, typer.Option(metavar="M", help="facets, clarabel or cvxpy.")] = "facets",
    measured: Annotated[Path | None, typer.Option(metavar="PULLS.csv", help="Measured pulls.")] = None,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
) -> None:
    """Pull before a wheel slips, F_emax, over the robot's orientation φ under a force along the floor's +x.

    The first four lines are the answer.  Angles on the command line are degrees, in files radians.  With
    --measured every measured orientation gets a row with the mean, spread and residual of its pulls.
    """
    from .machine import machine
    from .sweep_report import report
    from .sweep_run import run_sweep

    model, warning = machine(robot, surface, delta_deg, grip)
    found = run_sweep(model, (start, stop, step), method, margin, measured, (out, plot, json))
    if warning:
        warn(warning)
    found.write(out, plot)
    if not put_json(json, found.as_json()):
        say(*report(found, table=out is None), *(f"written: {path}" for path in (out, plot) if path))
