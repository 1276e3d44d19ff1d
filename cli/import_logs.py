"""``slipmargin import``: raw logs into a data set; one subcommand a format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from .import_options import Believed, Calibrate, Calibration, Files, Floor, ForceOpt, Out, Segment, Sign
from .options import JsonOpt, PoseOpt, WheelOpt, check_outputs, deliver
from .render import at_options, read_with_progress

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Turn raw logs into a data set, and say what was read, dropped and why.",
)


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
            "time stamps jitter by a bus cycle); 0 for none.",
        ),
    ] = 0.2,
    force: ForceOpt = False,
    json: JsonOpt = None,
) -> None:
    """Logs of the Festo Robotino 2 slip measurements (BrOleg5/research-wheel-slippage)."""
    common = (files, out, robot, surface, calibrate, calibration, json, force)
    run_import(
        "robotino",
        *common,
        ticks_per_turn=ticks_per_turn,
        smooth_s=smooth,
    )


@app.command()
def robojackets(
    files: Files,
    out: Out,
    robot: Believed = "robojackets-2018",
    segment: Segment = 5.0,
    rate: Annotated[float, typer.Option("--rate", metavar="HZ", help="Nominal rows a second [Hz].")] = 60.0,
    ticks_per_turn: Annotated[
        float, typer.Option(metavar="N", help="Encoder ticks per wheel turn.")
    ] = 6144.0,
    surface: Floor = None,
    force: ForceOpt = False,
    json: JsonOpt = None,
) -> None:
    """Recordings of the RoboJackets' SSL robots (RoboJackets/robocup-firmware-data), cut into runs."""
    common = (files, out, robot, surface, False, None, json, force)
    run_import(
        "robojackets",
        *common,
        segment_s=segment,
        rate_Hz=rate,
        ticks_per_turn=ticks_per_turn,
    )


@app.command()
def csv(
    files: Files,
    out: Out,
    robot: Believed,
    columns: Annotated[
        Path | None, typer.Option("--map", metavar="MAP.toml", help="Which column is what, as a file.")
    ] = None,
    time: Annotated[
        str | None, typer.Option(metavar="COLUMN:UNIT", help="Time; s, ms, us, ns [s]; #1 without header.")
    ] = None,
    x: Annotated[str | None, typer.Option(metavar="COLUMN:UNIT", help="Position; m, cm, mm, in [m].")] = None,
    y: Annotated[str | None, typer.Option(metavar="COLUMN:UNIT", help="Position.")] = None,
    heading: Annotated[
        str | None,
        typer.Option(metavar="COLUMN:UNIT", help="φ of the robot's convention; rad, deg, turn [rad]."),
    ] = None,
    wheels: Annotated[
        list[str] | None,
        typer.Option(
            "--wheel",
            metavar="COLUMN:UNIT",
            help="A wheel's speed (rpm, rad/s, deg/s) or angle (rad, deg, turn, ticks=4096) [rad/s]; once a "
            "wheel, in the robot file's order.",
        ),
    ] = None,
    separator: Annotated[str | None, typer.Option(metavar="C", help="Between cells: , ; | [,].")] = None,
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    commanded: Sign = False,
    force: ForceOpt = False,
    json: JsonOpt = None,
) -> None:
    """Any CSV: name its columns here, or in a map (TOML, see slipmargin.io.importers.csv_map).

    A leading - turns a column's sign: --y -py:mm --wheel -fl:rpm.
    """
    common = (files, out, robot, surface, calibrate, calibration, json, force)
    run_import(
        "csv",
        *common,
        commanded=commanded,
        columns=columns,
        time=time,
        x=x,
        y=y,
        heading=heading,
        wheels=wheels,
        separator=separator,
    )


@app.command()
def ros(
    files: Files,
    out: Out,
    robot: Believed,
    pose: Annotated[
        str | None,
        typer.Option(
            "--pose-topic",
            metavar="TOPIC",
            help="Pose, Odometry or TF (default: by type).",
        ),
    ] = None,
    joints: Annotated[
        str | None, typer.Option("--joint-topic", metavar="TOPIC", help="JointState (default: by type).")
    ] = None,
    names: Annotated[
        list[str] | None,
        typer.Option(
            "--joint",
            metavar="NAME",
            help="Joint of each wheel in the robot file's order; -NAME where it turns the other way. Give "
            "the option once a wheel (default: by the wheels' names).",
        ),
    ] = None,
    rotation: Annotated[
        float,
        typer.Option(
            "--pose-rotation",
            metavar="DEG",
            help="Angle from the robot's front to the x axis of the body whose pose is logged, "
            "counter-clockwise [deg]; 0 by REP 103.",
        ),
    ] = 0.0,
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    force: ForceOpt = False,
    json: JsonOpt = None,
) -> None:
    """ROS 1 and ROS 2 bags (needs the extra: pip install 'slipmargin[ros]').

    Yaw is the heading of the robot's front (REP 103) and becomes the φ of the robot file's convention: the
    same for "ros", less 90 degrees for "paper".  Topics and joints that are not named are found by type and
    name, and said.  Joints keep their signs: a robot file from the same URDF needs no conversion.
    """
    common = (files, out, robot, surface, calibrate, calibration, json, force)
    run_import(
        "ros",
        *common,
        pose_rotation_deg=rotation,
        pose_topic=pose,
        joint_topic=joints,
        joints=names,
    )


def _mecanum(format: str) -> Callable[..., None]:
    """The command of a format whose pose and wheels are found by type, or named."""

    def read(
        files: Files,
        out: Out,
        robot: Believed,
        pose: PoseOpt = None,
        wheels: WheelOpt = None,
        surface: Floor = None,
        calibrate: Calibrate = False,
        calibration: Calibration = None,
        commanded: Sign = False,
        force: ForceOpt = False,
        json: JsonOpt = None,
    ) -> None:
        common = (files, out, robot, surface, calibrate, calibration, json, force)
        run_import(format, *common, commanded=commanded, pose=pose, wheels=wheels)

    return read


_NAMED = (
    "A mecanum robot file's wheels are named fl, fr, rl and rr; for other robots give --wheel once a wheel.  "
    "Swerve drives are refused."
)
for _format, _said in {
    "wpilog": "WPILib's data logs (.wpilog) of a mecanum robot (needs the extra: pip install "
    "'slipmargin[frc]').",
    "advantagescope": "CSV that AdvantageScope exports (Table or List) of a mecanum robot.",
}.items():
    app.command(_format, help=f"{_said}\n\n{_NAMED}")(_mecanum(_format))


@app.command()
def roadrunner(
    files: Files,
    out: Out,
    robot: Believed,
    length_unit: Annotated[
        str, typer.Option(metavar="U", help="Unit of the robot's constants: in, m, cm, mm.")
    ] = "in",
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    force: ForceOpt = False,
    json: JsonOpt = None,
) -> None:
    """Logs of Road Runner 0.5's quickstart (the JSON in /sdcard/RoadRunner/logs) of a mecanum robot.

    The robot file's wheels are named fl, fr, rl and rr.  Road Runner 1.0 writes another, binary form: bring
    its poses and encoders as CSV (`import csv`).
    """
    common = (files, out, robot, surface, calibrate, calibration, json, force)
    run_import("roadrunner", *common, length_unit=length_unit)


@app.command()
def lerobot(
    files: Files,
    out: Out,
    robot: Believed,
    tracker: Annotated[
        list[Path] | None,
        typer.Option("--tracker", metavar="FILE", help="CSV of the pose; once, or once for each log."),
    ] = None,
    tracker_start: Annotated[
        float, typer.Option(metavar="S", help="The tracker's clock when the episode began [s].")
    ] = 0.0,
    time: Annotated[str, typer.Option(metavar="COLUMN:UNIT", help="The tracker's time.")] = "t_s",
    x: Annotated[str, typer.Option(metavar="COLUMN:UNIT", help="Its position.")] = "x_m",
    y: Annotated[str, typer.Option(metavar="COLUMN:UNIT", help="Its position.")] = "y_m",
    heading: Annotated[
        str, typer.Option(metavar="COLUMN:UNIT", help="Heading of the robot's front.")
    ] = "yaw_rad",
    wheels: Annotated[
        list[str] | None,
        typer.Option(
            "--wheel",
            metavar="NAME:UNIT",
            help="A wheel's speed in observation.state, once a wheel (default: LeKiwi's body velocities).",
        ),
    ] = None,
    episode: Annotated[int | None, typer.Option(metavar="N", help="Which, where there are several.")] = None,
    surface: Floor = None,
    calibrate: Calibrate = False,
    calibration: Calibration = None,
    force: ForceOpt = False,
    json: JsonOpt = None,
) -> None:
    """LeRobot data sets of a LeKiwi, the pose from a tracker (needs: pip install 'slipmargin[lerobot]').

    FILE is a data set's folder or one of its .parquet files.
    """
    common = (files, out, robot, surface, calibrate, calibration, json, force)
    run_import(
        "lerobot",
        *common,
        tracker=tracker,
        tracker_start_s=tracker_start,
        time=time,
        x=x,
        y=y,
        heading=heading,
        wheels=wheels,
        episode=episode,
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
    force: bool = False,
    **options: Any,
) -> None:
    """Read the logs, write the data set, and say what was read: what every format does."""
    import slipmargin as sm

    check_outputs(json=json, data_set=out, replace=force, reads=(*files, robot, calibration))
    with (
        read_with_progress(),
        at_options(
            surface="--surface",
            smooth_s="--smooth",
            calibrate="--calibrate",
            commanded="--commanded",
            joints="--joint",
            pose_rotation_deg="--pose-rotation",
            columns="--map",
            wheels="--wheel",
            length_unit="--length-unit",
            tracker="--tracker",
            tracker_start_s="--tracker-start",
            segment_s="--segment",
            rate_Hz="--rate",
            ticks_per_turn="--ticks-per-turn",
        ),
    ):
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
    found.write_folder(out, force=force)
    deliver(found, json=json, written=[out])
