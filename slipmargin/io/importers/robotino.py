"""Logs of the Festo Robotino 2 slip measurements.

Source: D. Brylev, P. Belyaev, A. Filipas (Tomsk Polytechnic University), repository
BrOleg5/research-wheel-slippage, Apache-2.0.  ``;`` separated, three header lines (long names, units,
short names), irregular sampling of about 31 ms, every row closed by a separator.

Signs
-----
A motor's ticks and speed count up where its wheel carries the robot counter-clockwise; which way a wheel's
angle counts is said by its drive direction in the robot file.
Image y points down; with a = ``ang`` the robot's front is (−sin a, −cos a) in the image, so the floor frame
is (X, −Y) and the front's heading a + 90°; φ is that of the file's convention.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.importers.loose_table import LooseTable, read_loose
from slipmargin.io.importers.plug import Reading
from slipmargin.io.importers.smooth import smooth_angles
from slipmargin.io.importers.turning import turning_signs
from slipmargin.io.importers.units import factor
from slipmargin.io.robot_file import read_recipe
from slipmargin.robot import Robot

_WHEELS = (1, 2, 3)
_NEEDED = ("t", "m1pos", "m2pos", "m3pos", "xpos", "ypos", "ang")
#: Unit words where the file's unit line is missing.
_UNITS = {"t": "ms", "xpos": "pix", "ypos": "pix", "ang": "deg"}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RobotinoImporter:
    """The format and the constants of its sensors (the published ones by default).

    Parameters
    ----------
    robot : Robot
        That of the file, its wheels in the order of the motors; by default the built-in one.
    ticks_per_turn : float
        Encoder ticks per motor turn [1].
    gear : float
        Motor turns per wheel turn [1].
    scale_x_m, scale_y_m : float
        Floor distance per camera pixel [m].
    smooth_s : float
        Half width over which wheel angles are smoothed [s], 0 for none.  Encoder values stand in the
        log up to one bus cycle after they were true: unsmoothed, the wheels seem to jerk by a third of
        their speed from row to row, and a simulated robot slips on jerks that never happened.
    """

    robot: Robot = field(default_factory=lambda: read_recipe("robotino").robot)
    name: str = "robotino"
    ticks_per_turn: float = 2000.0
    gear: float = 16.0
    scale_x_m: float = 1.8405e-3
    scale_y_m: float = 1.8372e-3
    smooth_s: float = 0.2

    def __post_init__(self) -> None:
        for key in ("ticks_per_turn", "gear", "scale_x_m", "scale_y_m"):
            real(key, getattr(self, key), above=0.0, cure="give a positive number")
        real("smooth_s", self.smooth_s, low=0.0, high=2.0, cure="give a half width between 0 and 2 s")

    def read(self, path: Path) -> Reading:
        """One run.

        Raises
        ------
        InputError
            Where it is no such log, or fewer than two rows or no camera frame can be used.
        """
        table = read_loose(path, _NEEDED, ";", others=True, unit_line=True)
        t = table["t"] * _factor(table, "t", "time")
        ticks = np.stack([table[f"m{i}pos"] for i in _WHEELS], axis=1)
        sign = turning_signs(self.robot, len(_WHEELS))
        theta = sign * ticks * 2.0 * np.pi / (self.ticks_per_turn * self.gear)
        pose, lost = self._pose(table, theta)
        if len(t) < 2:
            raise InputError(f"{table.lines[0]}:1", "only one row can be used", "give a whole run")
        if not np.isfinite(pose).all(axis=1).any():
            raise InputError("xpos", "no row holds the marker", "give a run that the camera saw")
        omega, facts = None, self._facts(table, t, ticks)
        if self.smooth_s > 0.0 and np.isfinite(theta).all() and len(t) > 4:
            trembling, (theta, omega) = theta, smooth_angles(t, theta, self.smooth_s)
            tremble = float(np.sqrt(np.mean((theta - trembling) ** 2)))
            facts = (*facts, ("wheel_angle_tremble_smoothed_away_rad", tremble))
        record = Record(
            name=path.stem,
            t_s=t,
            pose=pose,
            theta=theta,
            omega=omega,
            omega_cmd=_all(table, "m{i}setvel", sign / self.gear),
            current=_all(table, "m{i}cur", 1.0),
        )
        return Reading(
            source=str(path),
            record=record,
            rows=table.rows,
            dropped=table.dropped,
            lost_frames=lost,
            notes=table.notes,
            facts=facts,
        )

    def _pose(self, table: LooseTable, theta: Array) -> tuple[Array, int]:
        """(T, 3) pose with NaN where the camera had nothing new, and how many rows that is."""
        x, y, angle = table["xpos"], table["ypos"], table["ang"]
        seen = np.isfinite(x) & np.isfinite(y) & np.isfinite(angle) & ((x != 0.0) | (y != 0.0))
        repeats = np.zeros(len(x), dtype=bool)
        repeats[1:] = (np.diff(x) == 0.0) & (np.diff(y) == 0.0) & (np.diff(angle) == 0.0)
        moved = np.abs(theta - theta[0]).max(axis=1) > 0.5  # before that, nothing new is no loss
        turning = np.zeros(len(x), dtype=bool)
        turning[1:] = np.abs(np.diff(theta, axis=0)).max(axis=1) > 1e-3
        seen &= ~(repeats & turning & moved)
        heading = np.full(len(x), np.nan)
        yaw = np.unwrap(angle[seen] * _factor(table, "ang", "angle")) + np.pi / 2.0
        heading[seen] = self.robot.convention.phi_of_yaw(yaw)
        pose = np.stack([self.scale_x_m * x, -self.scale_y_m * y, heading], axis=1)
        pose[~seen] = np.nan
        return pose, int(np.count_nonzero(~seen))

    @staticmethod
    def _facts(table: LooseTable, t: Array, ticks: Array) -> tuple[tuple[str, float], ...]:
        """Ticks per motor turn by the logged motor speed (rectangle rule over the run)."""
        speed = _all(table, "m{i}vel", 1.0)
        if speed is None or not np.isfinite(speed).all() or not np.isfinite(ticks).all():
            return ()
        turns = np.sum(speed[1:] * np.diff(t)[:, None], axis=0) / (2.0 * np.pi)
        fast = np.abs(turns) > 10.0
        if not fast.any():
            return ()
        constant = float(np.median((ticks[-1] - ticks[0])[fast] / turns[fast]))
        return (("ticks_per_turn_by_logged_speed", constant),)


def _factor(table: LooseTable, name: str, quantity: str) -> float:
    word = table.unit(name) or _UNITS[name]
    return factor(name, quantity, word)


def _all(table: LooseTable, pattern: str, scale: float | Array) -> Array | None:
    names = [pattern.format(i=i) for i in _WHEELS]
    if not all(name in table.names for name in names):
        return None
    return np.stack([table[name] for name in names], axis=1) * scale
