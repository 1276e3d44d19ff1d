"""ROS bags (ROS 1 and 2) through the ``rosbags`` package, which needs no ROS: the extra ``[ros]``.

Pose from ``geometry_msgs/PoseStamped``, ``PoseWithCovarianceStamped``, ``TransformStamped``,
``nav_msgs/Odometry`` or ``tf2_msgs/TFMessage``; wheels from ``sensor_msgs/JointState``.  Stamps are the
headers' where given, else the bag's.  A record has one clock: rows stand at the pose's stamps, wheels
interpolated there.  The yaw of a pose is that of the robot's front (REP 103, "In relation to a body the
standard is: x forward, y left, z up"), so φ is the robot file's convention of it; wheels keep their signs.
Topics and joints that are not named are guessed from types and names, and the reading says which.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from sqlite3 import Error as SqlError
from struct import error as StructError
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.extra import need
from slipmargin.io.importers.loose_table import increasing, left_out
from slipmargin.io.importers.plug import Reading
from slipmargin.io.importers.ros_names import guessed_topic, joints_of_wheels
from slipmargin.io.source import DAMAGE
from slipmargin.physics.convention import Convention

#: A topic and its messages, each with the bag's time [ns].
_Topic = tuple[str, list[tuple[int, Any]]]
#: Frames of a robot's base (REP 105, REP 120).
BASES = ("base_link", "base_footprint")
#: A quaternion whose length is off by more is no rotation [1]: rounding leaves 1e-7, a wrong field anything.
_UNIT = 0.1
#: What readers of YAML and CDR stumble over in a damaged bag.
_DAMAGE = (*DAMAGE, StructError)


def bag_messages(path: Path, pick: Callable[[dict[str, str]], list[str]]) -> dict[str, list[tuple[int, Any]]]:
    """Messages of a bag by topic, each with the bag's time [ns]; ``pick`` chooses among topic → type.

    Raises
    ------
    InputError
        Where ``rosbags`` is not installed, or it is no bag that can be read.
    """
    need("ROS bag", "rosbags", "ros")
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.rosbag1 import ReaderError as Ros1Error
    from rosbags.rosbag2 import ReaderError as Ros2Error
    from rosbags.serde import SerdeError
    from rosbags.typesys import Stores, get_typestore

    told: tuple[type[Exception], ...] = (AnyReaderError, Ros1Error, Ros2Error, SerdeError, OSError)
    told += (*_database_errors(), *_DAMAGE)
    if not path.exists():
        raise InputError("", "there is no such bag", "give a bag's folder or file", str(path))
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag:
            wanted = pick({name: str(topic.msgtype) for name, topic in bag.topics.items()})
            found: dict[str, list[tuple[int, Any]]] = {topic: [] for topic in wanted}
            for connection, time, raw in bag.messages([c for c in bag.connections if c.topic in found]):
                found[connection.topic].append((time, bag.deserialize(raw, connection.msgtype)))
    except told as fault:
        raise InputError(
            "",
            f"is no bag that can be read ({type(fault).__name__})",
            "give a bag's folder or file",
            str(path),
        ) from None
    return found


def _database_errors() -> tuple[type[Exception], ...]:
    """The failures of the SQLite library that this version of rosbags reads with."""
    if find_spec("apsw") is None:
        return (SqlError,)
    from apsw import Error

    return (SqlError, Error)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RosImporter:
    """Bags of one robot: where its pose and its wheels are published.

    ``joints`` (N,) names in the order of the robot file's wheels; a leading ``-`` turns the sign.  Without
    them they are found by the names of the ``wheels``.  ``pose_rotation_rad`` is the angle from the robot's
    front to the x axis of the body whose pose is logged, counter-clockwise.
    """

    pose_topic: str | None = None
    joint_topic: str | None = None
    joints: tuple[str, ...] | None = None
    wheels: tuple[str, ...] = ()
    convention: Convention = Convention.PAPER
    pose_rotation_rad: float = 0.0
    name: str = "ros"

    def read(self, path: Path) -> Reading:
        """One run.

        Raises
        ------
        InputError
            Where ``rosbags`` is not installed, it is no bag, or a topic or joint is missing.
        """
        (pose_topic, poses), (joint_topic, joints), notes = self._messages(path)
        names = self._joints(joint_topic, joints, notes)
        pose = np.array([pose_of(m) for _, m in poses])
        stamp = np.array([_stamp(bag, m) for bag, m in poses])
        keep, order = increasing(stamp)
        notes += order
        t, pose = stamp[keep], pose[keep]
        bad = np.setdiff1d(np.arange(len(stamp)), keep)
        why = "its stamp does not come after the one before"
        seen = np.isfinite(pose).all(axis=1)
        if len(t) < 2 or not seen.any():
            raise InputError(pose_topic, f"holds {int(seen.sum())} poses", "record a whole run")
        pose[seen, 2] = self.convention.phi_of_yaw(np.unwrap(pose[seen, 2]) - self.pose_rotation_rad)
        wheels = self._wheels(joint_topic, names, joints, t)
        record = Record(
            name=path.stem,
            t_s=t - t[0],
            pose=pose,
            theta=wheels.get("position"),
            omega=wheels.get("velocity"),
        )
        return Reading(
            source=str(path),
            record=record,
            rows=len(stamp),
            dropped=tuple(left_out(bad, why)),
            lost_frames=int(np.count_nonzero(~seen)),
            notes=tuple(notes),
        )

    def _messages(self, path: Path) -> tuple[_Topic, _Topic, list[str]]:
        notes: list[str] = []
        picked: list[str] = []

        def pick(types: dict[str, str]) -> list[str]:
            for topic, option in ((self.pose_topic, "--pose-topic"), (self.joint_topic, "--joint-topic")):
                if topic is None:
                    topic, note = guessed_topic(types, option)
                    notes.append(note)
                elif topic not in types:
                    known = ", ".join(sorted(types))
                    raise InputError(topic, "is not a topic of the bag", f"use one of: {known}", str(path))
                picked.append(topic)
            return picked

        found = bag_messages(path, pick)
        pose, joints = picked
        return (pose, _transforms(pose, found[pose])), (joints, found[joints]), notes

    def _joints(self, topic: str, joints: list[tuple[int, Any]], notes: list[str]) -> tuple[str, ...]:
        if self.joints is not None:
            return self.joints
        there = sorted({str(n) for _, m in joints for n in m.name})
        found = joints_of_wheels(self.wheels, there, topic)
        pairs = ", ".join(f"{w} = {j}" for w, j in zip(self.wheels, found, strict=True))
        notes.append(f"joints of the wheels by their names: {pairs}")
        return found

    def _wheels(
        self, topic: str, names: tuple[str, ...], joints: list[tuple[int, Any]], t: Array
    ) -> dict[str, Array]:
        stamp = np.array([_stamp(bag, m) for bag, m in joints])
        if not len(stamp):
            raise InputError(topic, "holds no message", "record the wheels too")
        out: dict[str, Array] = {}
        order = np.argsort(stamp, kind="stable")
        for field in ("position", "velocity"):
            columns = [self._joint(joints, name, field)[order] for name in names]
            if all(np.isfinite(c).any() for c in columns):
                out[field] = np.stack([_at(t, stamp[order], c) for c in columns], axis=1)
        if not out:
            raise InputError(
                topic,
                "holds neither position nor velocity of these joints",
                "publish wheel positions",
            )
        return out

    def _joint(self, joints: list[tuple[int, Any]], signed: str, field: str) -> Array:
        sign, name = (-1.0, signed[1:]) if signed.startswith("-") else (1.0, signed)
        values = np.full(len(joints), np.nan)
        for row, (_, message) in enumerate(joints):
            names, numbers = list(message.name), getattr(message, field)
            if name in names and len(numbers) == len(names):
                values[row] = sign * float(numbers[names.index(name)])
        if field == "position" and not any(name in list(m.name) for _, m in joints):
            known = sorted({n for _, m in joints for n in m.name})
            raise InputError("--joint", f"{name!r} is not a joint", f"use some of: {', '.join(known)}")
        return values


def _transforms(topic: str, messages: list[tuple[int, Any]]) -> list[tuple[int, Any]]:
    """The robot's base in the messages of TF; others as they are."""
    if not messages or not hasattr(messages[0][1], "transforms"):
        return messages
    found = [(at, t) for at, m in messages for t in m.transforms if t.child_frame_id.strip("/") in BASES]
    frames = sorted({f"{t.header.frame_id} to {t.child_frame_id}" for _, t in found})
    if len(frames) != 1:
        raise InputError(
            topic,
            f"holds {len(frames)} transforms to {' or '.join(BASES)}: {', '.join(frames) or 'none'}",
            "record the pose as a topic of its own and name it with --pose-topic",
        )
    return found


def _at(t: Array, stamp: Array, values: Array) -> Array:
    """``values`` at ``t``; outside the stamps nothing is known."""
    known = np.isfinite(values)
    return np.interp(t, stamp[known], values[known], left=np.nan, right=np.nan)


def _stamp(bag_ns: int, message: Any) -> float:
    header = getattr(message, "header", None)
    if header is None or (header.stamp.sec == 0 and header.stamp.nanosec == 0):
        return bag_ns * 1e-9
    return float(header.stamp.sec) + 1e-9 * float(header.stamp.nanosec)


def pose_of(message: Any) -> tuple[float, float, float]:
    """x, y, yaw of any of the pose messages; the quaternion's turn about +z, NaN where it is no rotation."""
    inner = getattr(message, "pose", None) or getattr(message, "transform", None)
    if inner is None:
        raise InputError(
            "--pose-topic",
            f"holds {type(message).__name__}",
            "give PoseStamped, Odometry, TransformStamped or TFMessage",
        )
    inner = getattr(inner, "pose", inner)
    place = getattr(inner, "position", None) or inner.translation
    q = getattr(inner, "orientation", None) or inner.rotation
    length = math.hypot(q.w, q.x, q.y, q.z)  # 0: a message that nobody filled in
    if length > 0.0 and not abs(length - 1.0) <= _UNIT:
        return float(place.x), float(place.y), math.nan
    yaw = math.atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y**2 + q.z**2))
    return float(place.x), float(place.y), yaw
