"""``slipmargin import``: raw logs into a data set; one subcommand a format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from .options import JsonOpt, check_outputs, deliver
from .render import at_options

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
    run_import(
        "robotino",
        files,
        out,
        robot,
        surface,
        calibrate,
        calibration,
        json,
        ticks_per_turn=ticks_per_turn,
        smooth_s=smooth,
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
    run_import(
        "csv",
        files,
        out,
        robot,
        surface,
        calibrate,
        calibration,
        json,
        commanded=commanded,
        columns=columns,
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
    run_import(
        "ros",
        files,
        out,
        robot,
        surface,
        calibrate,
        calibration,
        json,
        pose_topic=pose,
        joint_topic=joints,
        joints=names,
    )


def run_import(
    format: str,
    files: list[Path],
    out: Path,
    robot: str,
    surface: str | None,
    calibrate: bool,
    calibration: Path | None,
    json: str | None,
    **options: Any,
) -> None:
    """Read the logs, write the data set, and say what was read: what every format does."""
    import slipmargin as sm

    check_outputs(json, data_set=out)
    with at_options(calibrate="--calibrate"):
        found = sm.import_logs(
            files,
            format,
            robot,
            surface,
            calibrate=calibrate,
            calibration=calibration,
            name=out.name,
            **options,
        )
    found.write_folder(out)
    deliver(found, json=json, written=[out])
