"""Support functions of the three sets a contact's force may lie in, per newton of load.

In the contact's own axes with coefficients μ_1, μ_2 (docs/theory.md, section 2, three grip sets):

  box         |a| ≤ μ_1, |b| ≤ μ_2                h(p, q) = μ_1 |p| + μ_2 |q|
  ellipse     (a/μ_1)² + (b/μ_2)² ≤ 1             h(p, q) = √(μ_1² p² + μ_2² q²)
  disc-strip  a² + b² ≤ μ_1², |b| ≤ μ_2           h(p, q) = μ_1 √(p² + q²)  where that point of the disc
              lies in the strip, μ_1 |q| ≤ μ_2 √(p² + q²), else |p| √(μ_1² − μ_2²) + |q| μ_2

Coefficients may differ by sense; supports of Minkowski sums add (Schneider, *Convex Bodies*, 1.7.5).
Every function takes directions ``seen (..., N, 2)`` and coefficients ``mu (..., N, 2, 2)``, ``[i, j, s]``
with s = 0 limiting the force along −, s = 1 along +, and gives ``(..., N)``.
"""

from __future__ import annotations

from enum import Enum
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.friction_laws import law_share


class GripShape(Enum):
    """The set a wheel's friction force lies in (docs/theory.md, section 2, three grip sets)."""

    BOX = "box"  #: |f_W| ≤ μ_W N and |f_T| ≤ μ_T N, as published in eq. (17)
    DISC_STRIP = "disc-strip"  #: |f| ≤ μ_W N and |f_T| ≤ μ_T N: a free roller on the floor
    ELLIPSE = "ellipse"  #: (f_W/μ_W)² + (f_T/μ_T)² ≤ N²: a wheel that slides as a whole


def polyhedral(shape: GripShape, coupling: float) -> bool:
    """Whether the set (1 − coupling)·box ⊕ coupling·shape is the box itself, so that facets describe it."""
    return shape is GripShape.BOX or coupling == 0.0


def drive_left(shape: GripShape, coupling: float, by_limit: Array, by_radius: Array) -> Array:
    """Share of the drive grip that is left beside a transverse force [1].

    (1 − c) + c·√(1 − t²), with t = f_T/(μ_T N) for the ellipse (``by_limit``) and f_T/(μ_W N) for the disc
    cut by the strip (``by_radius``).  Box and shape are taken to use the same share t of a force across; in
    their Minkowski sum the box might take more of it, and the shape would have more left.
    """
    if polyhedral(shape, coupling):
        return np.ones(np.broadcast_shapes(np.shape(by_limit), np.shape(by_radius)))
    return np.asarray(left_beside(coupling, by_limit if shape is GripShape.ELLIPSE else by_radius))


def left_beside(coupling: float, used: Any) -> Any:
    """:func:`drive_left` beside a transverse force that uses a share t ≥ 0 of what it is compared with."""
    t = np.minimum(used, 1.0)
    return 1.0 - coupling * (1.0 - np.sqrt(1.0 - t * t))


def most_across(shape: GripShape, coupling: float, drive: Array, transverse: Array) -> Array:
    """Largest transverse force per newton of load [1]: μ_T, but of a disc no more than its radius μ_W."""
    if shape is not GripShape.DISC_STRIP:
        return transverse
    return np.asarray(transverse - coupling * np.maximum(transverse - drive, 0.0))


def rise_across(shape: GripShape, drive: Any, transverse: Any, k_s_per_m: Any) -> tuple[Any, Any]:
    """Size [1] and slope [s/m] of the coupled law's transverse force where a wheel slips across only.

    With u_W = 0 the laws of :mod:`~slipmargin.physics.contact` are μ_T σ(k (μ_T/μ_W) u_T) for the ellipse and
    μ_W σ(k u_T), up to μ_T, for the disc cut by the strip.  μ_W is positive.
    """
    if shape is GripShape.ELLIPSE:
        return transverse, k_s_per_m * transverse / np.maximum(drive, 1e-30)
    return drive, k_s_per_m


def across_alone(law: int, coupling: float, slip: Any, box: tuple[Any, Any], coupled: tuple[Any, Any]) -> Any:
    """Transverse force per newton of load [1] of a wheel that slips across only, by ``slip`` [m/s].

    ``box`` holds μ_T and its slope k_T [s/m], ``coupled`` what :func:`rise_across` says; ``coupling`` is 0
    for a box.
    """
    most, steep = box
    alone = most * law_share(law, steep * slip)
    if coupling == 0.0:
        return alone
    size, rises = coupled
    together = np.minimum(most, np.maximum(-most, size * law_share(law, rises * slip)))
    return (1.0 - coupling) * alone + coupling * together


def box_support(seen: Array, mu: Array) -> Array:
    """Support of the box."""
    reach = _reach(seen, mu)
    return np.asarray(reach[..., 0] + reach[..., 1])


def ellipse_support(seen: Array, mu: Array) -> Array:
    """Support of the ellipse (four quarters where coefficients differ by sense)."""
    reach = _reach(seen, mu)
    return np.asarray(np.hypot(reach[..., 0], reach[..., 1]))


def disc_strip_support(seen: Array, mu: Array) -> Array:
    """Support of the disc cut by the strip.

    Where the disc's two radii differ by sense its reach along the second axis is the lesser.
    """
    p, q = np.abs(seen[..., 0]), np.abs(seen[..., 1])
    radius = np.where(seen[..., 0] >= 0.0, mu[..., 0, 1], mu[..., 0, 0])
    strip = np.where(seen[..., 1] >= 0.0, mu[..., 1, 1], mu[..., 1, 0])
    across = np.min(mu[..., 0, :], axis=-1)
    top = np.minimum(strip / np.where(across > 0.0, across, 1.0), 1.0)  # sine of the corner's angle
    size = np.hypot(radius * p, across * q)
    corner = radius * p * np.sqrt(1.0 - top**2) + across * top * q
    return np.asarray(np.where(across * q <= top * size, size, corner))


def box_point(seen: Array, mu: Array) -> Array:
    """(..., 2) force per unit load at which the box's support is attained: a corner."""
    return np.where(seen >= 0.0, mu[..., 1], -mu[..., 0])


def ellipse_point(seen: Array, mu: Array) -> Array:
    """(..., 2) force per unit load at which the ellipse's support is attained."""
    reach = _reach(seen, mu)
    size = np.hypot(reach[..., 0], reach[..., 1])[..., None]
    return np.asarray(box_point(seen, mu) * reach / np.where(size > 0.0, size, 1.0))


def disc_strip_point(seen: Array, mu: Array) -> Array:
    """(..., 2) force per unit load at which the support of the disc cut by the strip is attained."""
    p, q = np.abs(seen[..., 0]), np.abs(seen[..., 1])
    radius, strip = (np.where(seen[..., j] >= 0.0, mu[..., j, 1], mu[..., j, 0]) for j in range(2))
    across = np.min(mu[..., 0, :], axis=-1)
    top = np.minimum(strip / np.where(across > 0.0, across, 1.0), 1.0)
    size = np.hypot(radius * p, across * q)
    free, safe = across * q <= top * size, np.where(size > 0.0, size, 1.0)
    first = radius * np.where(free, radius * p / safe, np.sqrt(1.0 - top**2))
    second = across * np.where(free, across * q / safe, top)
    return np.stack([np.copysign(first, seen[..., 0]), np.copysign(second, seen[..., 1])], axis=-1)


def box_slope(seen: Array, mu: Array) -> Array:
    """(..., N, 2) derivative of :func:`box_support` by each coefficient of the sense in use."""
    return np.abs(seen)


def ellipse_slope(seen: Array, mu: Array) -> Array:
    """(..., N, 2) derivative of :func:`ellipse_support` by each coefficient of the sense in use."""
    reach = _reach(seen, mu)
    size = np.hypot(reach[..., 0], reach[..., 1])[..., None]
    return np.asarray(np.abs(seen) * reach / np.where(size > 0.0, size, 1.0))


def disc_strip_slope(seen: Array, mu: Array) -> Array:
    """(..., N, 2) derivative of :func:`disc_strip_support`; coefficients alike in both senses."""
    p, q = np.abs(seen[..., 0]), np.abs(seen[..., 1])
    radius, strip = mu[..., 0, 1], mu[..., 1, 1]
    size = np.hypot(p, q)
    edge = np.sqrt(np.maximum(radius**2 - strip**2, 0.0))
    safe = np.where(edge > 0.0, edge, 1.0)
    free = radius * q <= strip * size
    first = np.where(free, size, p * radius / safe)
    return np.stack([first, np.where(free, 0.0, q - p * strip / safe)], axis=-1)


def _reach(seen: Array, mu: Array) -> Array:
    return np.asarray(np.maximum(seen, 0.0) * mu[..., 1] + np.maximum(-seen, 0.0) * mu[..., 0])
