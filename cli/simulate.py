"""``slipmargin simulate``: what the robot really does under wheel speeds that it is told."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import progress, say, warn

Commands = Annotated[
    Path, typer.Argument(metavar="COMMANDS.csv", help="Wheel speeds, or a planned trajectory.")
]
Angles = Annotated[
    str | None, typer.Option("--theta0", metavar="A,B,…", help="Wheel angles at the start [rad].")
]
Step = Annotated[float, typer.Option("--step", metavar="S", help="Time between rows of the output [s].")]
Until = Annotated[
    float | None, typer.Option("--until", metavar="S", help="Hold the last row until this time [s].")
]
Force = Annotated[
    str | None,
    typer.Option(
        "--push", metavar="FX,FY,MZ", help="Constant push on the centre of mass, floor axes [N, N, N m]."
    ),
]
Rtol = Annotated[float, typer.Option("--rtol", metavar="R", help="Relative error allowed a step.")]


def simulate(
    robot: RobotArg,
    commands: Commands,
    surface: SurfaceOpt,
    out: OutOpt = None,
    theta0: Angles = None,
    step: Step = 0.01,
    until: Until = None,
    push: Force = None,
    rtol: Rtol = 1e-7,
    plot: PlotOpt = None,
    json: JsonOpt = None,
) -> None:
    """Simulate the slipping motion under wheel speeds (t_s, omega{i}_rad_s, held between rows) or a plan.

    A plan is followed open loop from its first pose, its wheel speeds straight lines between rows.
    Lag, delay and droop that the robot file lists act on the commands.  Velocities are in floor axes.
    """
    from .machine import machine
    from .simulate_run import run_simulation

    model, warning = machine(robot, surface)
    with progress("simulate", 2) as advance:
        found = run_simulation(model, commands, theta0, step, until, push, rtol, (out, plot, json))
        advance()
        found.write(out, plot)
        advance()
    if warning:
        warn(warning)
    if not put_json(json, found.as_json()):
        say(*found.lines(), *(f"written: {path}" for path in (out, plot) if path))
