"""CSV with named columns of numbers: the one form in which all measured and planned motion is kept.

Comma separated, one header line, UTF-8, ``.`` as the decimal mark.  Errors name ``line:column``,
both counted from 1, the column being the cell's number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import nearest

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
    lines: tuple[int, ...] = ()

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
        return columns_from_text(
            read_text(Path(path)), required=required, known=known, empty=empty, least=least
        )
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
    rows = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    names = _header(rows[0], required, known)
    values, lines = [], []
    for number, row in enumerate(rows[1:], start=2):
        if row.strip():
            values.append(_numbers(number, row, names, empty))
            lines.append(number)
    if len(values) < least:
        raise InputError(
            f"{len(rows)}:1",
            f"there are {len(values)} rows of numbers",
            f"give a header and at least {least}",
        )
    table = np.array(values, dtype=np.float64).reshape(len(values), len(names))
    table.setflags(write=False)
    return Columns(names=names, values=table, lines=tuple(lines))


def _header(line: str, required: Sequence[str], known: Sequence[str] | None) -> tuple[str, ...]:
    names = tuple(cell.strip().strip('"') for cell in line.split(","))
    if not any(names):
        raise InputError("1:1", "there is no header", f"begin with {','.join(required) or 'column names'}")
    for place, name in enumerate(names, 1):
        if not name:
            raise InputError(f"1:{place}", "this column has no name", "name it or remove it")
        if names.index(name) < place - 1:
            raise InputError(f"1:{place}", f"the column {name!r} is given twice", "remove one of them")
    missing = [name for name in required if name not in names]
    if missing:
        exists = ", ".join(names)
        raise InputError(
            "1:1",
            f"the column {', '.join(map(repr, missing))} is missing",
            f"add it (the file has: {exists[:200]})",
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
                    if guess
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
        values = [float(cell) for cell in cells]  # the common case, at full speed
    except ValueError:
        values = [
            _number(number, place, cell, name, empty)
            for place, (cell, name) in enumerate(zip(cells, names, strict=True), 1)
        ]
    if not all(map(math.isfinite, values)):
        for place, (cell, name) in enumerate(zip(cells, names, strict=True), 1):
            _number(number, place, cell, name, empty)
    return values


def _number(line: int, place: int, cell: str, name: str, empty: Sequence[str] | None) -> float:
    at, text = f"{line}:{place}", cell.strip()
    if not text:
        if empty is None or name in empty:
            return math.nan
        raise InputError(at, f"{name} is empty", "give a number")
    try:
        value = float(text)
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
    cells = [[_cell(value, digits) for value in column] for column in columns.values()]
    rows = zip(*cells, strict=True)
    return "\n".join([",".join(columns), *(",".join(row) for row in rows)]) + "\n"


def _cell(value: object, digits: int) -> str:
    if isinstance(value, str):
        value = f"'{value}" if value.startswith(_FORMULA) else value
        return '"' + value.replace('"', '""') + '"' if any(c in value for c in ',"\r\n') else value
    number = float(value)  # type: ignore[arg-type]
    if not math.isfinite(number):
        return ""
    return f"{number + 0.0:.{digits}g}"
