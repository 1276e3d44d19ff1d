"""The plane section of a body in (x, y, z) at z = 0."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.sets.hull import Hull
from slipmargin.sets.zonotope import Zonotope


def section(body: Zonotope | Hull) -> Array:
    """Corners (K, 2) of the section at z = 0, counter-clockwise; of a curved set points all round.

    Dense rays find which facets bound the section; neighbouring facets meet in its corners.
    """
    normals, offsets = body.half_spaces()
    turn = np.linspace(0.0, 2 * np.pi, 720 if isinstance(body, Hull) else 7200, endpoint=False)
    rays = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    along = rays @ normals[:, :2].T
    reach = np.where(along > 1e-12, offsets / np.where(along > 1e-12, along, 1.0), np.inf)
    if isinstance(body, Hull):
        return np.asarray(rays * reach.min(axis=1, keepdims=True))
    facet = np.argmin(reach, axis=1)
    at = np.flatnonzero(facet != np.roll(facet, -1))
    corners = []
    for k in at:
        pair = [facet[k], facet[(k + 1) % len(facet)]]
        matrix = normals[pair, :2]
        if abs(np.linalg.det(matrix)) > 1e-12:
            corners.append(np.linalg.solve(matrix, offsets[pair]))
    return np.array(corners)
