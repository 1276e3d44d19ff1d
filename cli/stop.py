"""``slipmargin stop``: stopping distance and time by direction and speed."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import (
    JsonOpt,
    MarginOpt,
    OutOpt,
    PlotOpt,
    ReportOpt,
    RobotArg,
    SurfaceOpt,
    check_outputs,
    deliver,
)
from .render import at_options


def stop(
    robot: RobotArg,
    surface: SurfaceOpt,
    speed: Annotated[
        list[float] | None, typer.Option(metavar="V", help="Speed [m/s]; may be given several times.")
    ] = None,
    margin: MarginOpt = 0.1,
    step: Annotated[float, typer.Option(metavar="DEG", help="Step of the directions [deg].")] = 15.0,
    verify: Annotated[bool, typer.Option(help="Drive every stop in simulation.")] = True,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
) -> None:
    """Shortest stops on a straight line that keep the margin, with load transfer and motor torque.

    Directions are counted from the body's +x.  Without --speed: a quarter, a half and all of what the motors
    allow, or of 1 m/s.  Every stop is simulated, open loop, all wheels on rollers.
    """
    import slipmargin as sm

    check_outputs(out=out, json=json, report=report, plot=plot, reads=(robot,))
    with at_options(surface="--surface", margin="--margin", speeds_m_s="--speed", step_deg="--step"):
        found = sm.stop(robot, surface, speeds_m_s=speed or None, margin=margin, step_deg=step, verify=verify)
    deliver(found, out=out, plot=plot, json=json, report=report)
