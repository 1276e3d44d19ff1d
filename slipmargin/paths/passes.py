"""The compiled backward and forward pass over the rows of every interval, and profiles ṡ² to begin from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from slipmargin.checks import Array
from slipmargin.paths import core
from slipmargin.paths.along import Rows
from slipmargin.paths.grid import Grid


def held(x: Array, most: float) -> Array:
    """``most`` from the start of a profile for as long as it stays below it, then 0."""
    return np.logical_and.accumulate(x < most) * most


class Profile(NamedTuple):
    """A pass: x = ṡ² (n + 1,), s̈ (n,), the highest controllable x, and the interval and rows in conflict."""

    status: int
    conflict: tuple[int, int, int]
    x: Array
    u: Array
    highest: Array


def passes(grid: Grid, w: Rows, start: float, end: float) -> Profile:
    """The compiled backward and forward pass over rows; ``start`` and ``end`` are ṡ² there."""
    n = len(grid.step)
    x, u, highest = np.zeros(n + 1), np.zeros(n), np.zeros(n + 1)
    sides = w.a[0], w.b[0], w.c[0], w.a[1], w.b[1], w.c[1]
    status, j, one, two = core.profile(grid.step, *sides, w.cap, start, end, x, u, highest)
    return Profile(status=status, conflict=(j, one, two), x=x, u=u, highest=highest)
