"""WPILib's data logs (``.wpilog``) of a mecanum robot, through WPILib's own reader: the extra ``[frc]``.

A log is a series of records with stamps in microseconds; entries have a name and a type.  Read are
``struct:Pose2d``
(x, y, rotation; three doubles), ``struct:Pose3d`` (x, y, z and the quaternion w, x, y, z), the mecanum
structures (four doubles: front left, front right, rear left, rear right) and plain numbers; all little-endian
(WPILib, datalog.adoc and the classes' ``getSchema``).
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from statistics import mode
from typing import Any, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.extra import need
from slipmargin.io.importers.channels import Channel, Kind, Wanted, reading
from slipmargin.io.importers.plug import Reading
from slipmargin.io.source import read_bytes

_Decode = Callable[[bytes], tuple[float, ...]]
#: The first bytes of every log.
_MAGIC = b"WPILOG"


def _doubles(count: int) -> _Decode:
    layout = struct.Struct(f"<{count}d")
    return lambda raw: layout.unpack(raw)


def _pose3d(raw: bytes) -> tuple[float, ...]:
    x, y, _, w, i, j, k = struct.unpack("<7d", raw)
    return x, y, float(np.arctan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k)))


def _array(raw: bytes) -> tuple[float, ...]:
    return struct.unpack(f"<{len(raw) // 8}d", raw)


#: Type of an entry → what it is and how one record of it is read.
_TYPES: dict[str, tuple[Kind, _Decode]] = {
    "struct:Pose2d": (Kind.POSE, _doubles(3)),
    "struct:Pose3d": (Kind.POSE, _pose3d),
    "struct:MecanumDriveWheelSpeeds": (Kind.SPEEDS, _doubles(4)),
    "struct:MecanumDriveWheelPositions": (Kind.POSITIONS, _doubles(4)),
    "double": (Kind.NUMBER, _doubles(1)),
    "float": (Kind.NUMBER, lambda raw: struct.unpack("<f", raw)),
    "int64": (Kind.NUMBER, lambda raw: struct.unpack("<q", raw)),
    "double[]": (Kind.NUMBERS, _array),
    "struct:SwerveModuleState[]": (Kind.SWERVE, lambda raw: (float(len(raw)),)),
    "struct:SwerveModulePosition[]": (Kind.SWERVE, lambda raw: (float(len(raw)),)),
}


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WpilogImporter:
    """Logs of one robot: which entries hold its pose and its wheels, by type where they are not named."""

    wanted: Wanted
    name: str = "wpilog"

    def read(self, path: Path) -> Reading:
        """One run.

        Raises
        ------
        InputError
            Where it is no such log, or holds no pose or wheels.
        """
        return reading(path, entries(path), self.wanted)


def entries(path: Path) -> dict[str, Channel]:
    """The entries of a log that this program reads, by name.

    Raises
    ------
    InputError
        Where WPILib's reader is not installed, it is no data log, or a record does not fit its type.
    """
    need("WPILOG", "wpiutil", "frc")
    from wpiutil.log import DataLogReader

    data = read_bytes(path)
    if not data.startswith(_MAGIC):
        raise InputError(
            "", "is no WPILib data log (it does not start with WPILOG)", "give a .wpilog", str(path)
        )
    log = DataLogReader(buffer=data)
    if not log.isValid():
        raise InputError("", "its header is damaged", "give the log as the robot wrote it", str(path))
    kinds: dict[int, tuple[str, str]] = {}
    rows: dict[str, list[tuple[float, tuple[float, ...]]]] = {}
    types: dict[str, str] = {}
    for number, record in enumerate(_records(log, path)):
        if record.isStart():
            try:
                start = record.getStartData()
                kinds[start.entry] = (start.name, start.type)
            except (TypeError, ValueError) as fault:
                raise _damaged(path, number, fault) from None
            continue
        entry, kind = kinds.get(record.getEntry(), ("", ""))
        if record.isControl() or kind not in _TYPES:
            continue
        if types.setdefault(entry, kind) != kind:
            raise InputError(
                entry, f"is first {types[entry]}, then {kind}", "give each its own name", str(path)
            )
        try:
            values = _TYPES[kind][1](record.getRaw())
        except struct.error as fault:
            raise _damaged(path, number, fault) from None
        rows.setdefault(entry, []).append((1e-6 * record.getTimestamp(), values))
    return {name: _channel(_TYPES[types[name]][0], found) for name, found in rows.items()}


def _records(log: Any, path: Path) -> Iterator[Any]:
    """The records, one after the other: each is gone when the next one is read."""
    try:
        yield from log
    except (TypeError, ValueError, RuntimeError, IndexError) as fault:
        raise _damaged(path, 0, fault) from None


def _damaged(path: Path, number: int, fault: Exception) -> InputError:
    return InputError(
        f"record {number + 1}",
        f"is damaged ({type(fault).__name__})",
        "give the log as the robot wrote it",
        str(path),
    )


def _channel(kind: Kind, found: list[tuple[float, tuple[float, ...]]]) -> Channel:
    """Records of an entry; an array that is not as long as most holds no numbers."""
    width = mode(len(row) for _, row in found)
    values: Array = np.array([row if len(row) == width else (np.nan,) * width for _, row in found])
    values = np.where(np.abs(values) < 1e12, values, np.nan)
    return Channel(kind=kind, t_s=np.array([t for t, _ in found]), values=values)
