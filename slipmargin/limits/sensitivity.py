"""What limits a pull, and what would raise the limit.

At a normal n, scaled so that −n·d − s·t = 1: F = s(n)·N⁰ + n·w_b, so ∂F/∂μ_ij = N_i(F) ∂s_i/∂μ_ij, which is
N_i(F) |n·b_ij| for the box (the sense in use).  Where several facets meet (by symmetry, say) the mean of
their derivatives is returned: F is concave in the coefficients and any such mean is a supergradient.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.pull import Pull
from slipmargin.limits.rows import (
    PullGeometry,
    active,
    facet_rows,
    largest,
    pull_geometry,
    refuse_slipping,
)
from slipmargin.limits.wrench_set import wheel_slope
from slipmargin.model import Model
from slipmargin.physics.grips import polyhedral

#: A wheel's component saturates where the facet sees more than this share of the largest [1].
SEEN = 1e-9
#: The same for the multipliers of an interior-point solver [1].
CONE_SEEN = 1e-5
_PARTS = ("drive", "transverse")


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensitivity:
    """Parameters
    ----------
    names : tuple of N str
    force_N : (M,)
    per_coefficient_N : (M, N, 2)
        ∂F_emax/∂μ of each wheel, drive and transverse [N].
    saturated : (M, N, 2) bool
        Forces at their limit in every way of resisting F_emax.
    lifts : (M, N) bool
        Wheels about to leave the floor.
    meeting : (M,) int
        How many rows are active; above one the derivative is one-sided.
    """

    names: tuple[str, ...]
    force_N: Array
    per_coefficient_N: Array
    saturated: NDArray[np.bool_]
    lifts: NDArray[np.bool_]
    meeting: NDArray[np.int_]

    def wheels(self) -> tuple[tuple[str, ...], ...]:
        """For each heading the names of the wheels with a saturated force, then ``tip-over at NAME``."""
        held = np.any(self.saturated, axis=2)
        return tuple(
            tuple(n for n, on in zip(self.names, row, strict=True) if on)
            + tuple(f"tip-over at {n}" for n, on in zip(self.names, up, strict=True) if on)
            for row, up in zip(held, self.lifts, strict=True)
        )

    def forces(self) -> tuple[tuple[str, ...], ...]:
        """As :meth:`wheels`, each saturated force by name: ``rear drive``, ``left transverse``."""
        return tuple(
            tuple(
                f"{n} {part}"
                for n, pair in zip(self.names, row, strict=True)
                for part, on in zip(_PARTS, pair, strict=True)
                if on
            )
            + tuple(f"tip-over at {n}" for n, on in zip(self.names, up, strict=True) if on)
            for row, up in zip(self.saturated, self.lifts, strict=True)
        )


def sensitivity(
    model: Model, phi_rad: Array, pull: Pull | None = None, rigid: Array | None = None
) -> Sensitivity:
    """What binds and what would help, by facets for the box grip, by the balance's multipliers otherwise.

    Parameters
    ----------
    phi_rad : (M,)
    rigid : (N,) bool, optional
        Wheels on rigid material; by default all stand on rollers.
    """
    state = np.zeros(model.count, dtype=bool) if rigid is None else np.asarray(rigid, dtype=bool)
    pull = Pull() if pull is None else pull
    g = pull_geometry(model, np.atleast_1d(np.asarray(phi_rad, dtype=float)), pull)
    mu = coefficients(model, state, g.phi_rad, Extreme.NEUTRAL)
    shape, coupling = model.grip.shape, model.grip.coupling
    box = polyhedral(model.grip.shape, model.grip.coupling)
    at = _by_facets(g, mu) if box else _by_cones(g, state)
    load = g.load_N + at.force[:, None] * g.load_change
    slope = at.seen  # the box's own slope; averaged over facets that meet
    if not box:
        each = np.broadcast_to(mu, (len(at.force), *mu.shape[1:]))
        slope = wheel_slope(g.maps, each, at.normals, shape, coupling)
    return Sensitivity(
        names=model.geometry.names,
        force_N=at.force,
        per_coefficient_N=slope * load[:, :, None],
        saturated=at.seen > SEEN * np.max(at.seen, axis=(1, 2), keepdims=True),
        lifts=at.lifts,
        meeting=at.meeting,
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Boundary:
    force: Array  #: (M,)
    normals: Array  #: (M, 3)
    seen: Array  #: (M, N, 2) |n·b|
    lifts: NDArray[np.bool_]  #: (M, N)
    meeting: NDArray[np.int_]  #: (M,)


def _by_facets(g: PullGeometry, mu: Array) -> _Boundary:
    a, b = facet_rows(g, mu)
    force = refuse_slipping(g.model, largest(a, b), g.phi_rad, g.load_N)
    on = active(a, b, force)
    facets = len(g.normals)
    # The mean over the rows that meet, each scaled so that F = its bound; |n·b| is averaged, not n.
    weight = on[:, :facets] / np.where(on[:, :facets], a[:, :facets], 1.0)
    weight = weight / np.maximum(on.sum(axis=1), 1)[:, None]
    each = np.abs(np.einsum("ka,aij->kij", g.normals, g.maps))
    each = np.where(each > SEEN * each.max(axis=(1, 2), keepdims=True), each, 0.0)
    lifts = np.zeros((len(force), g.model.count), dtype=bool)
    if g.tips:
        lifts = on[:, facets:]
    return _Boundary(
        force=force,
        normals=weight @ g.normals,
        seen=np.einsum("mk,kij->mij", weight, each),
        lifts=lifts,
        meeting=np.asarray(on.sum(axis=1)),
    )


def _by_cones(g: PullGeometry, rigid: Array) -> _Boundary:
    from slipmargin.limits.cones import cone_limits  # clarabel is loaded only where a cone needs it

    answer = cone_limits(g.model, g.phi_rad, g.pull, rigid)
    seen = np.abs(np.einsum("ma,aij->mij", answer.normals, g.maps))
    seen = np.where(seen > CONE_SEEN * seen.max(axis=(1, 2), keepdims=True), seen, 0.0)
    load = g.load_N + answer.force_N[:, None] * g.load_change
    lifts = (load < CONE_SEEN * g.model.inertia.weight_N) & (g.load_change < 0.0)
    return _Boundary(
        force=answer.force_N,
        normals=answer.normals,
        seen=seen,
        lifts=lifts,
        meeting=np.ones(len(answer.force_N), dtype=int),
    )
