"""``slipmargin plan``: the fastest way along a path with a margin against slip."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import (
    ChanceOpt,
    JsonOpt,
    MarginOpt,
    OutOpt,
    PlotOpt,
    ReportOpt,
    RobotArg,
    SeedOpt,
    SurfaceOpt,
    TrajectoryOpt,
    check_outputs,
    deliver,
)
from .render import at_options, refuse

WayArg = Annotated[Path, typer.Argument(metavar="PATH.csv", help="Waypoints x_m,y_m,phi_rad.")]
ClosedOpt = Annotated[bool, typer.Option("--closed", help="Close the path smoothly.")]
BlendOpt = Annotated[
    float | None,
    typer.Option(
        metavar="M",
        min=0.0,
        help=("Straight lines, corners rounded from M metres before each waypoint (default: a spline)."),
    ),
]
SpeedOpt = Annotated[float, typer.Option(metavar="V", min=0.0, help="Speed over the floor there [m/s].")]
MaxSpeedOpt = Annotated[float | None, typer.Option(metavar="V", help="Speed cap [m/s].")]
MaxYawRateOpt = Annotated[float | None, typer.Option(metavar="W", help="Yaw rate cap [rad/s].")]
RobustOpt = Annotated[
    bool,
    typer.Option(
        "--robust", help=("Safe whichever wheels stand on rigid sectors (default: all on rollers).")
    ),
]
PointsOpt = Annotated[int, typer.Option(metavar="N", help="Grid points along the path.")]
TimeStepOpt = Annotated[float, typer.Option(metavar="S", help="Time step of the table [s].")]
VerifyOpt = Annotated[bool, typer.Option("--verify", help="Simulate the planned wheel speeds, open loop.")]


def plan(
    robot: RobotArg,
    path: WayArg,
    surface: SurfaceOpt,
    margin: MarginOpt = 0.1,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
    closed: ClosedOpt = False,
    blend: BlendOpt = None,
    start_speed: SpeedOpt = 0.0,
    end_speed: SpeedOpt = 0.0,
    max_speed: MaxSpeedOpt = None,
    max_yaw_rate: MaxYawRateOpt = None,
    robust: RobustOpt = False,
    points: PointsOpt = 400,
    step: TimeStepOpt = 0.005,
    verify: VerifyOpt = False,
    chance: ChanceOpt = None,
    seed: SeedOpt = 0,
    export: TrajectoryOpt = None,
) -> None:
    """The fastest motion along waypoints that keeps every wheel below 1 − margin of its grip.

    The table holds pose, velocity and acceleration in the floor frame, wheel speeds that roll without
    slip and the share of each wheel's grip (0 to 1).  Where the robot file gives numbers with a spread, the
    chance of slip is printed too, and with --chance the margin for it.
    """
    import slipmargin as sm

    if closed and blend is not None:
        refuse(
            "--blend", "is given with --closed", "close the path with a spline, or repeat the first waypoint"
        )
    check_outputs(export and export[1], out=out, json=json, report=report, plot=plot, reads=(robot, path))
    with at_options(
        surface="--surface",
        margin="--margin",
        points="--points",
        step_s="--step",
        blend_m="--blend",
        start_speed_m_s="--start-speed",
        end_speed_m_s="--end-speed",
        max_speed_m_s="--max-speed",
        max_yaw_rate_rad_s="--max-yaw-rate",
        chance="--chance",
        seed="--seed",
    ):
        found = sm.plan(
            robot,
            surface,
            path,
            margin=margin,
            closed=closed,
            blend_m=blend,
            start_speed_m_s=start_speed,
            end_speed_m_s=end_speed,
            max_speed_m_s=max_speed,
            max_yaw_rate_rad_s=max_yaw_rate,
            robust=robust,
            points=points,
            step_s=step,
            verify=verify,
            chance=chance,
            seed=seed,
        )
    deliver(found, out=out, plot=plot, json=json, report=report, export=export)
