"""A trajectory in the files of other tools: Choreo, PathPlanner, Road Runner, a ROS 2 bag with a
nav_msgs/Path.

All take the heading of the robot's front from the field's x axis; positions and velocities are those of
the floor frame.  :mod:`slipmargin.io.trajectory_file` reads them.

Choreo: version 3 of the ``.traj`` form (``TrajectoryFile`` in its src-core/src/spec/trajectory.rs;
ChoreoLib's ``Choreo.loadTrajectoryString`` refuses any other version), swerve samples in metres, seconds and
radians.  The modules' forces are 0: they are feedforwards of a swerve drive.

PathPlanner: the list of states of its generated JSON (``TrajectoryState.toJson``): ``pose.rotation`` and
``angularVelocity`` are those of the direction of travel, ``holonomicRotation`` [deg] and
``holonomicAngularVelocity`` [deg/s] those of the robot; velocity and acceleration along the path.

Road Runner: its path format has no time (its planner adds it), so the motion is written as the log that its
quickstart keeps of what it follows (:mod:`slipmargin.io.roadrunner_log`).

``nav_msgs/Path``: one message, each pose with its own stamp from 0 s, frame ``map``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.extra import need
from slipmargin.io.json_text import json_text
from slipmargin.io.roadrunner_log import log_text
from slipmargin.io.stage import staged
from slipmargin.io.writes import check_writable
from slipmargin.physics.convention import Convention

#: Choreo's version of the ``.traj`` form.
CHOREO_VERSION = 3
#: Below this speed a direction of travel means nothing [m/s].
_STILL = 1e-9
_PATH_TYPE, _PATH_TOPIC = "nav_msgs/msg/Path", "/plan"


def trajectory_text(
    tool: str,
    name: str,
    t_s: Array,
    pose: Array,
    velocity: Array,
    acceleration: Array,
    convention: Convention,
) -> str:
    """The file of a tool (``choreo``, ``pathplanner`` or ``roadrunner``).

    Parameters
    ----------
    t_s : (T,)
        Time [s].
    pose, velocity, acceleration : (T, 3)
        Of the body frame's origin, in the floor frame, in the robot file's ``convention``.
    """
    pose = np.column_stack([pose[:, :2], convention.yaw_of_phi(pose[:, 2])])
    return TEXTS[tool](name, t_s, pose, velocity, acceleration)


def choreo_text(name: str, t_s: Array, pose: Array, velocity: Array, acceleration: Array) -> str:
    """A ``.traj`` file of Choreo."""
    keys = ("t", "x", "y", "heading", "vx", "vy", "omega", "ax", "ay", "alpha")
    rows = np.column_stack([t_s, pose, velocity, acceleration])
    zero = [0.0] * 4
    samples = [{**dict(zip(keys, row, strict=True)), "fx": zero, "fy": zero} for row in rows.tolist()]
    step = float(np.median(np.diff(t_s)))
    return json_text(
        {
            "name": name,
            "version": CHOREO_VERSION,
            "snapshot": None,
            "params": {
                "waypoints": [_waypoint(pose[k], len(t_s) - 1 if k == 0 else 40) for k in (0, -1)],
                "constraints": [],
                "targetDt": _expression(step, "s"),
            },
            "trajectory": {
                "sampleType": "Swerve",
                "waypoints": [float(t_s[0]), float(t_s[-1])],
                "samples": samples,
                "splits": [0],
            },
            "events": [],
        }
    )


def _waypoint(pose: Array, intervals: int) -> dict[str, Any]:
    x, y, heading = (float(v) for v in pose)
    return {
        "x": _expression(x, "m"),
        "y": _expression(y, "m"),
        "heading": _expression(heading, "rad"),
        "intervals": intervals,
        "split": False,
        "fixTranslation": True,
        "fixHeading": True,
        "overrideIntervals": False,
    }


def _expression(value: float, unit: str) -> dict[str, Any]:
    return {"exp": f"{value!r} {unit}", "val": value}


def pathplanner_text(name: str, t_s: Array, pose: Array, velocity: Array, acceleration: Array) -> str:
    """The list of states of a trajectory of PathPlanner."""
    del name  # PathPlanner's states bear none
    vx, vy, ax, ay = velocity[:, 0], velocity[:, 1], acceleration[:, 0], acceleration[:, 1]
    speed = np.hypot(vx, vy)
    moving = speed > _STILL
    safe = np.where(moving, speed, 1.0)
    curvature = np.where(moving, (vx * ay - vy * ax) / safe**3, 0.0)
    # Where the robot stands it keeps its last direction; before the first it has that of its acceleration.
    last = np.maximum.accumulate(np.where(moving, np.arange(len(t_s)), -1))
    way = np.where(last < 0, np.arctan2(ay, ax), np.arctan2(vy, vx)[last])
    along = ax * np.cos(way) + ay * np.sin(way)
    return json_text(
        [
            {
                "time": float(t_s[k]),
                "pose": {
                    "translation": {"x": float(pose[k, 0]), "y": float(pose[k, 1])},
                    "rotation": {"radians": float(way[k])},
                },
                "velocity": float(speed[k]),
                "acceleration": float(along[k]),
                "curvature": float(curvature[k]),
                "holonomicRotation": math.degrees(pose[k, 2]),
                "angularVelocity": float(speed[k] * curvature[k]),
                "holonomicAngularVelocity": math.degrees(velocity[k, 2]),
            }
            for k in range(len(t_s))
        ]
    )


def road_runner_text(name: str, t_s: Array, pose: Array, velocity: Array, acceleration: Array) -> str:
    """A log of Road Runner's quickstart in inches, whose pose to follow is the motion."""
    del velocity, acceleration  # a log has poses
    return log_text(name, t_s, pose)


TEXTS: dict[str, Callable[[str, Array, Array, Array, Array], str]] = {
    "choreo": choreo_text,
    "pathplanner": pathplanner_text,
    "roadrunner": road_runner_text,
}


def write_path_bag(folder: Path, t_s: Array, pose: Array, convention: Convention) -> None:
    """A ROS 2 bag with one nav_msgs/Path, written whole or not at all.

    Raises
    ------
    InputError
        Where ``rosbags`` is not installed, or the folder is there or cannot be written.
    """
    need("ROS bag", "rosbags", "ros")
    if folder.exists():
        raise InputError("", "is there already", "give a new folder for the bag", str(folder))
    check_writable(folder.with_name(f"{folder.name}.part"))
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = store.types

    def header(time_ns: int) -> Any:
        stamp = kinds["builtin_interfaces/msg/Time"](sec=time_ns // 10**9, nanosec=time_ns % 10**9)
        return kinds["std_msgs/msg/Header"](stamp=stamp, frame_id="map")

    poses = []
    for time_s, (x, y, yaw) in zip(
        t_s - t_s[0], np.column_stack([pose[:, :2], convention.yaw_of_phi(pose[:, 2])]), strict=True
    ):
        turn = {"x": 0.0, "y": 0.0, "z": math.sin(0.5 * yaw), "w": math.cos(0.5 * yaw)}
        place = kinds["geometry_msgs/msg/Pose"](
            position=kinds["geometry_msgs/msg/Point"](x=float(x), y=float(y), z=0.0),
            orientation=kinds["geometry_msgs/msg/Quaternion"](**turn),
        )
        stamped = header(round(1e9 * float(time_s)))
        poses.append(kinds["geometry_msgs/msg/PoseStamped"](header=stamped, pose=place))
    message = kinds[_PATH_TYPE](header=header(0), poses=poses)
    with staged(folder.resolve()) as stage:
        with Writer(stage / folder.name, version=9) as bag:
            link = bag.add_connection(_PATH_TOPIC, _PATH_TYPE, typestore=store)
            bag.write(link, 0, store.serialize_cdr(message, _PATH_TYPE))
        (stage / folder.name).replace(folder)
