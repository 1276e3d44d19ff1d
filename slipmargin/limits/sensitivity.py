"""What limits a pull, and what would raise the limit: the active facets' own numbers.

At facet k: F = (s·N⁰ + n·w_b)/(−n·d − s·t), so ∂F/∂μ_ijs = N_i(F) |n·b_ij| / (−n·d − s·t) for the sense s the
facet uses.  Where several facets meet (by symmetry, say) the mean of their derivatives is returned: F is
concave in the coefficients and any such mean is a supergradient.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.pull import Pull
from slipmargin.limits.rows import active, facet_rows, largest, pull_geometry, refuse_slipping
from slipmargin.model import Model

#: A wheel's component saturates where the facet sees more than this share of the largest [1].
SEEN = 1e-9
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
    saturated: Array
    lifts: Array
    meeting: Array

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
            tuple(f"{n} {part}" for n, pair in zip(self.names, row, strict=True)
                  for part, on in zip(_PARTS, pair, strict=True) if on)
            + tuple(f"tip-over at {n}" for n, on in zip(self.names, up, strict=True) if on)
            for row, up in zip(self.saturated, self.lifts, strict=True)
        )


def sensitivity(model: Model, phi_rad: Array, pull: Pull, rigid: Array | None = None) -> Sensitivity:
    """Limits and derivatives by the facets of the box grip.

    For a coupled grip the multipliers of the cone program say the same (:mod:`slipmargin.limits.cones`).
    """
    state = np.zeros(model.count, dtype=bool) if rigid is None else np.asarray(rigid, dtype=bool)
    g = pull_geometry(model, np.atleast_1d(np.asarray(phi_rad, dtype=float)), pull)
    mu = coefficients(model, state, g.phi_rad, Extreme.NEUTRAL)
    a, b = facet_rows(g, mu)
    force = refuse_slipping(largest(a, b), g.phi_rad)
    on = active(a, b, force)
    facets = len(g.normals)
    load = model.loads.rest_N + force[:, None] * g.load_change
    seen = np.abs(np.einsum("ka,aij->kij", g.normals, g.maps))
    weight = on[:, :facets] / np.where(on[:, :facets], a[:, :facets], 1.0)
    weight = weight / np.maximum(on.sum(axis=1), 1)[:, None]
    slope = np.einsum("mk,kij->mij", weight, seen) * load[:, :, None]
    bound = seen > SEEN * seen.max(axis=(1, 2), keepdims=True)
    saturated = np.any(on[:, :facets, None, None] & bound, axis=1)
    lifts = on[:, facets:] if g.tips else np.zeros((len(force), model.count), dtype=bool)
    return Sensitivity(names=model.contacts.names, force_N=force, per_coefficient_N=slope,
                       saturated=saturated, lifts=lifts, meeting=on.sum(axis=1))
