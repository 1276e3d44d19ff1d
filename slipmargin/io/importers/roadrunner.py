"""Logs of Road Runner's quickstart (:mod:`slipmargin.io.roadrunner_log`) of a mecanum robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.importers.loose_table import increasing, left_out
from slipmargin.io.importers.mecanum import corner_columns, forward_signs
from slipmargin.io.importers.plug import Reading
from slipmargin.io.roadrunner_log import MOTORS, POSE, read_log
from slipmargin.robot import Robot


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RoadRunnerImporter:
    """Logs of one robot; ``length_m`` is the unit of its constants, the quickstart's inch by default."""

    robot: Robot
    length_m: float = 0.0254
    name: str = "roadrunner"

    def read(self, path: Path) -> Reading:
        """One run: the estimated pose and the drive encoders.

        Raises
        ------
        InputError
            Where it is no such log, or has no drive encoders.
        """
        log = read_log(path)
        pose = log.pose(POSE, self.length_m)
        pose[:, 2] = self.robot.convention.phi_of_yaw(pose[:, 2])
        turn = 2.0 * math.pi * log.number("gearRatio") / log.number("ticksPerRev")
        order, sign = corner_columns(self.robot, MOTORS), forward_signs(self.robot)
        keys = {"driveEncPositions": "theta", "driveEncVels": "omega"}
        there = {field: key for key, field in keys.items() if log.has(key)}
        if not there:
            raise InputError(
                "driveEncPositions",
                "is empty: the pose alone does not say what the wheels did",
                "log the drive encoders too (LogFiles.record with lastEncPositions)",
            )
        keep, notes = increasing(log.t_s)
        signals: dict[str, Any] = {
            field: (log.wheels(key)[:, order] * turn * sign)[keep] for field, key in there.items()
        }
        bad = np.setdiff1d(np.arange(len(log.t_s)), keep)
        if len(keep) < 2:
            raise InputError("nsTimes", "do not increase", "give the log as the robot wrote it")
        if not log.has("trackingEncPositions"):
            notes.append(
                "no tracking wheels are in the log: a pose that is computed from the drive wheels cannot "
                "show that they slip"
            )
        t = log.t_s[keep]
        record = Record(name=path.stem, t_s=t - t[0], pose=pose[keep], **signals)
        why = "its time does not come after the one before"
        return Reading(
            source=str(path),
            record=record,
            rows=len(log.t_s),
            dropped=tuple(left_out(bad, why)),
            notes=tuple(notes),
        )
