"""The plane section of a zonotope in (x, y, z) at z = 0."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.sets.zonotope import Zonotope


def section(zonotope: Zonotope) -> Array:
    """Corners (K, 2) of the section at z = 0, counter-clockwise.

    Dense rays find which facets bound the section; neighbouring facets meet in its corners.
    """
    normals, offsets = zonotope.half_spaces()
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
