"""``slipmargin check``: does a trajectory slip, where, and how much slower must it be?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, check_outputs, deliver
from .render import at_options


def check(
    robot: RobotArg,
    path: Annotated[Path, typer.Argument(metavar="TRAJ.csv", help="t_s,x_m,y_m,phi_rad at least.")],
    surface: SurfaceOpt,
    margin: Annotated[
        float,
        typer.Option("--margin", metavar="M", min=0.0, max=0.99, help="Share of the grip kept in reserve."),
    ] = 0.0,
    smooth: Annotated[
        float, typer.Option(metavar="S", min=0.0, help=("Window for derivatives of measured poses [s]."))
    ] = 0.0,
    robust: Annotated[
        bool,
        typer.Option("--robust", help=("Whichever wheels stand on rigid sectors (default: all on rollers).")),
    ] = False,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
) -> None:
    """Audit anybody's trajectory: the share of each wheel's grip that it asks for, and the cure.

    Admissible means that no wheel uses more than 1 − margin of its grip, no motor more than it has, and no
    wheel lifts off.  The cure is one factor: stretch time by it.
    """
    import slipmargin as sm

    check_outputs(out, json, plot=plot)
    with at_options(surface="--surface", margin="--margin", smooth_s="--smooth"):
        found = sm.check(robot, surface, path, margin=margin, smooth_s=smooth, robust=robust)
    deliver(found, out=out, plot=plot, json=json)
