"""``slipmargin sweep``: how hard the robot can be pulled at each orientation before a wheel slips."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import (
    ChanceOpt,
    DeltaOpt,
    GripOpt,
    JsonOpt,
    MarginOpt,
    OutOpt,
    PlotOpt,
    ReportOpt,
    RobotArg,
    SeedOpt,
    SurfaceOpt,
    check_outputs,
    deliver,
)
from .render import at_options

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
    chance: ChanceOpt = None,
    seed: SeedOpt = 0,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
) -> None:
    """Pull before a wheel slips, F_emax, over the robot's orientation φ under a force along the floor's +x.

    The first four lines are the answer.  Angles on the command line are degrees, in files radians.  With
    --measured every measured orientation gets a row with the mean, spread and residual of its pulls.  Where
    the robot file gives numbers with a spread ("0.26 ± 0.02"), the chance of slip is printed too.
    """
    import slipmargin as sm

    check_outputs(out=out, json=json, report=report, plot=plot, reads=(robot, measured))
    with at_options(
        surface="--surface",
        grip="--grip",
        wheel_angle_deg="--delta-deg",
        method="--method",
        from_deg="--from",
        to_deg="--to",
        step_deg="--step",
        margin="--margin",
        measured="--measured",
        chance="--chance",
        seed="--seed",
    ):
        found = sm.sweep(
            sm.read_robot(robot, wheel_angle_deg=delta_deg, grip=grip),
            surface,
            from_deg=start,
            to_deg=stop,
            step_deg=step,
            margin=margin,
            method=method,
            measured=measured,
            chance=chance,
            seed=seed,
        )
    deliver(found, out=out, plot=plot, json=json, report=report)
