"""``slipmargin check``: does a trajectory slip, where, and how much slower must it be?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, OutOpt, PlotOpt, ReportOpt, RobotArg, SurfaceOpt, check_outputs, deliver
from .render import at_options


def check(
    robot: RobotArg,
    path: Annotated[
        Path,
        typer.Argument(
            metavar="TRAJ",
            help="CSV (t_s,x_m,y_m,phi_rad at least), Choreo .traj, PathPlanner trajectory JSON, "
            "Road Runner log (inches), or a ROS bag with a nav_msgs/Path.",
        ),
    ],
    surface: SurfaceOpt,
    margin: Annotated[
        float,
        typer.Option("--margin", metavar="M", min=0.0, max=0.99, help="Share of the grip kept in reserve."),
    ] = 0.0,
    smooth: Annotated[
        float,
        typer.Option(
            metavar="S",
            min=0.0,
            help="Window for derivatives of measured poses [s], up to a tenth of the motion.",
        ),
    ] = 0.0,
    robust: Annotated[
        bool,
        typer.Option("--robust", help=("Whichever wheels stand on rigid sectors (default: all on rollers).")),
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit status 1 when not admissible (default: 0), for CI.")
    ] = False,
    topic: Annotated[
        str | None, typer.Option(metavar="T", help="Topic of the nav_msgs/Path, where a bag has several.")
    ] = None,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
) -> int:
    """Audit anybody's trajectory: the share of each wheel's grip that it asks for, and the cure.

    Admissible means that no wheel uses more than 1 − margin of its grip, loses more than that of its load
    (at 1
    it lifts off), and no motor gives more than that of its torque.  The cure is one factor: stretch time by
    it.

    The form of the file is recognised by its content.  Choreo, PathPlanner, Road Runner and ROS give the
    heading of the robot's front: it stays for a robot file in the convention of ROS and is turned by -90
    degrees for the paper's, whose front is +Y; positions stay.

    Exit status: 0 done, admissible or not; with --strict 1 when not admissible; 2 bad input or usage.
    """
    import slipmargin as sm

    check_outputs(out=out, json=json, report=report, plot=plot, reads=(robot, path))
    with at_options(surface="--surface", margin="--margin", smooth_s="--smooth", topic="--topic"):
        found = sm.check(robot, surface, path, margin=margin, smooth_s=smooth, robust=robust, topic=topic)
    deliver(found, out=out, plot=plot, json=json, report=report)
    return 1 if strict and not found.admissible else 0
