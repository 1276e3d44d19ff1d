"""A foreign table of numbers, read forgivingly: keep every good row, name every other one."""

from __future__ import annotations

import math
import re
from array import array
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.errors import InputError
from slipmargin.io.importers.plug import Dropped
from slipmargin.io.source import lines_of
from slipmargin.io.table import BLOCK

_SEPARATORS = (";", ",", "\t", "|")
_HEADER_WITHIN = 12  #: lines in which the names of the columns must stand


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LooseTable:
    """Good rows of a table: ``values`` (rows, columns), NaN where a cell is empty, and their ``lines``.

    ``units`` are the words of the line above or below the names, empty where there is none.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    lines: Index
    rows: int
    dropped: tuple[Dropped, ...]
    notes: tuple[str, ...]

    def __getitem__(self, name: str) -> Array:
        """One column (rows,)."""
        return np.asarray(self.values[:, self.names.index(name)])

    def unit(self, name: str) -> str:
        """The unit word of a column, empty where the file names none."""
        return self.units[self.names.index(name)] if self.units else ""


def read_loose(
    path: Path, needed: Sequence[str], separator: str, *, others: bool = False, unit_line: bool = False
) -> LooseTable:
    """Read a delimited file.

    Parameters
    ----------
    path : path
    needed : column names that must be there; the first is the time, which must increase.
    separator : what should stand between cells; another one is recognised and noted.
    others : whether the other columns are read too; else they may hold anything.
    unit_line : whether the line above the names holds units.

    Raises
    ------
    InputError
        Where no line names the needed columns, or no row can be used.
    """
    every = lines_of(path, strict=False)
    top = list(islice(every, BLOCK))  # the header stands here, and what rows end in shows
    numbered = _numbered(top, needed, separator)
    if numbered is not None:
        at, (names, mark) = -1, numbered
    else:
        at, mark = _header(top or [""], needed, separator)
        names = tuple(_cells(top[at], mark))
    notes = [] if mark == separator else [f"cells are separated by {mark!r} instead of {separator!r}"]
    units = tuple(_cells(top[at - 1], mark)) if unit_line and at > 0 else ()
    units = units if len(units) == len(names) else ()
    taken = names if others else tuple(name for name in names if name in needed)
    units = tuple(units[names.index(name)] for name in taken) if units else ()
    rows = _Rows(names=names, taken=taken, mark=mark, time=needed[0])
    rows.read(top, every, at + 1)
    notes += rows.notes()
    if not rows.lines:
        raise InputError(
            f"{at + 2}:1",
            "there is no row that can be read" + rows.first_reason(),
            "give the log as it was written",
        )
    values, lines = rows.table(), np.array(rows.lines)
    keep, order_note = increasing(values[:, taken.index(needed[0])])
    notes += order_note
    dropped = list(rows.dropped)
    whole = len(keep) == len(values) and keep[0] == 0
    gone = keep[:0] if whole else np.setdiff1d(np.arange(len(values)), keep)
    why = "its time does not come after the row before"
    dropped += left_out(gone, why, lines)
    return LooseTable(
        names=taken,
        units=units,
        values=values if whole else values[keep],
        lines=lines if whole else lines[keep],
        rows=rows.seen,
        dropped=tuple(sorted(dropped, key=lambda d: d.line)),
        notes=tuple(notes),
    )


def increasing(t: Array) -> tuple[Index, list[str]]:
    """Indices of the longest strictly increasing selection of times, so one bad stamp costs one row.

    Rows that stand in reverse order as a whole are turned round (and that is noted).
    """
    step = np.diff(t)
    if len(step) > 2 and np.count_nonzero(step < 0) > 0.9 * len(step):
        keep, _ = increasing(t[::-1])
        return len(t) - 1 - keep, ["the rows stand in reverse order of time; turned round"]
    if np.all(step > 0.0) and np.all(np.isfinite(t)):  # as it should be
        return np.arange(len(t), dtype=np.int64), []
    tails, ends, before = array("d"), array("q"), array("q")  # lists take three times the memory
    for first in range(0, len(t), BLOCK):
        for i, value in enumerate(t[first : first + BLOCK].tolist(), first):
            before.append(-1)
            if not math.isfinite(value):
                continue
            k = len(tails) if not tails or value > tails[-1] else bisect_left(tails, value)
            if k:
                before[i] = ends[k - 1]
            if k == len(tails):
                tails.append(value)
                ends.append(i)
            else:
                tails[k], ends[k] = value, i
    chain, at = array("q"), ends[-1] if ends else -1
    while at >= 0:
        chain.append(at)
        at = before[at]
    return np.array(chain[::-1], dtype=np.int64), []


def left_out(index: Index, why: str, lines: Index | None = None) -> list[Dropped]:
    """Entries of the rows with these increasing indices; ``lines`` are the file's, else rows are counted."""
    parts = [part for part in np.split(index, np.flatnonzero(np.diff(index) > 1) + 1) if len(part)]
    return [
        Dropped(line=int(i[0]) + 1 if lines is None else int(lines[i[0]]), count=len(i), why=why)
        for i in parts
    ]


def _numbered(
    lines: Sequence[str], needed: Sequence[str], separator: str
) -> tuple[tuple[str, ...], str] | None:
    """Names ``#1``, ``#2`` … of the columns of a file without a header, where they are asked for, and
    separator."""
    if not all(re.fullmatch(r"#[1-9]\d*", name) for name in needed):
        return None
    first = next((line for line in lines if line.strip()), "")
    mark = max((separator, *_SEPARATORS), key=lambda m: len(_cells(first, m)))
    count = len(_cells(first, mark))
    missing = [name for name in needed if int(name[1:]) > count]
    if missing:
        raise InputError("1:1", f"has {count} columns, so there is no {missing[0]}", "count from #1")
    return tuple(f"#{k + 1}" for k in range(count)), mark


def _header(lines: Sequence[str], needed: Sequence[str], separator: str) -> tuple[int, str]:
    """The line that names the columns, and the separator that makes it do so."""
    best: tuple[int, str, list[str]] = (0, separator, list(needed))
    for mark in (separator, *(s for s in _SEPARATORS if s != separator)):
        for at, line in enumerate(lines[:_HEADER_WITHIN]):
            cells = _cells(line, mark)
            missing = [name for name in needed if name not in cells]
            if not missing:
                return at, mark
            if len(missing) < len(best[2]):
                best = (at, mark, missing)
    at, _, missing = best
    if len(missing) == len(needed):
        problem = f"no line names the columns {', '.join(needed[:4])} …"
        cells = _cells(lines[0], max(_SEPARATORS, key=lambda m: len(_cells(lines[0], m))))
        cure = "give the log with its header lines"
        if cells and all(_is_number(cell) for cell in cells):
            problem += f": the first line is {len(cells)} numbers, so there is no header"
            cure = "write the names as first line, or name columns by number: #1 is the first"
        raise InputError("1:1", problem, cure)
    raise InputError(
        f"{at + 1}:1", f"the column {missing[0]!r} is missing", "give the log with all its columns"
    )


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _cells(line: str, mark: str) -> list[str]:
    cells = [cell.strip().strip('"') for cell in line.split(mark)]
    while cells and not cells[-1]:
        cells.pop()
    return cells


class _Rows:
    """The rows of one file as they are sorted into good and dropped."""

    def __init__(self, *, names: tuple[str, ...], taken: tuple[str, ...], mark: str, time: str) -> None:
        self.names, self.taken, self.mark, self.time = names, taken, mark, time
        self.places = [names.index(name) for name in taken]
        self.values, self.lines = array("d"), array("q")
        self.dropped: list[Dropped] = []
        self.seen = 0
        self._other_mark: list[int] = []
        self._comma: list[int] = []

    def read(self, top: Sequence[str], rest: Iterator[str], start: int) -> None:
        """Sort the lines of the file's beginning from ``start``, and those of the ``rest``."""
        block, number = top[start:], start
        full = [line for line in block if line.strip()]
        ended = sum(line.rstrip().endswith(self.mark) for line in full) > 0.5 * len(full)
        while block:
            self._read(block, number + 1, ended)
            number += len(block)
            block = list(islice(rest, BLOCK))

    def _read(self, block: Sequence[str], start: int, ended: bool) -> None:
        values = self._quick(block, ended)
        if values is not None:
            self.seen += len(values)
            self.values.frombytes(values.tobytes())
            self.lines.frombytes(np.arange(start, start + len(values)).tobytes())
            return
        for number, line in enumerate(block, start):
            if not line.strip():
                continue
            self.seen += 1
            row, why = self._row(number, line, ended)
            if row is None:
                self._drop(number, why)
            else:
                self.values.extend(row)
                self.lines.append(number)

    def _quick(self, block: Sequence[str], ended: bool) -> Array | None:
        """The numbers of rows that are all whole and finite; None where each must be looked at on its own."""
        marks = len(self.names) - (0 if ended else 1)
        if any(line.count(self.mark) != marks or "x" in line or "X" in line for line in block):
            return None
        try:
            values = np.loadtxt(
                block, delimiter=self.mark, usecols=self.places, ndmin=2, comments=None, dtype=np.float64
            )
        except ValueError:
            return None
        return values if len(values) == len(block) and np.isfinite(values).all() else None

    def table(self) -> Array:
        """The good rows (rows, columns taken)."""
        return np.frombuffer(self.values).reshape(-1, len(self.taken))

    def _row(self, number: int, line: str, ended: bool) -> tuple[list[float] | None, str]:
        cells, mark = self._split(number, line)
        full = len(self.names)
        if len(cells) > full and not any(c.strip() for c in cells[full:]):
            cells = cells[:full]
        if len(cells) < full:
            return None, f"it is cut ({len(cells)} of {full} cells)"
        if len(cells) > full:
            return None, f"it has {len(cells)} cells instead of {full}"
        if ended and not line.rstrip().endswith(mark):
            return None, "it is cut (the closing separator is missing)"
        cells = [cells[place] for place in self.places]
        try:
            quick = [float(cell) for cell in cells]  # the common case, at full speed
        except ValueError:
            quick = []
        if quick and np.isfinite(sum(quick)):
            return quick, ""
        row: list[float] = []
        for name, cell in zip(self.taken, cells, strict=True):
            value = self._number(number, cell)
            if value is None:
                return None, f"{name} is {cell.strip()[:20]!r}, not a number"
            row.append(value)
        if not np.isfinite(row[self.taken.index(self.time)]):
            return None, f"it has no time ({self.time})"
        return row, ""

    def _split(self, number: int, line: str) -> tuple[list[str], str]:
        cells = line.split(self.mark)
        if len(cells) >= len(self.names):
            return cells, self.mark
        for mark in _SEPARATORS:
            other = line.split(mark)
            if mark != self.mark and len(self.names) <= len(other) <= len(self.names) + 1:
                self._other_mark.append(number)
                return other, mark
        while len(cells) > 1 and not cells[-1].strip():
            cells.pop()
        return cells, self.mark

    def _number(self, number: int, cell: str) -> float | None:
        text = cell.strip()
        if not text or text.lower() in ("nan", "na", "null", "none", "-"):
            return float("nan")
        if "," in text and "." not in text and text.count(",") == 1:
            self._comma.append(number)
            text = text.replace(",", ".")
        try:
            value = float(text)
        except ValueError:
            return None
        return value if np.isfinite(value) else float("nan")

    def _drop(self, line: int, why: str) -> None:
        last = self.dropped[-1] if self.dropped else None
        if last is not None and last.why == why and last.line + last.count == line:
            self.dropped[-1] = Dropped(line=last.line, count=last.count + 1, why=why)
        else:
            self.dropped.append(Dropped(line=line, count=1, why=why))

    def notes(self) -> list[str]:
        out = []
        if self._other_mark:
            out.append(
                f"{_counted(self._other_mark)} separated otherwise than by {self.mark!r}; read all the same"
            )
        if self._comma:
            out.append(f"{_counted(self._comma)} with a decimal comma; read all the same")
        return out

    def first_reason(self) -> str:
        return f" ({self.dropped[0]})" if self.dropped else ""


def _counted(lines: Iterable[int]) -> str:
    unique = sorted(set(lines))
    return f"line {unique[0]}: {len(unique)} row{'s' if len(unique) > 1 else ''}"
