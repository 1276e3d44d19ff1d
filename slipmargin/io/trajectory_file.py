"""A trajectory from a file of any known form, told by its content.

The forms: our CSV, Choreo, PathPlanner, a log of Road Runner, a ROS bag.

``nav_msgs/Path``: the poses' own header stamps are the time, and ROS has the body's x axis forward and y left
(REP 103, "In relation to a body the standard is: x forward, y left, z up"), as for the JSON forms
(:mod:`~slipmargin.io.trajectory_json`).  Our CSV is in the robot file's convention and is taken as it is.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from slipmargin.checks import LARGEST
from slipmargin.errors import InputError
from slipmargin.io.source import read_bytes, text_of
from slipmargin.io.table import columns_from_text, header_names
from slipmargin.io.trajectory_json import (
    SAME_POSE,
    Claim,
    Samples,
    samples_from_json,
    unknown_form,
    without_repetitions,
)
from slipmargin.physics.convention import Convention

#: What our own form is called.
CSV = "CSV"
#: Columns that a CSV must have; rates that it may have, each beside what it is the rate of.
NEEDED = ("t_s", "x_m", "y_m", "phi_rad")
RATES = (
    ("velocity", "m/s", ("x_m", "y_m"), ("vx_m_s", "vy_m_s")),
    ("angular velocity", "rad/s", ("phi_rad",), ("wz_rad_s",)),
    ("acceleration", "m/s²", ("vx_m_s", "vy_m_s"), ("ax_m_s2", "ay_m_s2")),
    ("angular acceleration", "rad/s²", ("wz_rad_s",), ("alpha_rad_s2",)),
)
#: Columns that a plan writes beside its trajectory: they follow from it, and are computed anew.
_OF_PLANS = re.compile(r"(omega\d+_rad_s|use\d+)")
#: First bytes of a bag in one file: ROS 1, MCAP, SQLite.
BAGS = (b"#ROSBAG", b"\x89MCAP", b"SQLite format 3")
#: Share of the largest stated rate that a rate may be off before it is a contradiction [1].
AGREES = 0.02


def read_trajectory(
    path: Path | str, topic: str | None = None, convention: Convention = Convention.PAPER
) -> Samples:
    """The trajectory in a file, in the robot's convention.

    Parameters
    ----------
    path : path or str
        A CSV with at least ``t_s,x_m,y_m,phi_rad``, a Choreo ``.traj``, a PathPlanner trajectory JSON, a log
        of Road Runner (inches), or a ROS bag (file or folder).
    topic : str, optional
        Topic of the nav_msgs/Path, where the bag has more than one.
    convention : Convention
        The robot file's.

    Raises
    ------
    InputError
        With the file and the place in it.
    """
    path = Path(path)
    try:
        data = None if path.is_dir() else read_bytes(path, unless=BAGS)
        if data is None or data.startswith(BAGS):
            return _turned(_from_bag(path, topic), convention)
        found = _turned(_with_contradictions(_from_text(text_of(data, str(path)))), convention)
    except InputError as fault:
        raise fault.in_file(fault.source or str(path)) from None
    if topic is not None:
        raise InputError("topic", f"is for ROS bags, and {path.name} is none", "leave it out")
    return found


def _turned(found: Samples, convention: Convention) -> Samples:
    """Headings of the front, as the other tools count them, as φ of the robot file's convention."""
    if found.form == CSV:
        return found
    phi = convention.phi_of_yaw(np.unwrap(found.pose[:, 2]))
    return replace(found, pose=np.column_stack([found.pose[:, :2], phi]))


def _from_text(text: str) -> Samples:
    if text.lstrip().startswith(("{", "[")):
        return samples_from_json(text)
    header = text.lstrip("\r\n").partition("\n")[0]
    table = any(mark in header for mark in ",;\t")  # a table without the columns says which it has
    if text.strip() and not table and not any(name in header for name in NEEDED):
        raise unknown_form()
    others = tuple(name for name in header_names(header) if name not in NEEDED)
    columns = columns_from_text(text, required=NEEDED, known=None, empty=others, least=1)
    names = set(columns.names)
    claims: list[Claim] = []
    compared: set[str] = set()
    for name, unit, of, rate in RATES:
        if names >= {*of, *rate}:
            claim = Claim(name=name, unit=unit, values=columns.stack(of), rate=columns.stack(rate))
            if np.isfinite(claim.rate).all() and np.isfinite(claim.values).all():
                claims.append(claim)
                compared |= {*rate}
    unread = [n for n in others if n not in compared and not _OF_PLANS.fullmatch(n)]
    return Samples(
        form=CSV,
        t_s=columns["t_s"],
        pose=columns.stack(NEEDED[1:]),
        claims=tuple(claims),
        notes=(f"columns not read: {', '.join(unread)}{_incomplete(unread)}",) if unread else (),
    )


def _incomplete(unread: list[str]) -> str:
    """Why rates are not read."""
    rates = {name for _, _, _, rate in RATES for name in rate}
    return " (rates are compared where all of theirs are there, in every row)" if rates & {*unread} else ""


def _from_bag(path: Path, topic: str | None) -> Samples:
    from slipmargin.io.importers.ros2 import bag_messages, pose_of

    def pick(types: dict[str, str]) -> list[str]:
        paths = sorted(name for name, kind in types.items() if kind == "nav_msgs/msg/Path")
        if topic is not None:
            paths = [name for name in paths if name == topic]
        if len(paths) != 1:
            have = ", ".join(f"{name} ({kind})" for name, kind in sorted(types.items()))
            problem = (
                f"{len(paths)} topics are a nav_msgs/msg/Path" if paths else "no nav_msgs/msg/Path there"
            )
            raise InputError(topic or "", problem, f"name one with --topic (the bag has: {have[:300]})")
        return paths

    if path.is_dir() and not (path / "metadata.yaml").exists():
        raise unknown_form()
    ((name, messages),) = bag_messages(path, pick).items()
    if not messages:
        raise InputError(name, "holds no message", "record the path")
    poses = messages[-1][1].poses
    if not poses:
        raise InputError(name, "its last message holds no pose", "record a whole path")
    stamps = [p.header.stamp.sec * 10**9 + p.header.stamp.nanosec for p in poses]
    if len(set(stamps)) == 1 and len(poses) > 1:
        raise InputError(
            name, "all poses carry the same stamp", "give each pose the time at which it is to be reached"
        )
    for k, stamped in enumerate(poses):
        q = stamped.pose.orientation
        if not abs(math.hypot(q.x, q.y, q.z, q.w) - 1.0) < 0.1:
            raise InputError(f"{name}.poses[{k}]", "its orientation is no rotation", "give a unit quaternion")
    t_s = np.array([(stamp - stamps[0]) * 1e-9 for stamp in stamps])  # whole nanoseconds, then seconds
    pose = np.array([pose_of(stamped) for stamped in poses])
    usable = (np.abs(pose) < LARGEST).all(axis=1)
    if not usable.all():
        row = int(np.argmin(usable))
        raise InputError(f"{name}.poses[{row}]", "is not finite", "give finite numbers below 1e12")
    pose[:, 2] = np.unwrap(pose[:, 2])
    (t_s, pose), notes = without_repetitions(f"{name}.poses", t_s, pose)
    if len(messages) > 1:
        notes += (f"{name} holds {len(messages)} paths; the last one is read",)
    return Samples(form="nav_msgs/Path", t_s=t_s, pose=pose, notes=notes)


def _with_contradictions(found: Samples) -> Samples:
    """The samples with a note for each stated rate that the values do not have.

    Between two samples the mean rate lies between the two stated ones, but for the curvature of the rate, a
    share of its largest value and the rounding of the file.
    """
    step = np.diff(found.t_s)[:, None]
    if len(found.t_s) < 3 or np.min(step) <= 0.0:
        return found  # the check names the row
    notes = []
    for claim in found.claims:
        values = np.unwrap(claim.values, axis=0) if claim.unit == "rad/s" else claim.values
        mean, rate = np.diff(values, axis=0) / step, claim.rate
        low, high = np.minimum(rate[:-1], rate[1:]), np.maximum(rate[:-1], rate[1:])
        bend = np.zeros_like(rate)
        bend[1:-1] = np.abs(rate[2:] - 2.0 * rate[1:-1] + rate[:-2])
        slack = 0.5 * np.maximum(bend[:-1], bend[1:]) + AGREES * np.max(np.abs(rate)) + SAME_POSE / step
        excess = np.maximum(low - slack - mean, mean - high - slack)
        i, k = np.unravel_index(int(np.argmax(excess)), excess.shape)
        if excess[i, k] > 0.0:
            notes.append(
                f"the stated {claim.name} contradicts the samples between t = {found.t_s[i]:.4g} and "
                f"{found.t_s[i + 1]:.4g} s: {rate[i, k]:.4g} and {rate[i + 1, k]:.4g} {claim.unit} stated, "
                f"{mean[i, k]:.4g} {claim.unit} by the samples; the poses are checked"
            )
    return Samples(
        form=found.form,
        t_s=found.t_s,
        pose=found.pose,
        claims=found.claims,
        notes=(*found.notes, *notes),
    )
