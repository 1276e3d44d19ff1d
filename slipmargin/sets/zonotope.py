"""A zonotope: the image of a box.  Knows no robot.

Z = c + {Σ_k a_k g_k : |a_k| ≤ 1}.  Its support in closed form is the whole interface; facets,
vertices, volume, witnesses and ray exits follow from it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import combinations
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, frozen, read_only
from slipmargin.errors import NoSolution
from slipmargin.sets.facets import (
    IN_PLANE,
    PARALLEL,
    cross_products,
    facet_normals,
    length_scale,
    ray_exit,
)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Zonotope:
    """A zonotope in three dimensions.

    Parameters
    ----------
    generators : (3, n)
        Columns; zero columns and parallel columns are allowed.
    centre : (3,)
        Defaults to the origin.
    """

    generators: Array
    centre: Array = field(default_factory=lambda: np.zeros(3))
    normals: Array = field(init=False)  #: (K, 3) one of each pair of opposite facets
    per_generator: Array = field(init=False)  #: (K, n) |n_k·g_j|: offsets are its row sums

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "generators", frozen("generators", self.generators, (3, None)))
        put(self, "centre", frozen("centre", self.centre, (3,)))
        there = np.any(self.generators != 0.0, axis=0)
        put(self, "normals", facet_normals(self.generators[:, there]))
        put(self, "per_generator", read_only(np.abs(self.normals @ self.generators)))

    @property
    def offsets(self) -> Array:
        """(K,) support of each pair of facets about the centre: |n_k·(w − c)| ≤ h_k."""
        return np.asarray(self.per_generator.sum(axis=1))

    def support(self, direction: Array) -> Array:
        """h(n) = n·c + Σ_k |n·g_k| for directions ``(..., 3)``."""
        direction = np.asarray(direction, dtype=float)
        return np.asarray(direction @ self.centre + np.abs(direction @ self.generators).sum(axis=-1))

    def half_spaces(self) -> tuple[Array, Array]:
        """All facets: normals (2K, 3) and offsets (2K,) with n·w ≤ offset."""
        shift = self.normals @ self.centre
        both = np.vstack([self.normals, -self.normals])
        return both, np.concatenate([self.offsets + shift, self.offsets - shift])

    def slack(self, point: Array) -> Array:
        """(..., 2K) offset − n·w of every facet: all ≥ 0 inside."""
        normal, offset = self.half_spaces()
        return np.asarray(offset - np.asarray(point, dtype=float) @ normal.T)

    def exit(self, rays: Array, origin: Array | None = None) -> Array:
        """How far rays go before they leave the set.

        Parameters
        ----------
        rays : (M, 3)
        origin : (3,), optional
            A point inside; the centre by default.

        Returns
        -------
        (M,) multiples of each ray.

        Raises
        ------
        NoSolution
            If the origin lies outside.
        """
        rays = np.atleast_2d(np.asarray(rays, dtype=float))
        if origin is None:
            return ray_exit(self.normals, self.offsets, rays)
        return exit_from(*self.half_spaces(), np.asarray(origin, dtype=float), rays)

    def volume(self) -> float:
        """8 Σ |det(g_i, g_j, g_k)| over the triples of generators (McMullen)."""
        triples = np.array(list(combinations(range(self.generators.shape[1]), 3)))
        return float(8.0 * np.abs(np.linalg.det(self.generators.T[triples])).sum())

    def vertices(self) -> Array:
        """(V, 3) every vertex once, exact: each is one choice of signs of the merged generators.

        A facet's face is the zonogon of the generators in its plane; its corners fix their signs
        by the edges' normals, all others by the facet's normal.
        """
        merged = _merge_parallel(self.generators)
        size = np.array([1.0, 1.0, length_scale(merged)])
        unit = _unit(merged / size[:, None])
        normal = _unit((self.normals * size).T).T
        across = normal @ unit
        inside = np.abs(across) < IN_PLANE
        facet, edge = np.nonzero(inside)
        rows = np.arange(len(facet))
        sideways = cross_products(normal[facet], unit.T[edge]) @ unit
        base = np.where(across >= 0.0, 1, -1)[facet]
        ahead = np.where(sideways >= 0.0, 1, -1)
        signs = []
        for turn in (1, -1):
            for end in (1, -1):
                corner = np.where(inside[facet], turn * ahead, base)
                corner[rows, edge] = end
                signs.append(corner)
        stacked = np.concatenate(signs)
        chosen = _unique_signs(np.concatenate([stacked, -stacked]))
        return np.asarray(self.centre + chosen @ merged.T)


def exit_from(normals: Array, offsets: Array, origin: Array, rays: Array) -> Array:
    """Ray exits (M,) from an origin inside {w : n_k·w ≤ h_k}; ``origin`` (3,) or (M, 3)."""
    room = offsets - origin @ normals.T
    scale = np.max(np.abs(offsets))
    if np.min(room) < -1e-12 * scale:
        raise NoSolution("ray exit", "its origin lies outside the set", "start from a point inside")
    along = rays @ normals.T
    limit = np.full(np.broadcast_shapes(along.shape, room.shape), np.inf)
    tiny = 1e-14 * np.max(np.abs(along), axis=-1, keepdims=True)
    np.divide(np.maximum(room, 0.0), along, out=limit, where=along > tiny)
    return np.asarray(np.min(limit, axis=-1))


def _unit(columns: Array) -> Array:
    # Of length one, whatever their size: squares of forces of 1e±300 N are no numbers.
    even = columns / np.max(np.abs(columns), axis=0)
    return np.asarray(even / np.sqrt(np.sum(even**2, axis=0)))


def _merge_parallel(generators: Array) -> Array:
    # One generator a direction: parallel ones add, with the sign that makes them point the same way.
    there = generators[:, np.any(generators != 0.0, axis=0)]
    scaled = there / np.array([[1.0], [1.0], [length_scale(there)]])
    unit = _unit(scaled)
    sine = np.linalg.norm(cross_products(unit.T[:, None], unit.T[None]), axis=-1)
    columns, left = [], np.ones(there.shape[1], dtype=bool)
    if np.count_nonzero(sine <= PARALLEL) == len(sine):  # only the diagonal
        return np.asarray(there)
    for k in range(there.shape[1]):
        if left[k]:
            alike = left & (sine[k] <= PARALLEL)
            alike[k] = True
            left &= ~alike
            columns.append(there[:, alike] @ np.where(unit.T[alike] @ unit[:, k] >= 0.0, 1.0, -1.0))
    return np.stack(columns, axis=1)


def _unique_signs(signs: NDArray[np.int_]) -> NDArray[np.int_]:
    # Rows of ±1 as 64-bit words: sorting whole numbers is far faster than sorting rows.
    packed = np.packbits(signs > 0, axis=1)
    wide = np.zeros((len(packed), -(-packed.shape[1] // 8) * 8), dtype=np.uint8)
    wide[:, : packed.shape[1]] = packed
    words = wide.view(np.uint64)
    if words.shape[1] == 1:
        first = np.unique(words[:, 0], return_index=True)[1]
    else:
        first = np.unique(words, axis=0, return_index=True)[1]
    return np.asarray(signs[first])
