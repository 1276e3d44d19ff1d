"""Arguments and options of ``slipmargin simulate`` that no other command has."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

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
