"""A pull's limit by facets: rows A F ≤ b in the one unknown F, for every heading at once.

Static equilibrium asks −(F d + w_b) ∈ W, with d the pull's wrench per newton and w_b the bias.  With loads
N(F) = N⁰ + F t (forces above the floor shift load: the pull F t, the bias is in N⁰) facet k with outward
normal n and share s reads

    F (−n·d − s·t) ≤ s·N⁰ + n·w_b        and every wheel stays on the floor:   −t_i F ≤ N⁰_i.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.bias import Bias, bias, bias_extremes, load_extremes, refuse_lifting, shifts_load
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.pull import Pull
from slipmargin.limits.wrench_set import box_normals, wheel_share, wrench_maps
from slipmargin.model import Model
from slipmargin.physics.grips import GripShape

#: A row counts as active within this share of the limit [1].
ACTIVE = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullGeometry:
    """What a sweep needs of a model and a pull that does not change with the contact state."""

    model: Model
    pull: Pull
    phi_rad: Array  #: (M,)
    maps: Array  #: (3, N, 2)
    normals: Array  #: (K, 3)
    rays: Array  #: (M, 3)
    load_change: Array  #: (M, N)
    bias: Bias | None  #: None without external forces

    @property
    def tips(self) -> bool:
        """Whether the pull or another force shifts load."""
        return self.pull.height_m != 0.0 or shifts_load(self.model)

    @property
    def load_N(self) -> Array:
        """(M or 1, N) loads without the pull."""
        return self.model.loads.rest_N[None] if self.bias is None else self.bias.load_N


def pull_geometry(model: Model, phi_rad: Array, pull: Pull, normals: Array | None = None) -> PullGeometry:
    """Everything but the coefficients; phi_rad (M,), the facets' ``normals`` (K, 3) where they are known."""
    maps = wrench_maps(model)
    normals = box_normals(maps) if normals is None else normals
    rays = pull.rays(model, phi_rad)
    return PullGeometry(
        model=model,
        pull=pull,
        phi_rad=phi_rad,
        maps=maps,
        normals=normals,
        rays=rays,
        load_change=pull.load_change(model, rays),
        bias=bias(model, phi_rad) if model.external.terms else None,
    )


def facet_rows(geometry: PullGeometry, mu: Array, extreme: Extreme = Extreme.NEUTRAL) -> tuple[Array, Array]:
    """Coefficient and bound of every row.

    Parameters
    ----------
    mu : (M or 1, N, 2, 2)
        From :func:`~slipmargin.limits.friction.coefficients`.
    extreme
        Which end of an unknown bias to take.

    Returns
    -------
    a (M, R), b (M or 1, R)
        K facets, then N tip-over rows where a force shifts load.
    """
    g = geometry
    share = wheel_share(g.maps, mu, g.normals, GripShape.BOX, 0.0)  # (M or 1, K, N)
    rest = g.load_N
    a = -(g.normals @ g.rays.T).T  # stored row by row: the maximum over rows then runs along headings
    b = share @ rest[0] if len(rest) == 1 else (share @ rest[:, :, None])[..., 0]
    if g.bias is not None:
        b = b + g.bias.wrench @ g.normals.T
        if extreme is not Extreme.NEUTRAL:
            end = 0 if extreme is Extreme.LOW else 1
            b = b + bias_extremes(g.model, g.phi_rad, g.normals, share)[end]
            rest = rest + load_extremes(g.model, g.phi_rad)[end]
    if g.tips:
        a = a - np.einsum("mkn,mn->mk", np.broadcast_to(share, (len(a), *share.shape[1:])), g.load_change)
        a = np.concatenate([a, -g.load_change], axis=1)
        b = np.concatenate(
            [np.broadcast_to(b, (len(a), b.shape[1])), np.broadcast_to(rest, g.load_change.shape)], axis=1
        )
    return a, b


def largest(a: Array, b: Array) -> Array:
    """(M,) the largest F with a F ≤ b; NaN where even F = 0 breaks a row."""
    slack = b.min(axis=-1)
    if slack.min() > 0.0:
        return np.asarray(1.0 / np.max(a / b, axis=-1))
    room = np.full(a.shape, np.inf)
    size = np.max(np.abs(b), axis=-1, keepdims=True)
    np.divide(np.maximum(b, 0.0), a, out=room, where=a > 1e-14 * np.max(np.abs(a), axis=-1, keepdims=True))
    slips = np.any(b < -1e-12 * size, axis=-1)
    return np.where(slips, np.nan, np.min(room, axis=-1))


def facet_limit(geometry: PullGeometry, rigid: Array) -> Array:
    """(M,) F_emax(φ) [N] of a contact state, box grip.

    Raises
    ------
    NoSolution
        If the bias alone (a slope, say) makes the robot slip.
    """
    mu = coefficients(geometry.model, rigid, geometry.phi_rad)
    force = largest(*facet_rows(geometry, mu))
    return refuse_slipping(geometry.model, force, geometry.phi_rad, geometry.load_N)


def refuse_slipping(model: Model, force: Array, phi_rad: Array, load_N: Array) -> Array:
    """``force``, or NoSolution naming the first heading at which the robot slips or tips without any pull.

    ``load_N`` (M or 1, N) are the loads without the pull.
    """
    if np.any(np.isnan(force)):
        at = int(np.argmax(np.isnan(force)))
        place, load = f"pull at phi = {float(phi_rad[at]):.6g} rad", load_N[min(at, len(load_N) - 1)]
        refuse_lifting(model, load, place, force)
        raise NoSolution(
            place,
            "the robot slips without any pull",
            "weaken what pulls at it (a slope, a tether, a push), or raise the friction",
            force,
        )
    return force


def active(a: Array, b: Array, force: Array) -> Array:
    """(M, R) rows that hold with equality at F."""
    size = np.max(np.abs(b), axis=-1, keepdims=True)
    return np.asarray((b - a * force[:, None] <= ACTIVE * size) & (a > 0.0))
