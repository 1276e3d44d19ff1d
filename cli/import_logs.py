"""``slipmargin import``: raw logs into a data set; one subcommand a format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Turn raw logs into a data set, and say what was read, dropped and why.",
)

Files = Annotated[list[Path], typer.Argument(metavar="FILE…", help="Logs, one run each.")]
Out = Annotated[Path, typer.Option("--out", metavar="DATASET", help="Folder of the data set to write.")]
Believed = Annotated[str, typer.Option("--robot", metavar="ROBOT", help="Robot file or built-in name.")]
Floor = Annotated[
    str | None, typer.Option("--surface", metavar="S", help="Surface of the robot file (default: its first).")
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
Sign = Annotated[bool, typer.Option("--commanded", help="The wheel speeds are commanded, not measured.")]


@app.command()
def robotino(
    files: Files,
    out: Out,
    robot: Believed = "robotino",
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    ticks_per_turn: Annotated[
        float, typer.Option(metavar="N", help="Encoder ticks per motor turn.")
    ] = 2000.0,
    smooth: Annotated[
        float,
        typer.Option(
            "--smooth",
            metavar="S",
            help="Half width [s] over which wheel angles are smoothed (their "
            "time stamps tremble by a bus cycle); 0 for none.",
        ),
    ] = 0.2,
    json: JsonOpt = None,
) -> None:
    """Logs of the Festo Robotino 2 slip measurements (BrOleg5/research-wheel-slippage)."""
    from slipmargin.io.importers.robotino import RobotinoImporter

    from .import_run import run_import

    run_import(
        RobotinoImporter(ticks_per_turn=ticks_per_turn, smooth_s=smooth),
        files,
        out,
        robot,
        surface,
        calibrate,
        calibration,
        json,
    )


@app.command()
def csv(
    files: Files,
    out: Out,
    columns: Annotated[Path, typer.Option("--map", metavar="MAP.toml", help="Which column is what.")],
    robot: Believed,
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    commanded: Sign = False,
    json: JsonOpt = None,
) -> None:
    """Any CSV, with a map of its columns in TOML (see slipmargin.io.importers.csv_map)."""
    from slipmargin.io.importers.csv_map import CsvImporter, read_map

    from .import_run import run_import

    run_import(
        CsvImporter(map=read_map(columns)),
        files,
        out,
        robot,
        surface,
        calibrate,
        calibration,
        json,
        commanded,
    )


@app.command()
def ros(
    files: Files,
    out: Out,
    robot: Believed,
    pose: Annotated[str, typer.Option("--pose-topic", metavar="TOPIC", help="PoseStamped or Odometry.")],
    joints: Annotated[str, typer.Option("--joint-topic", metavar="TOPIC", help="JointState.")],
    names: Annotated[
        list[str],
        typer.Option(
            "--joint",
            metavar="NAME",
            help="Joint of each wheel in the robot file's order; -NAME where it "
            "turns the other way. Give the option once a wheel.",
        ),
    ],
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    json: JsonOpt = None,
) -> None:
    """ROS 1 and ROS 2 bags (needs the extra: pip install 'slipmargin[ros]')."""
    from slipmargin.io.importers.ros2 import RosImporter

    from .import_run import run_import

    run_import(
        RosImporter(pose_topic=pose, joint_topic=joints, joints=tuple(names)),
        files,
        out,
        robot,
        surface,
        calibrate,
        calibration,
        json,
    )
