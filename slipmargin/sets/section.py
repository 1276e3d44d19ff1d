"""The plane section of a body in (x, y, z) at z = 0."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.sets.hull import Hull
from slipmargin.sets.zonotope import Zonotope


def section(body: Zonotope | Hull) -> Array:
    """Corners (K, 2) of the section at z = 0, counter-clockwise; of a curved set points all round.

    Of a zonotope dense rays find which facets bound the section; neighbouring facets meet in its corners.
    Of a hull they are where the edges of its triangles cross the plane.
    """
    if isinstance(body, Hull):
        return _crossings(body)
    normals, offsets = body.half_spaces()
    turn = np.linspace(0.0, 2 * np.pi, 7200, endpoint=False)
    rays = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    along = rays @ normals[:, :2].T
    reach = np.where(along > 1e-12, offsets / np.where(along > 1e-12, along, 1.0), np.inf)
    facet = np.argmin(reach, axis=1)
    at = np.flatnonzero(facet != np.roll(facet, -1))
    corners = []
    for k in at:
        pair = [facet[k], facet[(k + 1) % len(facet)]]
        matrix = normals[pair, :2]
        if abs(np.linalg.det(matrix)) > 1e-12:
            corners.append(np.linalg.solve(matrix, offsets[pair]))
    return np.array(corners)


def _crossings(body: Hull) -> Array:
    """Where edges of a hull cross z = 0, each once, by their angle about the middle."""
    points, faces = body.vertices(), body.faces()
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]))
    low = points[:, 2] < 0.0
    edges = np.unique(edges[low[edges[:, 0]] != low[edges[:, 1]]], axis=0)
    start, end = points[edges[:, 0]], points[edges[:, 1]]
    along = start[:, 2] / (start[:, 2] - end[:, 2])
    ring = (start + along[:, None] * (end - start))[:, :2]
    middle = ring - ring.mean(axis=0)
    return np.asarray(ring[np.argsort(np.arctan2(middle[:, 1], middle[:, 0]))])
