"""``slipmargin simulate``: what the robot really does under wheel speeds that it is told."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import (
    JsonOpt,
    OutOpt,
    PlotOpt,
    ReportOpt,
    RobotArg,
    SurfaceOpt,
    TrajectoryOpt,
    check_outputs,
    deliver,
)
from .render import at_options, refuse, stages

CommandsArg = Annotated[
    Path, typer.Argument(metavar="COMMANDS.csv", help="Wheel speeds, or a planned trajectory.")
]
AnglesOpt = Annotated[
    str | None, typer.Option("--theta0", metavar="A,B,…", help="Wheel angles at the start [rad].")
]
StepOpt = Annotated[float, typer.Option("--step", metavar="S", help="Time between rows of the output [s].")]
UntilOpt = Annotated[
    float | None, typer.Option("--until", metavar="S", help="Hold the last row until this time [s].")
]
PushOpt = Annotated[
    str | None,
    typer.Option(
        "--push", metavar="FX,FY,MZ", help="Constant push on the centre of mass, floor axes [N, N, N m]."
    ),
]
RtolOpt = Annotated[float, typer.Option("--rtol", metavar="R", help="Relative error allowed a step.")]


def simulate(
    robot: RobotArg,
    commands: CommandsArg,
    surface: SurfaceOpt,
    out: OutOpt = None,
    theta0: AnglesOpt = None,
    step: StepOpt = 0.01,
    until: UntilOpt = None,
    push: PushOpt = None,
    rtol: RtolOpt = 1e-7,
    export: TrajectoryOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
) -> None:
    """Simulate the slipping motion under wheel speeds (t_s, omega{i}_rad_s, held between rows) or a plan.

    A plan is followed open loop from its first pose, its wheel speeds straight lines between rows.
    Lag, delay and droop that the robot file lists act on the commands.  Velocities are in floor axes.
    """
    import slipmargin as sm

    check_outputs(export and export[1], out=out, json=json, report=report, plot=plot, reads=(robot, commands))
    recipe = sm.read_robot(robot)
    with (
        stages("simulating", counted=False),
        at_options(
            surface="--surface",
            wheel_angles_rad="--theta0",
            step_s="--step",
            until_s="--until",
            push="--push",
            relative_error="--rtol",
        ),
    ):
        found = sm.simulate(
            recipe,
            surface,
            commands,
            wheel_angles_rad=_numbers("--theta0", theta0, len(recipe.robot.wheels)),
            step_s=step,
            until_s=until,
            push=_numbers("--push", push, 3),
            relative_error=rtol,
        )
    deliver(found, out=out, plot=plot, json=json, report=report, export=export)


def _numbers(option: str, text: str | None, count: int) -> list[float] | None:
    if text is None:
        return None
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count or not all(abs(v) < float("inf") for v in values):
        refuse(option, f"is {text!r}", f"give {count} numbers with commas between")
    return values
