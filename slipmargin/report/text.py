"""Small pieces of text that every report uses: aligned columns, angles, units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

#: Rows of a table in a terminal: the answer above stays in sight.
ROWS = 12
_LABELLED = re.compile(r"(\S+) {2,}(.*)")


def columns(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Aligned lines: the first row is the head; every column is as wide as its widest cell."""
    cells = [list(head), *(list(row) for row in rows)]
    wide = [max(len(row[j]) for row in cells) for j in range(len(head))]
    return ["  ".join(cell.rjust(n) for cell, n in zip(row, wide, strict=True)).rstrip() for row in cells]


def degrees(rad: float) -> str:
    """An angle in radians as degrees with four digits: ``15°``."""
    return f"{math.degrees(rad) + 0.0:.4g}°"


def two_digits(value: float) -> str:
    """A measured spread with two digits, and no power of ten for what is merely above a hundred: ``160``."""
    return f"{value:.0f}" if 10.0 <= abs(value) < 1e6 else f"{value:.2g}"


def labelled(line: str) -> tuple[str, str]:
    """A line ``label   text`` as its label and its text; the label is empty where the line has none."""
    match = _LABELLED.fullmatch(line)
    return (match[1], match[2]) if match else ("", line.strip())


def towards(from_front_rad: float) -> str:
    """A direction, counted counter-clockwise from the front, in words: ``forwards and to the left``."""
    words = (
        "forwards",
        "forwards and to the left",
        "to the left",
        "backwards and to the left",
        "backwards",
        "backwards and to the right",
        "to the right",
        "forwards and to the right",
    )
    return words[round(math.degrees(from_front_rad) / 45.0) % 8]


def thinned(count: int, most: int, always: Sequence[int] = ()) -> list[int]:
    """At most ``most`` of ``count`` rows at a round step, with those that must be there; in order."""
    keep = set(list(always)[:most])
    for step in (*(n * 10**k for k in range(9) for n in (1, 2, 3, 4.5, 5, 6)), count):
        pick = keep | set(range(0, count, round(step)))
        if len(pick) <= most:
            return sorted(pick)
    return sorted(keep)


def left_out(shown: int, count: int) -> list[str]:
    """The line below a table that says how many more rows there are; none where it shows all."""
    return [f"{shown} of {count} rows; --out FILE writes all"] if shown < count else []
