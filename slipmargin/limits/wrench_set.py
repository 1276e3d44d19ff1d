"""The wrenches the wheels can put on the body without slipping: facets, supports, per wheel and load.

For the box grip it is a zonotope whose normals depend on the geometry only, so every offset is linear
in the loads and in the coefficients: h = share @ N.  A coupled grip has the same closed-form support
(a sum of the wheels' supports) but no facets: its rows here are true half-spaces, not all of them, and its
body is the hull of points of its surface.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, read_only
from slipmargin.limits.bias import loads_at_rest, refuse_lifting
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.model import Model
from slipmargin.physics.grips import (
    GripShape,
    box_point,
    box_slope,
    box_support,
    disc_strip_point,
    disc_strip_slope,
    disc_strip_support,
    ellipse_point,
    ellipse_slope,
    ellipse_support,
    polyhedral,
)
from slipmargin.physics.kinematics import KEPT
from slipmargin.sets.facets import facet_normals
from slipmargin.sets.hull import Hull, all_round
from slipmargin.sets.zonotope import Zonotope


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WrenchSet:
    """Friction wrenches (Fx, Fy, Mz) about the centre of mass, body frame [N, N, N m].

    Parameters
    ----------
    names : tuple of N str
    maps : (3, N, 2)
        ``maps[:, i, 0]`` wrench of a unit force of wheel i along ĝ_i, ``[:, i, 1]`` along f̂_i.
    coefficients : (N, 2, 2)
        ``[i, j, s]``: component j, limit along − (s = 0) and along + (s = 1).
    load_N : (N,)
    shape, coupling
        The grip: (1 − coupling)·box ⊕ coupling·shape.
    normals : (K, 3)
        Outward normals of all facets of the box set [1, 1, 1/m].
    """

    names: tuple[str, ...]
    maps: Array
    coefficients: Array
    load_N: Array
    shape: GripShape
    coupling: float
    normals: Array

    def __post_init__(self) -> None:
        n, put = len(self.names), object.__setattr__
        put(self, "maps", frozen("maps", self.maps, (3, n, 2)))
        put(self, "coefficients", frozen("coefficients", self.coefficients, (n, 2, 2)))
        put(self, "load_N", frozen("load_N", self.load_N, (n,)))
        put(self, "normals", frozen("normals", self.normals, (None, 3)))

    @property
    def polyhedral(self) -> bool:
        """Whether the facets describe the set exactly (box grip)."""
        return polyhedral(self.shape, self.coupling)

    def share(self, directions: Array) -> Array:
        """(..., N) support per unit load of each wheel: h(n) = share(n) @ N [N per N]."""
        return wheel_share(
            self.maps, self.coefficients, np.asarray(directions, dtype=float), self.shape, self.coupling
        )

    def support(self, directions: Array) -> Array:
        """(...,) h(n) = max n·w over the set, closed form for every grip."""
        return np.asarray(self.share(directions) @ self.load_N)

    @property
    def offsets(self) -> Array:
        """(K,) offset of each facet: n_k·w ≤ h_k."""
        return self.support(self.normals)

    @property
    def generators(self) -> Array:
        """(3, 2N) generators of the box set: drive and transverse force of wheel 1, of wheel 2, …"""
        half = 0.5 * self.coefficients.sum(axis=2) * self.load_N[:, None]
        return np.asarray((self.maps * half).reshape(3, -1))

    @property
    def centre(self) -> Array:
        """(3,) centre of the box set; zero unless friction depends on the sense of the slip."""
        middle = 0.5 * (self.coefficients[..., 1] - self.coefficients[..., 0]) * self.load_N[:, None]
        return np.asarray(np.einsum("aij,ij->a", self.maps, middle))

    def points(self, directions: Array) -> Array:
        """(K, 3) wrenches of the set at which its support in directions (K, 3) is attained."""
        seen = np.einsum("ka,aij->kij", directions, self.maps)
        force = box_point(seen, self.coefficients)
        if not self.polyhedral:
            curved = _POINTS[self.shape](seen, self.coefficients)
            force = (1.0 - self.coupling) * force + self.coupling * curved
        return np.asarray(np.einsum("aij,kij,i->ka", self.maps, force, self.load_N))

    def body(self) -> Zonotope | Hull:
        """The set of its own grip: the zonotope of the box, or the hull of points of a curved surface."""
        if self.polyhedral:
            return self.zonotope()
        return Hull(points=self.points(all_round(self.maps.reshape(3, -1))))

    def zonotope(self) -> Zonotope:
        """The box set as a zonotope: vertices, facets, volume."""
        return Zonotope(generators=self.generators, centre=self.centre)


_COUPLED = {GripShape.DISC_STRIP: disc_strip_support, GripShape.ELLIPSE: ellipse_support}
_POINTS = {GripShape.DISC_STRIP: disc_strip_point, GripShape.ELLIPSE: ellipse_point}
_SLOPES = {GripShape.DISC_STRIP: disc_strip_slope, GripShape.ELLIPSE: ellipse_slope}


def wheel_share(maps: Array, mu: Array, directions: Array, shape: GripShape, coupling: float) -> Array:
    """Support of each wheel's force set per unit load, in wrench directions n.

    Parameters
    ----------
    maps, mu, directions : (3, N, 2), (..., N, 2, 2), (K, 3)

    Returns
    -------
    (..., K, N)
    """
    seen = np.einsum("...a,aij->...ij", directions, maps)
    if mu.ndim > 3:
        mu = mu[..., None, :, :, :]
    if polyhedral(shape, coupling):
        return box_support(seen, mu)
    coupled = _COUPLED[shape]
    return np.asarray((1.0 - coupling) * box_support(seen, mu) + coupling * coupled(seen, mu))


def wheel_slope(maps: Array, mu: Array, directions: Array, shape: GripShape, coupling: float) -> Array:
    """(M, N, 2) derivative of :func:`wheel_share` by the coefficients, direction m with ``mu[m]``."""
    seen = np.einsum("ma,aij->mij", directions, maps)
    if polyhedral(shape, coupling):
        return box_slope(seen, mu)
    coupled = _SLOPES[shape]
    return np.asarray((1.0 - coupling) * box_slope(seen, mu) + coupling * coupled(seen, mu))


def wrench_maps(model: Model) -> Array:
    """(3, N, 2): B_W and B_T of eqs (14)–(15) side by side per wheel."""
    out = np.empty((3, model.count, 2))
    out[:, :, 0], out[:, :, 1] = model.wrench_maps()
    return out


def box_normals(maps: Array) -> Array:
    """(K, 3) outward normals of every facet, read-only; they depend on geometry alone."""
    return _box_normals(np.asarray(maps, dtype=float).tobytes())


@lru_cache(maxsize=KEPT)
def _box_normals(maps: bytes) -> Array:
    half = facet_normals(np.frombuffer(maps).reshape(3, -1))
    return read_only(np.vstack([half, -half]))


def moved_normals(normals: Array, shift_m: Array) -> Array:
    """(K, 3) normals of the same facets for moments about a point moved by (x, y) ``shift_m`` [m].

    With M = M' + x F_y − y F_x the row n·(F, M) is n'·(F, M'), n' = (n_x − y n_z, n_y + x n_z, n_z).
    """
    out = normals.copy()
    out[:, 0] -= shift_m[1] * normals[:, 2]
    out[:, 1] += shift_m[0] * normals[:, 2]
    return out


def wrench_set(model: Model, rigid: Array | None = None, phi_rad: float = 0.0) -> WrenchSet:
    """The wrench set of a model at rest.

    Parameters
    ----------
    rigid : (N,) bool, optional
        Wheels that stand on rigid material; by default all stand on rollers.
    phi_rad : float
        Heading [rad]; matters where friction depends on it or a force above the floor shifts load.
    """
    state = np.zeros(model.count, dtype=bool) if rigid is None else np.asarray(rigid, dtype=bool)
    maps, load = wrench_maps(model), loads_at_rest(model, np.array([phi_rad]))[0]
    refuse_lifting(model, load, "wrench set", load)
    return WrenchSet(
        names=model.geometry.names,
        maps=maps,
        coefficients=coefficients(model, state, np.array([phi_rad]), Extreme.NEUTRAL)[0],
        load_N=np.maximum(load, 0.0),  # rounding
        shape=model.grip.shape,
        coupling=model.grip.coupling,
        normals=box_normals(maps),
    )
