"""Arguments and options of ``slipmargin plan`` that no other command has."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

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
SpeedOpt = Annotated[float, typer.Option(metavar="V", min=0.0, help="Speed along the path [m/s].")]
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
