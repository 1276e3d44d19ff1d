"""Small pieces of text that every report uses: aligned columns, angles, units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

_LABELLED = re.compile(r"(\S+) {2,}(.*)")


def columns(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Aligned lines: the first row is the head; every column is as wide as its widest cell."""
    cells = [list(head), *(list(row) for row in rows)]
    wide = [max(len(row[j]) for row in cells) for j in range(len(head))]
    return ["  ".join(cell.rjust(n) for cell, n in zip(row, wide, strict=True)).rstrip() for row in cells]


def degrees(rad: float) -> str:
    """An angle in radians as degrees with four digits: ``15°``."""
    return f"{math.degrees(rad) + 0.0:.4g}°"


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
