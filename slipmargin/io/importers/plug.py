"""What an importer is: something that reads one log and tells what it left out.

A new format is one class with ``name`` and ``read``; :func:`import_files` and the command line do
the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol, final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.record import Record
from slipmargin.errors import InputError


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Dropped:
    """Rows (or samples) that were left out: where the first stands, how many, and why."""

    line: int
    count: int
    why: str

    def __str__(self) -> str:
        rows = "1 row" if self.count == 1 else f"{self.count} rows"
        return f"line {self.line}: {rows} dropped, {self.why}"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reading:
    """One log, read.

    Parameters
    ----------
    source : str
        The file.
    record : Record
        What could be used.
    rows : int
        Rows of data in the file.
    dropped : tuple of Dropped
        What was left out and why; the other rows are kept.  The record has as many rows as are kept, but
        where a note says that it holds a value from change to change.
    lost_frames : int
        Rows without a new camera frame (kept, with an empty pose).
    notes : tuple of str
        What was put right on the way (a separator, a decimal comma, the order of the rows).
    facts : tuple of (str, float)
        Numbers that the log tells about its own sensors, e.g. ticks per turn by the logged speed.
    """

    source: str
    record: Record
    rows: int
    dropped: tuple[Dropped, ...] = ()
    lost_frames: int = 0
    notes: tuple[str, ...] = ()
    facts: tuple[tuple[str, float], ...] = ()

    @property
    def kept(self) -> int:
        """Rows of the file that were not left out."""
        return self.rows - sum(part.count for part in self.dropped)


class Importer(Protocol):
    """A format: its name and how one log of it is read."""

    @property
    def name(self) -> str:
        """What the format is called in reports."""

    def read(self, path: Path) -> Reading:
        """The log as a record, and what was left out of it."""


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Summary:
    """What an import read, what it dropped and why, over all files.

    ``refused`` holds (file, reason) of logs without a usable row.
    """

    format: str
    readings: tuple[Reading, ...]
    refused: tuple[tuple[str, str], ...] = ()

    @property
    def records(self) -> tuple[Record, ...]:
        """The runs, in the order given."""
        return tuple(r.record for r in self.readings)

    def facts(self) -> dict[str, float]:
        """The median of every fact over the files."""
        found: dict[str, list[float]] = {}
        for reading in self.readings:
            for name, value in reading.facts:
                found.setdefault(name, []).append(value)
        return {name: float(np.median(values)) for name, values in found.items()}

    def noted(self, notes: Sequence[tuple[str, ...]]) -> Summary:
        """The same with more notes of each file."""
        told = (replace(r, notes=(*r.notes, *more)) for r, more in zip(self.readings, notes, strict=True))
        return replace(self, readings=tuple(told))

    def lines(self) -> tuple[str, ...]:
        """The report: totals first, then every file that was not perfect."""
        rows = sum(r.rows for r in self.readings)
        kept = sum(r.kept for r in self.readings)
        lost = sum(r.lost_frames for r in self.readings)
        out = [
            f"read {len(self.readings)} runs ({self.format}): {rows} rows, {kept} kept, "
            f"{rows - kept} dropped, {lost} without a new camera frame"
        ]
        for reading in self.readings:
            out += [f"{reading.source}: {text}" for text in (*reading.notes, *map(str, reading.dropped))]
        out += [f"{source}: not used, {why}" for source, why in self.refused]
        return tuple(out)

    def as_json(self) -> dict[str, object]:
        """The same as data."""
        return {
            "format": self.format,
            "runs": [
                {
                    "source": r.source,
                    "name": r.record.name,
                    "rows": r.rows,
                    "kept": r.kept,
                    "lost_frames": r.lost_frames,
                    "notes": list(r.notes),
                    "dropped": [{"line": d.line, "count": d.count, "why": d.why} for d in r.dropped],
                }
                for r in self.readings
            ],
            "refused": [{"source": s, "why": w} for s, w in self.refused],
            "facts": self.facts(),
        }


def import_files(importer: Importer, files: Sequence[Path]) -> Summary:
    """Read every log; one that holds nothing usable is named, the others are kept.

    The same log twice is used once, whatever its name.  Two logs of one name get their folder's name in
    front, so no trial hides another.

    Raises
    ------
    InputError
        Where no log could be used: the first one's reason.
    """
    if not files:
        raise InputError("FILE", "no log is given", "name one log or more", "command line")
    readings: list[Reading] = []
    refused: list[tuple[str, InputError]] = []
    for path in files:
        try:
            read = importer.read(Path(path))
            twin = next((r for r in readings if same_run(r.record, read.record)), None)
            if twin is not None:
                raise InputError("", f"is the same log as {twin.source}", "give each run once", str(path))
            readings.append(read)
        except InputError as fault:
            refused.append((str(path), fault if fault.source else fault.in_file(str(path))))
    if not readings:
        raise refused[0][1]
    return Summary(
        format=importer.name,
        readings=tuple(_named_apart(readings)),
        refused=tuple((source, str(fault)) for source, fault in refused),
    )


def same_run(one: Record, two: Record) -> bool:
    """Whether two records hold the same numbers."""
    fields = ("t_s", "pose", "theta", "omega", "omega_cmd", "current")
    return all(_same(getattr(one, field), getattr(two, field)) for field in fields)


def _same(one: Array | None, two: Array | None) -> bool:
    if one is None or two is None:
        return one is two
    return one.shape == two.shape and bool(np.array_equal(one, two, equal_nan=True))


def _named_apart(readings: Sequence[Reading]) -> Iterable[Reading]:
    names = [r.record.name for r in readings]
    taken: dict[str, int] = {}
    for reading in readings:
        name = reading.record.name
        if names.count(name) > 1:
            name = f"{Path(reading.source).resolve().parent.name}_{name}"
        taken[name] = taken.get(name, 0) + 1
        if taken[name] > 1:
            name = f"{name}_{taken[name]}"
        yield (
            reading
            if name == reading.record.name
            else replace(reading, record=replace(reading.record, name=name))
        )
