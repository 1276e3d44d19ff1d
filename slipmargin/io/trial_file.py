"""The CSV files of a data set: one run each, and the pulls."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.errors import InputError
from slipmargin.io.table import read_columns
from slipmargin.motions.record import Record

_POSE = ("x_m", "y_m", "phi_rad")
#: Field of a record → the column's name for wheel i.
WHEEL_COLUMNS = {
    "omega": "omega{i}_rad_s",
    "theta": "theta{i}_rad",
    "omega_cmd": "omega{i}_cmd_rad_s",
    "current": "current{i}_A",
}


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pulls:
    """Measured breakaway pulls: direction (P,) [rad], force (P,) [N], rotor angles (P, N) [rad] or None."""

    phi_rad: Array
    force_N: Array
    theta_rad: Array | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "phi_rad", frozen("phi_rad", self.phi_rad, (None,)))
        put(self, "force_N", frozen("force_N", self.force_N, (len(self.phi_rad),)))
        if self.theta_rad is not None:
            put(self, "theta_rad", frozen("theta", self.theta_rad, (len(self.phi_rad), None)))


def read_trial(path: Path, wheels: int) -> Record:
    """One run as the contract writes it.

    Raises
    ------
    InputError
        If a column is unknown or missing, a cell is no number, or time does not increase.
    """
    names, values = _read_csv(path)
    try:
        for name in ("t_s", *_POSE):
            if name not in names:
                raise InputError(name, "this column is missing", f"a trial needs t_s, {', '.join(_POSE)}")
        columns = dict(zip(names, values.T, strict=True))
        known = {"t_s", *_POSE}
        signals: dict[str, Array | None] = {}
        for field, pattern in WHEEL_COLUMNS.items():
            wanted = [pattern.format(i=i + 1) for i in range(wheels)]
            known.update(wanted)
            here = [columns.get(name) for name in wanted]
            if any(column is not None for column in here):
                empty = np.full(len(values), np.nan)
                signals[field] = np.stack([empty if c is None else c for c in here], axis=1)
        _refuse(names, known, wheels)
        return Record(name=path.stem, t_s=columns["t_s"], pose=np.stack([columns[n] for n in _POSE], axis=1),
                      **signals)
    except InputError as fault:
        raise fault.in_file(fault.source or str(path)) from None


def read_pulls(path: Path, wheels: int) -> Pulls:
    """The pulls of a data set: ``phi_rad,force_N`` and ``theta{i}_rad`` where rotor angles are known."""
    names, values = _read_csv(path)
    theta = [f"theta{i + 1}_rad" for i in range(wheels)]
    try:
        for name in ("phi_rad", "force_N"):
            if name not in names:
                raise InputError(name, "this column is missing", "pulls need phi_rad and force_N")
        _refuse(names, {"phi_rad", "force_N", *theta}, wheels)
        given = [name for name in theta if name in names]
        if given and len(given) < wheels:
            lacks = next(name for name in theta if name not in names)
            raise InputError(lacks, "this column is missing", "give the angle of every wheel or of none")
        columns = dict(zip(names, values.T, strict=True))
        return Pulls(phi_rad=columns["phi_rad"], force_N=columns["force_N"],
                     theta_rad=np.stack([columns[n] for n in theta], axis=1) if given else None)
    except InputError as fault:
        raise fault.in_file(fault.source or str(path)) from None


def _refuse(names: list[str], known: set[str], wheels: int) -> None:
    for name in names:
        if name in known:
            continue
        match = re.fullmatch(r"(?:omega|theta|current)(\d+)_(?:rad_s|rad|A|cmd_rad_s)", name)
        if match and int(match[1]) > wheels:
            raise InputError(name, f"the robot has {wheels} wheels",
                             "remove the column or describe the wheel")
        raise InputError(name, "is not a known column",
                         f"rename or remove it (known: {', '.join(sorted(known))})")


def _read_csv(path: Path) -> tuple[list[str], Array]:
    """Header and numbers (rows, columns); an empty cell is NaN."""
    table = read_columns(path, empty=None)
    return list(table.names), table.values
