"""``slipmargin plan``: the fastest way along a path with a margin against slip."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, MarginOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import say, warn

Speed = typer.Option(metavar="V", min=0.0, help="Speed along the path [m/s].")


def plan(
    robot: RobotArg,
    path: Annotated[Path, typer.Argument(metavar="PATH.csv", help="Waypoints x_m,y_m,phi_rad.")],
    surface: SurfaceOpt,
    margin: MarginOpt = 0.1,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    closed: Annotated[bool, typer.Option("--closed", help="Close the path smoothly.")] = False,
    blend: Annotated[
        float | None,
        typer.Option(
            metavar="M",
            min=0.0,
            help=("Straight lines, corners rounded from M metres before each waypoint (default: a spline)."),
        ),
    ] = None,
    start_speed: Annotated[float, Speed] = 0.0,
    end_speed: Annotated[float, Speed] = 0.0,
    max_speed: Annotated[float | None, typer.Option(metavar="V", help="Speed cap [m/s].")] = None,
    max_yaw_rate: Annotated[float | None, typer.Option(metavar="W", help="Yaw rate cap [rad/s].")] = None,
    robust: Annotated[
        bool,
        typer.Option(
            "--robust", help=("Safe whichever wheels stand on rigid sectors (default: all on rollers).")
        ),
    ] = False,
    points: Annotated[int, typer.Option(metavar="N", help="Grid points along the path.")] = 400,
    step: Annotated[float, typer.Option(metavar="S", help="Time step of the table [s].")] = 0.005,
    verify: Annotated[
        bool, typer.Option("--verify", help=("Simulate the planned wheel speeds, open loop."))
    ] = False,
) -> None:
    """The fastest motion along waypoints that keeps every wheel below 1 − margin of its grip.

    The table holds pose, velocity and acceleration in the floor frame, wheel speeds that roll without
    slip and the share of each wheel's grip (0 to 1).
    """
    from .machine import machine
    from .plan_run import ask, report, run_plan, table

    model, warning = machine(robot, surface)
    request = ask(margin, points, (start_speed, end_speed), (max_speed, max_yaw_rate), robust)
    found = run_plan(model, path, request, closed, blend, step, verify, (out, plot, json))
    found.write(out, plot)
    if warning:
        warn(warning)
    if not put_json(json, table(found)):
        say(*report(found), *(f"written: {name}" for name in (out, plot) if name))
