"""The formats of logs that :func:`slipmargin.import_logs` reads: one function each, its arguments the
options."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from slipmargin.errors import InputError
from slipmargin.robot import Robot

if TYPE_CHECKING:
    from slipmargin.io.importers.plug import Importer

_Files = Sequence[Path]
_Words = Sequence[str] | None


def importer_of(format: str, options: Mapping[str, Any], robot: Robot, files: _Files) -> Importer:
    """The reader of a format, with its options; those that are None count as not given."""
    known_options(format, options)
    given = {key: value for key, value in options.items() if value is not None}
    return FORMATS[format](robot, files, **given)


def known_options(format: str, options: Mapping[str, Any]) -> None:
    """Refuse an unknown format, or an option that it does not have.

    Raises
    ------
    InputError
        Placed at the format or the option.
    """
    if format not in FORMATS:
        raise InputError("format", f"is {format!r}", f"use one of: {', '.join(FORMATS)}")
    known = list(inspect.signature(FORMATS[format]).parameters)[2:]
    for option in options:
        if option not in known:
            raise InputError(option, f"is no option of {format!r}", f"use one of: {', '.join(known)}")


def robotino(robot: Robot, files: _Files, ticks_per_turn: float = 2000.0, smooth_s: float = 0.2) -> Importer:
    """Logs of the Robotino 2: encoder ticks a motor turn, and the time over which angles are smoothed [s]."""
    from slipmargin.io.importers.robotino import RobotinoImporter

    return RobotinoImporter(robot=robot, ticks_per_turn=ticks_per_turn, smooth_s=smooth_s)


def csv(
    robot: Robot,
    files: _Files,
    columns: Path | str | None = None,
    time: str | None = None,
    x: str | None = None,
    y: str | None = None,
    heading: str | None = None,
    wheels: _Words = None,
    separator: str | None = None,
) -> Importer:
    """Any CSV, by ``columns``, a TOML file that says which column is what, or by columns with their units.

    Parameters
    ----------
    time, x, y, heading, wheels
        Words like ``"px:mm"``, see :mod:`slipmargin.io.importers.csv_options`.
    """
    from slipmargin.io.importers.csv_map import CsvImporter, read_map
    from slipmargin.io.importers.csv_options import csv_map

    words = {"time": time, "x": x, "y": y, "heading": heading, "wheels": wheels, "separator": separator}
    named = [name for name, word in words.items() if word]
    if columns is not None:
        if named:
            raise InputError("columns", f"is given together with {', '.join(named)}", "give one of the two")
        return CsvImporter(map=read_map(Path(columns)))
    held = csv_map(
        time=time, x=x, y=y, heading=heading, wheels=tuple(wheels or ()), separator=separator or ","
    )
    _one_each("wheels", held.wheels, robot)
    return CsvImporter(map=held)


def ros(
    robot: Robot,
    files: _Files,
    pose_topic: str | None = None,
    joint_topic: str | None = None,
    joints: _Words = None,
    pose_rotation_deg: float = 0.0,
) -> Importer:
    """ROS bags: topics and joints are guessed from types and names where they are not given.

    Parameters
    ----------
    pose_rotation_deg : float
        Angle from the robot's front to the x axis of the body whose pose is logged [deg].
    """
    from slipmargin.io.importers.ros2 import RosImporter

    if joints:
        _one_each("joints", joints, robot)
    if not abs(pose_rotation_deg) <= 360.0:
        raise InputError("pose_rotation_deg", f"is {pose_rotation_deg:g}", "give an angle up to 360 degrees")
    return RosImporter(
        pose_topic=pose_topic,
        joint_topic=joint_topic,
        joints=tuple(joints) if joints else None,
        wheels=tuple(w.name for w in robot.wheels),
        convention=robot.convention,
        pose_rotation_rad=math.radians(pose_rotation_deg),
    )


def robojackets(
    robot: Robot, files: _Files, rate_Hz: float = 60.0, ticks_per_turn: float = 6144.0
) -> Importer:
    """Recordings of the RoboJackets' SSL robots: nominal rate of rows [Hz], encoder ticks a wheel turn."""
    from slipmargin.io.importers.robojackets import RobojacketsImporter

    return RobojacketsImporter(robot=robot, rate_Hz=rate_Hz, ticks_per_turn=ticks_per_turn)


def wpilog(robot: Robot, files: _Files, pose: str | None = None, wheels: _Words = None) -> Importer:
    """WPILib's data logs of a mecanum robot.

    Parameters
    ----------
    pose : str, optional
        Name of the entry with the pose, ``NAME:deg`` or ``NAME:rad`` for an array of three numbers.
    wheels : sequence of str, optional
        One mecanum structure or array of four, in m or m/s along the floor or with a wheel's own unit
        (``NAME:rad/s``), or ``NAME:UNIT`` of a number for each wheel in the robot file's order.
    """
    from slipmargin.io.importers.channels import Wanted
    from slipmargin.io.importers.wpilog import WpilogImporter

    return WpilogImporter(wanted=Wanted(robot=robot, pose=pose, wheels=tuple(wheels or ())))


def advantagescope(robot: Robot, files: _Files, pose: str | None = None, wheels: _Words = None) -> Importer:
    """CSV that AdvantageScope exports, of a mecanum robot; the options are those of :func:`wpilog`."""
    from slipmargin.io.importers.advantagescope import AdvantageScopeImporter
    from slipmargin.io.importers.channels import Wanted

    return AdvantageScopeImporter(wanted=Wanted(robot=robot, pose=pose, wheels=tuple(wheels or ())))


def roadrunner(robot: Robot, files: _Files, length_unit: str = "in") -> Importer:
    """Logs of Road Runner's quickstart; ``length_unit`` is that of the robot's constants."""
    from slipmargin.io.importers.roadrunner import RoadRunnerImporter
    from slipmargin.io.roadrunner_log import length_of

    return RoadRunnerImporter(robot=robot, length_m=length_of(length_unit))


def lerobot(
    robot: Robot,
    files: _Files,
    tracker: Sequence[Path | str] = (),
    time: str = "t_s",
    x: str = "x_m",
    y: str = "y_m",
    heading: str = "yaw_rad",
    tracker_start_s: float = 0.0,
    wheels: _Words = None,
    episode: int | None = None,
) -> Importer:
    """LeRobot's data sets, with the pose from an external tracker's CSV.

    Parameters
    ----------
    tracker : sequence of path
        The tracker's CSV, one for all logs or one for each.
    time, x, y, heading
        Its columns with their units, like ``"yaw:deg"``; the heading is that of the robot's front.
    tracker_start_s : float
        What the tracker's clock showed when the episode began [s].
    wheels : sequence of str, optional
        ``NAME:UNIT`` in ``observation.state`` for each wheel; without it LeKiwi's body velocities.
    episode : int, optional
        The episode, where a data set has several.
    """
    from slipmargin.io.importers.csv_options import pose_columns
    from slipmargin.io.importers.lerobot import LeRobotImporter, Tracker

    if not tracker:
        raise InputError(
            "tracker",
            "is missing: the data set has no pose, and wheels alone show no slip",
            "give the CSV of a tracker with time, x, y and heading",
        )
    if len(tracker) not in (1, len(files)):
        raise InputError(
            "tracker", f"is given {len(tracker)} times", f"give one, or one for each of {len(files)}"
        )
    if not math.isfinite(tracker_start_s):
        raise InputError("tracker_start_s", f"is {tracker_start_s}", "give seconds")
    return LeRobotImporter(
        robot=robot,
        logs=tuple(files),
        tracker=Tracker(
            files=tuple(Path(file) for file in tracker),
            columns=pose_columns(time, x, y, heading),
            start_s=tracker_start_s,
        ),
        words=tuple(wheels or ()),
        episode=episode,
    )


def _one_each(option: str, given: Sequence[Any], robot: Robot) -> None:
    if len(given) != len(robot.wheels):
        raise InputError(option, f"are {len(given)}", f"give one for each of {len(robot.wheels)} wheels")


#: Name of a format → the function that makes its reader of a robot, the logs and the options.
FORMATS: dict[str, Callable[..., Importer]] = {
    f.__name__: f for f in (robotino, csv, ros, robojackets, wpilog, advantagescope, roadrunner, lerobot)
}
