"""Options that the subcommands of ``slipmargin import`` share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import complete

Files = Annotated[list[Path], typer.Argument(metavar="FILE…", help="Logs, one run each.")]
Out = Annotated[Path, typer.Option("--out", metavar="DATASET", help="Folder of the data set to write.")]
Believed = Annotated[
    str,
    typer.Option(
        "--robot", metavar="ROBOT", help="Robot file or built-in name.", autocompletion=complete.robots
    ),
]
Floor = Annotated[
    str | None,
    typer.Option(
        "--surface",
        metavar="S",
        help="Surface of the robot file (default: its first).",
        autocompletion=complete.surfaces,
    ),
]
Calibrate = Annotated[
    bool,
    typer.Option(
        "--calibrate",
        help="Estimate scale, rotation, delay and tilt of the camera from these runs (the floor "
        "with the least slip); kept in the data set as calibration.toml.",
    ),
]
Calibration = Annotated[
    Path | None,
    typer.Option(
        "--calibration", metavar="FILE", help="A calibration.toml of another floor, to be held fixed."
    ),
]
Segment = Annotated[
    float | None,
    typer.Option(
        "--segment",
        metavar="S",
        help="Cut each recording into runs of so many seconds, each with a start pose of its own [s].",
    ),
]
ForceOpt = Annotated[bool, typer.Option("--force", help="Replace a data set that is there.")]
Sign = Annotated[bool, typer.Option("--commanded", help="The wheel speeds are commanded, not measured.")]
