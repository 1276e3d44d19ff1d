"""The CSV files of a data set: one run each, and the pulls."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.pulls import Pulls
from slipmargin.data.record import Record
from slipmargin.errors import InputError
from slipmargin.io.table import Columns, columns_parts, columns_text, read_columns
from slipmargin.robot.mistakes import LARGEST_PULL_N

_POSE = ("x_m", "y_m", "phi_rad")
#: Field of a record → the column's name for wheel i.
WHEEL_COLUMNS = {
    "omega": "omega{i}_rad_s",
    "theta": "theta{i}_rad",
    "omega_cmd": "omega{i}_cmd_rad_s",
    "current": "current{i}_A",
}
#: Times of a nominal rate are off it by this share of a row at most: they were rounded when written.
_OFF_NOMINAL = 0.01


def read_trial(path: Path, wheels: int, rate_Hz: float | None = None) -> Record:
    """One run as the contract writes it; at a nominal rate [Hz] rows need no time, and have no other one.

    Raises
    ------
    InputError
        If a column is unknown or missing, a cell is no number, time does not increase, or is not that of
        the nominal rate.
    """
    named = {
        field: [pattern.format(i=i + 1) for i in range(wheels)] for field, pattern in WHEEL_COLUMNS.items()
    }
    known = [name for names in named.values() for name in names]
    empty = [*_POSE, *known]
    required = _POSE if rate_Hz is not None else ("t_s", *_POSE)
    table = read_columns(path, required=required, known=[*known, "t_s"], empty=empty, least=2)
    nominal = None if rate_Hz is None else np.arange(len(table.values)) / rate_Hz
    time = table["t_s"] if nominal is None or "t_s" in table.names else nominal
    signals: dict[str, Any] = {}
    for field, names in named.items():
        if any(name in table.names for name in names):
            gap = np.full(len(table.values), np.nan)
            signals[field] = np.stack([table[n] if n in table.names else gap for n in names], axis=1)
    late = np.flatnonzero(np.diff(time) <= 0.0)
    try:
        if len(late):
            row = int(late[0]) + 1
            column = table.names.index("t_s") + 1
            raise InputError(
                f"{table.lines[row]}:{column}",
                f"the time {time[row]:g} s does not come after the row before",
                "time must increase from row to row",
            )
        if nominal is not None and np.max(np.abs(time - time[0] - nominal)) * rate_Hz > _OFF_NOMINAL:
            raise InputError(
                f"1:{table.names.index('t_s') + 1}",
                f"t_s has other times than nominal_rate_Hz = {rate_Hz:g} in dataset.toml",
                "remove nominal_rate_Hz if rows were stamped, else the column t_s",
            )
        return Record(name=path.stem, t_s=time, pose=table.stack(_POSE), **signals)
    except InputError as fault:
        raise fault.in_file(str(path)) from None


#: Columns of pulls.csv that need not be there, besides the wheel angles.
_PULL_EXTRA = ("direction_rad", "point_x_m", "point_y_m", "height_m")
#: A robot is not turned further than this before a pull; degrees read as radians are [rad].
_MOST_TURNED_RAD = 8.0 * np.pi


def read_pulls(path: Path, wheels: int) -> Pulls:
    """The pulls of a data set, one row each.

    ``phi_rad,force_N``, and where known ``theta{i}_rad`` (wheel angles), ``direction_rad`` (of the pull, in
    the floor frame), ``point_x_m,point_y_m`` (where it pulls, in the body frame) and ``height_m``.

    Raises
    ------
    InputError
        If a column is unknown or missing, a cell is no number, a force is not positive, or an angle can
        only be in degrees.
    """
    theta = [f"theta{i + 1}_rad" for i in range(wheels)]
    table = read_columns(path, required=("phi_rad", "force_N"), known=[*theta, *_PULL_EXTRA], empty=())
    for names, cure in ((theta, "give the angle of every wheel or of none"), (_PULL_EXTRA[1:3], "give both")):
        given = [name for name in names if name in table.names]
        if given and len(given) < len(names):
            lacks = next(name for name in names if name not in table.names)
            raise InputError("1:1", f"the column {lacks!r} is missing", cure, str(path))

    def columns(*names: str) -> Array | None:
        return table.stack(names) if names[0] in table.names else None

    try:
        for name in ("phi_rad", "direction_rad"):
            _check_cells(
                table, name, np.abs(_column(table, name)) > _MOST_TURNED_RAD, "divide degrees by 57.296"
            )
        force = table["force_N"]
        wrong = (force <= 0.0) | (force > LARGEST_PULL_N)
        _check_cells(table, "force_N", wrong, "give the size of the pull in newtons")
        _check_cells(
            table, "height_m", _column(table, "height_m") < 0.0, "give the height above the floor [m]"
        )
    except InputError as fault:
        raise fault.in_file(str(path)) from None
    direction, height = columns("direction_rad"), columns("height_m")
    return Pulls(
        phi_rad=table["phi_rad"],
        force_N=table["force_N"],
        theta_rad=columns(*theta),
        direction_rad=None if direction is None else direction[:, 0],
        point_m=columns("point_x_m", "point_y_m"),
        height_m=None if height is None else height[:, 0],
    )


def _column(table: Columns, name: str) -> Array:
    return table[name] if name in table.names else np.zeros(len(table.values))


def _check_cells(table: Columns, name: str, wrong: NDArray[np.bool_], cure: str) -> None:
    """Refuse the first cell of a column that is wrong, by its place in the file."""
    if wrong.any():
        row = int(np.argmax(wrong))
        place = f"{table.lines[row]}:{table.names.index(name) + 1}"
        raise InputError(place, f"{name} is {table[name][row]:g}", cure)


def trial_parts(record: Record) -> Iterator[str]:
    """A run as the CSV that :func:`read_trial` reads back, in parts; channels nobody has are left out."""
    columns: dict[str, Array] = {"t_s": record.t_s}
    columns |= {name: record.pose[:, j] for j, name in enumerate(_POSE)}
    for field, pattern in WHEEL_COLUMNS.items():
        signal: Array | None = getattr(record, field)
        if signal is None:
            continue
        for i, channel in enumerate(signal.T):
            if np.isfinite(channel).any():
                columns[pattern.format(i=i + 1)] = channel
    return columns_parts(columns)


def pulls_text(pulls: Pulls) -> str:
    """Pulls as the CSV text that :func:`read_pulls` reads back."""
    columns = {"phi_rad": pulls.phi_rad, "force_N": pulls.force_N}
    if pulls.theta_rad is not None:
        columns |= {f"theta{i + 1}_rad": angle for i, angle in enumerate(pulls.theta_rad.T)}
    if pulls.direction_rad is not None:
        columns["direction_rad"] = pulls.direction_rad
    if pulls.point_m is not None:
        columns |= {"point_x_m": pulls.point_m[:, 0], "point_y_m": pulls.point_m[:, 1]}
    if pulls.height_m is not None:
        columns["height_m"] = pulls.height_m
    return columns_text(columns)
