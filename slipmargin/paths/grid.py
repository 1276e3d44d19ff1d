"""Where along the path the limits are imposed: dense where the path bends or the robot is slow."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.errors import InputError
from slipmargin.paths.path import Path, piece_at
from slipmargin.work import PATH_POINTS, allow

#: Fewest intervals of a grid.
LEAST_POINTS = 10
#: Largest departure of q', q'' and the body axes from straight lines between grid points [1].
BENDING = 2e-4
#: Times the first and last interval are halved: the drag changes fast while the robot is slow.
HALVINGS = 5


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grid:
    """Grid points ``s`` (n + 1,) [m] and the piece (n,) that each interval lies in."""

    s: Array
    piece: NDArray[np.int64]

    @property
    def step(self) -> Array:
        """(n,) lengths of the intervals [m]."""
        return np.diff(self.s)

    def inside(self, fractions: Array) -> tuple[Array, NDArray[np.int64]]:
        """s and piece, each (n, F), at fractions of every interval."""
        s = self.s[:-1, None] + self.step[:, None] * fractions
        s = np.minimum(s, self.s[1:, None])
        return s, np.broadcast_to(self.piece[:, None], s.shape)


def check_points(points: int) -> None:
    """Refuse a number of grid points that is too small or too large.

    Raises
    ------
    InputError
        Placed at ``points``.
    """
    if points < LEAST_POINTS:
        raise InputError("points", f"is {points}", f"use at least {LEAST_POINTS} grid points")
    allow("points", points, PATH_POINTS, "grid points", "ask for fewer")


def grid_of(path: Path, points: int = 400) -> Grid:
    """A grid of at least ``points`` intervals, finer where the path bends.

    Every interval is halved until q', q'' and the turn of the body frame leave their chord by less
    than :data:`BENDING` of their size; breaks and knots are grid points.

    Raises
    ------
    InputError
        If fewer than 10 intervals are asked for, or the path bends so often that it takes too many.
    """
    check_points(points)
    breaks = path.breaks
    marks = [breaks] + [breaks[k] + p.knots for k, p in enumerate(path.pieces)]
    nodes = np.unique(np.concatenate(marks))
    nodes = nodes[np.concatenate([[True], np.diff(nodes) > 1e-12 * path.length])]
    nodes[-1] = breaks[-1]
    s = np.concatenate(
        [_even(a, b, max(2, int(np.ceil(points * (b - a) / path.length)))) for a, b in pairwise(nodes)]
        + [nodes[-1:]]
    )
    for _ in range(12):
        bend = _bending(path, s)
        split = bend > BENDING
        if not np.any(split):
            break
        s = np.sort(np.concatenate([s, 0.5 * (s[:-1] + s[1:])[split]]))
        allow("path", len(s), PATH_POINTS, "grid points", "plan it in parts, or turn the robot less on it")
    ends = 0.5 ** np.arange(1, HALVINGS + 1)
    s = np.sort(np.concatenate([s, s[0] + (s[1] - s[0]) * ends, s[-1] - (s[-1] - s[-2]) * ends]))
    return Grid(s=s, piece=piece_at(breaks, 0.5 * (s[:-1] + s[1:])))


def _even(a: float, b: float, count: int) -> Array:
    return np.linspace(a, b, count, endpoint=False)


def _bending(path: Path, s: Array) -> Array:
    middle = 0.5 * (s[:-1] + s[1:])
    piece = piece_at(path.breaks, middle)
    left, mid, right = (path.at(x, piece) for x in (s[:-1], middle, s[1:]))
    out = (mid[1][:, 2] * np.diff(s)) ** 2 / 8.0
    for order in (1, 2):
        off = np.linalg.norm(mid[order] - 0.5 * (left[order] + right[order]), axis=1)
        size = np.linalg.norm(mid[order], axis=1)
        out = np.maximum(out, off / np.maximum(size, 0.1 * float(np.max(size)) or 1.0))
    return np.asarray(out)
