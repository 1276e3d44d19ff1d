"""A convex set by points of its surface: what a set with curved sides is written down as."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen
from slipmargin.sets.facets import length_scale, spanning

#: Digits [1] to which points, and normals, count as one.
_DIGITS = 12
#: Directions all round, and from pole to pole, in which a surface is looked at; the first is a multiple of
#: four, so that a robot turned by a right angle has the same points.
_ROUND, _HIGH = 72, 36


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hull:
    """The convex hull of points (V, 3) that all lie on the surface of a convex set in three dimensions.

    Raises
    ------
    InputError
        If the points lie in a plane.
    """

    points: Array

    def __post_init__(self) -> None:
        points = frozen("points", self.points, (None, 3))
        spanning(points[np.any(points != 0.0, axis=1)].T)
        size = np.max(np.abs(points), axis=0)
        _, first = np.unique(np.round(points / size, _DIGITS), axis=0, return_index=True)
        object.__setattr__(self, "points", frozen("points", points[np.sort(first)], (None, 3)))

    def vertices(self) -> Array:
        """(V, 3) the points, each once."""
        return self.points

    def half_spaces(self) -> tuple[Array, Array]:
        """Normals (F, 3) and offsets (F,) of the hull's facets: n·w ≤ offset inside."""
        size, hull = self._hull()
        rows = np.unique(np.round(hull.equations, _DIGITS), axis=0)
        return np.asarray(rows[:, :3] / size), np.asarray(-rows[:, 3])

    def faces(self) -> NDArray[np.int64]:
        """(F, 3) triangles between points."""
        return np.asarray(self._hull()[1].simplices, dtype=np.int64)

    def volume(self) -> float:
        """Volume of the hull, a little less than that of the set."""
        size, hull = self._hull()
        return float(hull.volume) * float(np.prod(size))

    def _hull(self) -> tuple[Array, Any]:
        from scipy.spatial import ConvexHull

        size = np.max(np.abs(self.points), axis=0)
        return size, ConvexHull(self.points / size)


def all_round(maps: Array) -> Array:
    """(K, 3) directions in which to look at a set of wrenches with generators (3, n), none along an axis."""
    turn = 2.0 * np.pi * (np.arange(_ROUND) + 0.37) / _ROUND
    rise = np.pi * ((np.arange(_HIGH) + 0.5) / _HIGH - 0.5) + 0.011
    flat, high = np.cos(rise)[:, None], np.broadcast_to(np.sin(rise)[:, None], (_HIGH, _ROUND))
    ways = np.stack([flat * np.cos(turn), flat * np.sin(turn), high], axis=2).reshape(-1, 3)
    return np.asarray(ways / np.array([1.0, 1.0, length_scale(maps)]))
