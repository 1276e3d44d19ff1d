"""Facet normals of a zonotope from the directions of its generators, and batches of ray exits.

A zonotope Z = c + {Σ_k a_k g_k : |a_k| ≤ 1} in three dimensions has one pair of facets for each plane
that two generators span, with normal n = g_i × g_j and offset h(n) = Σ_k |n·g_k| (its support).
Every row returned is a true supporting half-space whatever the rounding, since its offset is computed
for the very normal returned: merging only removes rows that would repeat one another.

Source: McMullen, "On zonotopes", Trans. AMS 159 (1971) 91–109.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, read_only
from slipmargin.errors import InputError

#: Sine of the angle between two generators below which they count as parallel [1].
PARALLEL = 1e-10
#: Distance between two unit normals below which they count as one [1]; rounding is added to it.
SAME_NORMAL = 1e-9
#: Sine of the angle to a facet's plane below which a generator lies in it [1].
IN_PLANE = 1e-9
#: Least eigenvalue of Σ u uᵀ, u the unit directions, below which they lie in a plane [1].
FLAT = 1e-14
_SUSPECT = 1.0 - 1e-10  # cosine above which two normals are compared with care


def length_scale(vectors: Array) -> float:
    """A length L [m] that makes forces and moments comparable: max |Mz| / max |F| (1 where undefined)."""
    size = np.abs(vectors)
    force, moment = float(size[:2].max()), float(size[2].max())
    return moment / force if force > 0.0 and moment > 0.0 else 1.0


def facet_normals(directions: Array) -> Array:
    """One normal of each pair of opposite facets, independent of the generators' lengths.

    Parameters
    ----------
    directions : (3, n)
        Directions of the generators, no zero column, [1, 1, m] for wrenches.

    Returns
    -------
    (K, 3), read-only
        Normals in [1, 1, 1/m], unit length after moments are divided by :func:`length_scale`.

    Raises
    ------
    InputError
        If the directions do not span all three dimensions.
    """
    unit, scale = spanning(directions)
    first, second = np.triu_indices(unit.shape[1], 1)
    cross = cross_products(unit.T[first], unit.T[second])
    sine = np.sqrt(np.einsum("pi,pi->p", cross, cross))
    order = np.argsort(-sine, kind="stable")
    order = order[sine[order] > PARALLEL]
    normal = cross[order] / sine[order, None]
    kept = normal[_distinct(normal, 1e-15 / sine[order])]
    return read_only(kept / np.array([1.0, 1.0, scale]))


def spanning(directions: Array) -> tuple[Array, float]:
    """Directions (3, n) as unit columns of [1, 1, 1/L], and their length scale L.

    Raises
    ------
    InputError
        If they lie in a plane, or there is none: what they span has no volume.
    """
    if directions.shape[1] > 0:
        scale = length_scale(directions)
        unit = _unit_columns(directions / np.array([[1.0], [1.0], [scale]]))
        if np.linalg.eigvalsh(unit @ unit.T)[0] >= FLAT:
            return unit, scale
    raise no_volume()


def no_volume() -> InputError:
    """Return the refusal of forces that lie in a plane."""
    return InputError(
        "the wheels' forces",
        "do not span forces in two directions and a moment",
        "add a wheel, load or friction, so that the set of wrenches has a volume",
    )


def ray_exit(normals: Array, offsets: Array, rays: Array) -> Array:
    """How far rays from the origin go inside {w : |n_k·w| ≤ h_k}, vectorised.

    F(d) = 1 / max_k |n_k·d| / h_k, the set's gauge inverted.

    Parameters
    ----------
    normals, offsets : (..., K, 3), (..., K)
        Half of the facets (centrally symmetric set).  Rows of zeros are ignored.
    rays : (M, 3)

    Returns
    -------
    (..., M)
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        per_unit = normals / offsets[..., None]
    if not np.all(np.isfinite(per_unit)):
        return _flat_exit(normals, offsets, rays)
    return np.asarray(1.0 / np.max(np.abs(per_unit @ rays.T), axis=-2))


def batch_ray_exit(generators: Array, rays: Array) -> Array:
    """Ray exits of many zonotopes at once: every pair of generators gives a row, nothing is merged.

    Parameters
    ----------
    generators : (D, 3, n)
    rays : (M, 3)

    Returns
    -------
    (D, M)
    """
    first, second = np.triu_indices(generators.shape[2], 1)
    turned = np.swapaxes(generators, 1, 2)
    left, right = turned[:, first], turned[:, second]
    normal = cross_products(left, right)
    size = np.einsum("dpi,dpi->dp", left, left) * np.einsum("dpi,dpi->dp", right, right)
    square = np.einsum("dpi,dpi->dp", normal, normal)
    offset = np.abs(normal @ generators).sum(axis=-1)
    proper = square > PARALLEL**2 * size
    per_unit = np.where(proper[..., None], normal, 0.0) / np.where(proper, offset, 1.0)[..., None]
    across = np.matmul(per_unit, np.ascontiguousarray(rays.T))
    return np.asarray(1.0 / np.max(np.abs(across, out=across), axis=1))


def _flat_exit(normals: Array, offsets: Array, rays: Array) -> Array:
    # A flat set: where h_k = 0 a ray leaves at once unless it lies in the plane.
    across = np.abs(normals @ rays.T)
    height = np.broadcast_to(offsets[..., None], across.shape)
    tiny = 1e-14 * np.sqrt(np.sum(normals**2, axis=-1))[..., None] * np.sqrt(np.sum(rays**2, axis=-1))
    room = np.full(across.shape, np.inf)
    np.divide(height, across, out=room, where=across > tiny)
    return np.asarray(np.min(room, axis=-2))


def cross_products(a: Array, b: Array) -> Array:
    """(..., 3) a × b, row by row."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def _unit_columns(vectors: Array) -> Array:
    size = np.abs(vectors).max(axis=0)  # first by the largest entry: no underflow for tiny columns
    if not size.min() > 0.0:
        raise InputError("generators", "holds a direction of length zero", "leave zero generators out")
    scaled = vectors / size
    return np.asarray(scaled / np.sqrt(np.einsum("in,in->n", scaled, scaled)))


def _distinct(normal: Array, blur: Array) -> NDArray[np.bool_]:
    # Rows are sorted from well- to ill-conditioned; each is dropped if it repeats a kept one, up to sign.
    keep = np.ones(len(normal), dtype=bool)
    gram = normal @ normal.T
    later, earlier = np.nonzero(np.abs(gram) > _SUSPECT)
    if len(later) == len(normal):  # each resembles itself only
        return keep
    later, earlier = later[later > earlier], earlier[later > earlier]
    apart = normal[later] - np.sign(gram[later, earlier])[:, None] * normal[earlier]
    same = np.einsum("pi,pi->p", apart, apart) < (SAME_NORMAL + 4.0 * blur[later]) ** 2
    for i, j in zip(later[same].tolist(), earlier[same].tolist(), strict=True):
        if keep[j]:
            keep[i] = False
    return keep
