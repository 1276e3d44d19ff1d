"""CSV with named columns of numbers: the one form in which all measured and planned motion is kept.

Comma separated, one header line, UTF-8, ``.`` as the decimal mark.  Errors name ``line:column``,
both counted from 1, the column being the cell's number.
"""

from __future__ import annotations

import math
import re
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array, Index, read_only
from slipmargin.errors import InputError
from slipmargin.io.source import lines_of
from slipmargin.io.toml_table import nearest
from slipmargin.work import FACTOR, ROWS, fits

#: Lines that are read at once: a log of any length passes through little memory.
BLOCK = 1 << 16
#: A spreadsheet takes text that begins so for a formula; an apostrophe before it says that it is text.
_FORMULA = ("=", "+", "-", "@")


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Columns:
    """A table of numbers: ``names`` of the columns and ``values`` (rows, columns), NaN where empty.

    ``lines`` (rows,) are the line numbers in the file, for errors that a later check finds.
    """

    names: tuple[str, ...]
    values: Array
    lines: Index = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    def __getitem__(self, name: str) -> Array:
        """The column called ``name``, (rows,)."""
        return np.asarray(self.values[:, self.names.index(name)])

    def stack(self, names: Sequence[str]) -> Array:
        """Several columns side by side, (rows, len(names))."""
        return np.asarray(self.values[:, [self.names.index(name) for name in names]])


def read_columns(
    path: Path | str,
    *,
    required: Sequence[str] = (),
    known: Sequence[str] | None = None,
    empty: Sequence[str] | None = (),
    least: int = 1,
) -> Columns:
    """Read a CSV file strictly.

    Parameters
    ----------
    path : path or str
    required : column names that must be there.
    known : column names that may be there besides the required ones (None: any).
    empty : columns in which a cell may be empty, read as NaN (None: all).
    least : the fewest rows that make sense.

    Raises
    ------
    InputError
        With the file, the column or ``line:column``, what is wrong and what to do.
    """
    try:
        return _columns(lines_of(Path(path)), required, known, empty, least)
    except InputError as fault:
        raise fault.in_file(fault.source or str(path)) from None


def columns_from_text(
    text: str,
    *,
    required: Sequence[str] = (),
    known: Sequence[str] | None = None,
    empty: Sequence[str] | None = (),
    least: int = 1,
) -> Columns:
    """As :func:`read_columns`, from the text itself."""
    lines = (found[0].rstrip("\r\n") for found in re.finditer(r"[^\r\n]*(?:\r\n?|\n)|[^\r\n]+", text))
    return _columns(lines, required, known, empty, least)


def _columns(
    lines: Iterator[str],
    required: Sequence[str],
    known: Sequence[str] | None,
    empty: Sequence[str] | None,
    least: int,
) -> Columns:
    names = _header(next(lines, ""), required, known)
    blocks: deque[Array] = deque()
    numbers, last = [np.zeros(0, dtype=np.int64)], 1
    while block := list(islice(lines, BLOCK)):
        full = [(number, row) for number, row in enumerate(block, last + 1) if row.strip()]
        last += len(block)
        if not fits(last, ROWS):
            raise InputError(
                f"{last + 1}:1",
                f"there are more than {ROWS} rows",
                f"cut the file into shorter ones, thin it, or set {FACTOR}=10 to read ten times as many",
            )
        values = _quick([row for _, row in full], len(names))
        if values is None:
            values = np.array([_numbers(number, row, names, empty) for number, row in full], dtype=float)
        blocks.append(values.reshape(len(full), len(names)))
        numbers.append(np.array([number for number, _ in full], dtype=np.int64))
    count = sum(map(len, blocks))
    if count < least:
        raise InputError(
            f"{last + 1}:1", f"there are {count} rows of numbers", f"give a header and at least {least}"
        )
    table, at = np.empty((count, len(names))), 0
    while blocks:  # each block is freed once it is copied
        values = blocks.popleft()
        table[at : at + len(values)] = values
        at += len(values)
    return Columns(names=names, values=read_only(table), lines=np.concatenate(numbers))


def _quick(rows: list[str], columns: int) -> Array | None:
    """The numbers of rows that are all whole and finite; None where a row must be looked at on its own."""
    if not rows or any("x" in row or "X" in row for row in rows):  # hexadecimal numbers are none of ours
        return None
    try:
        values = np.loadtxt(rows, delimiter=",", ndmin=2, comments=None)
    except ValueError:
        return None
    return values if values.shape[1] == columns and np.all(np.isfinite(values)) else None


#: What else separates columns, and its name.
OTHER_MARKS = {";": "semicolons", "\t": "tabs"}


def header_names(line: str) -> tuple[str, ...]:
    """The names in a header, without blanks and quotes."""
    return tuple(cell.strip().strip('"') for cell in line.split(","))


def _header(line: str, required: Sequence[str], known: Sequence[str] | None) -> tuple[str, ...]:
    names = header_names(line)
    if not any(names):
        raise InputError("1:1", "there is no header", f"begin with {','.join(required) or 'column names'}")
    for mark, called in OTHER_MARKS.items():
        if mark in line and len(names) == 1:
            cure = "separate them by commas, and write numbers with points"
            raise InputError("1:1", f"the columns are separated by {called}", cure)
    for place, name in enumerate(names, 1):
        if not name:
            raise InputError(f"1:{place}", "this column has no name", "name it or remove it")
        if names.index(name) < place - 1:
            raise InputError(f"1:{place}", f"the column {name!r} is given twice", "remove one of them")
    missing = [name for name in required if name not in names]
    if missing:
        exists, lack = ", ".join(names), ", ".join(map(repr, missing))
        one = len(missing) == 1
        raise InputError(
            "1:1",
            f"the column {lack} is missing" if one else f"the columns {lack} are missing",
            f"add {'it' if one else 'them'} (the file has: {exists[:200]})",
        )
    if known is not None:
        allowed = [*required, *known]
        for place, name in enumerate(names, 1):
            if name not in allowed:
                guess = nearest(name, allowed)
                raise InputError(
                    f"1:{place}",
                    f"{name!r} is not a known column",
                    f"did you mean {guess!r}?"
                    if guess and guess not in names
                    else f"rename or remove it (known: {', '.join(allowed)})",
                )
    return names


def _numbers(number: int, row: str, names: tuple[str, ...], empty: Sequence[str] | None) -> list[float]:
    cells = row.split(",")
    if len(cells) != len(names):
        raise InputError(
            f"{number}:{min(len(cells), len(names)) + 1}",
            f"the row has {len(cells)} cells, the header {len(names)}",
            "give every row one cell a column",
        )
    try:
        values = [_plain(cell) for cell in cells]  # the common case, at full speed
    except ValueError:
        values = [
            _number(number, place, cell, name, empty)
            for place, (cell, name) in enumerate(zip(cells, names, strict=True), 1)
        ]
    if not all(map(math.isfinite, values)):
        for place, (cell, name) in enumerate(zip(cells, names, strict=True), 1):
            _number(number, place, cell, name, empty)
    return values


def _plain(cell: str) -> float:
    """A cell as a number: without the underscores that Python reads between digits."""
    if "_" in cell:
        raise ValueError(cell)
    return float(cell)


def _number(line: int, place: int, cell: str, name: str, empty: Sequence[str] | None) -> float:
    at, text = f"{line}:{place}", cell.strip()
    if not text:
        if empty is None or name in empty:
            return math.nan
        raise InputError(at, f"{name} is empty", "give a number")
    try:
        value = _plain(text)
    except ValueError:
        raise InputError(at, f"{name} is {text[:40]!r}, not a number", "give a number") from None
    if not math.isfinite(value):
        cure = (
            "leave the cell empty where a sample is missing"
            if empty is None or name in empty
            else ("give a finite number")
        )
        raise InputError(at, f"{name} is {text[:40]!r}", cure)
    return value


def columns_text(columns: Mapping[str, Array | Sequence[float] | Sequence[str]], digits: int = 9) -> str:
    """CSV text of named columns of one length.

    Numbers keep ``digits`` significant digits, a number that is not finite becomes an empty cell; strings are
    quoted where they hold a comma, a quote or a line break.
    """
    return "".join(columns_parts(columns, digits))


def columns_parts(
    columns: Mapping[str, Array | Sequence[float] | Sequence[str]], digits: int = 9
) -> Iterator[str]:
    """:func:`columns_text` in parts of :data:`BLOCK` rows, for tables of any length."""
    yield ",".join(columns) + "\n"
    count = max((len(column) for column in columns.values()), default=0)
    for first in range(0, count, BLOCK):
        cells = [[_cell(v, digits) for v in column[first : first + BLOCK]] for column in columns.values()]
        yield "".join(",".join(row) + "\n" for row in zip(*cells, strict=True))


def _cell(value: object, digits: int) -> str:
    if isinstance(value, str):
        value = f"'{value}" if value.startswith(_FORMULA) else value
        return '"' + value.replace('"', '""') + '"' if any(c in value for c in ',"\r\n') else value
    number = float(value)  # type: ignore[arg-type]
    if not math.isfinite(number):
        return ""
    return f"{number + 0.0:.{digits}g}"
