"""Recordings of encoders and overhead camera of the RoboJackets' RoboCup SSL robots (robocup-firmware-data).

One row a camera frame, cells separated by spaces: ``bot_id x y ang enc0 enc1 …``; x, y [mm], ang [rad] the
direction of the front, enc ticks since the row before, which count up where a wheel carries the robot
clockwise.  There are no time stamps: rows come at a nominal rate, and the camera is late by a delay that
nobody recorded.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import real
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.importers.plug import Reading
from slipmargin.io.importers.turning import turning_signs
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.source import read_text
from slipmargin.robot import Robot

_HEAD = ("bot_id", "x", "y", "ang")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RobojacketsImporter:
    """The format and the constants of its sensors (the published ones by default).

    Parameters
    ----------
    rate_Hz : float
        Nominal rows a second.
    ticks_per_turn : float
        Encoder ticks per wheel turn [1].
    robot : Robot
        That of the file, its wheels in the order of the encoders; by default the built-in one.
    """

    name: str = "robojackets"
    rate_Hz: float = 60.0
    ticks_per_turn: float = 6144.0
    robot: Robot = field(default_factory=lambda: read_recipe("robojackets-2018").robot)

    def __post_init__(self) -> None:
        for key in ("rate_Hz", "ticks_per_turn"):
            real(key, getattr(self, key), above=0.0, cure="give a positive number")

    def read(self, path: Path) -> Reading:
        """One recording.

        Raises
        ------
        InputError
            Where the columns are others, a cell is no number, or there are fewer than two rows.
        """
        lines = read_text(path).splitlines()
        names = lines[0].split() if lines else []
        if tuple(names[:4]) != _HEAD or not all(n.startswith("enc") for n in names[4:]) or len(names) < 7:
            raise InputError(
                "1:1", "is not the head of such a recording", f"give {' '.join(_HEAD)} enc0 enc1 …"
            )
        rows = []
        for number, line in enumerate(lines[1:], 2):
            if not line.strip():
                continue
            try:
                row = [float(cell) for cell in line.split()]
            except ValueError:
                raise InputError(f"{number}:1", "holds a cell that is no number", "correct the row") from None
            if len(row) != len(names) or not np.isfinite(row).all():
                raise InputError(f"{number}:1", f"has {len(row)} cells", f"give {len(names)} finite numbers")
            rows.append(row)
        if len(rows) < 2:
            raise InputError("2:1", "there are fewer than two rows", "give a whole recording")
        table = np.array(rows)
        if len(np.unique(table[:, 0])) > 1:
            raise InputError("2:1", "holds several robots", "split the recording by bot_id")
        heading = self.robot.convention.phi_of_yaw(np.unwrap(table[:, 3]))
        ticks = np.cumsum(table[:, 4:], axis=0)
        sign = -turning_signs(self.robot, ticks.shape[1])
        record = Record(
            name=path.stem,
            t_s=np.arange(len(table)) / self.rate_Hz,
            pose=np.column_stack([1e-3 * table[:, 1], 1e-3 * table[:, 2], heading]),
            theta=sign * ticks * 2.0 * np.pi / self.ticks_per_turn,
        )
        note = f"no time stamps: rows were taken to come at {self.rate_Hz:g} Hz"
        return Reading(source=str(path), record=record, rows=len(table), notes=(note,))
