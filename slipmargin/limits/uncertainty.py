"""The pull limit of a robot whose friction coefficients are uncertain, by sampling its closed form.

At an outward normal n of the wrench set the limit is F = h(n) / (−n·d), where the support h follows from
the coefficients and loads without a solver (docs/theory.md, section 4).  The box has finitely many
normals, whatever its coefficients.  A coupled grip has a curved set: its
normals are taken from a few cone programs over the spread, so its limit is that of a set a little too
large (by a fraction of a percent of F).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.errors import InputError
from slipmargin.limits.friction import Extreme, coefficients
from slipmargin.limits.pull import Pull
from slipmargin.limits.rows import facet_rows, largest, pull_geometry
from slipmargin.limits.wrench_set import box_normals, wheel_share, wrench_maps
from slipmargin.model import Model
from slipmargin.physics.grips import polyhedral
from slipmargin.robot import Surface, Uncertain

#: Draws at once; bounds the memory that a sweep of many orientations needs.
_BLOCK = 500
#: Headings for whose limits a coupled grip's normals are found.
_HEADINGS = 36


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Draws:
    """Drawn coefficients over the stated ones [1]: drive and transverse, (D, 2), on rollers and rigid."""

    roller: Array
    rigid: Array

    def __post_init__(self) -> None:
        for name in ("roller", "rigid"):
            object.__setattr__(self, name, frozen(name, getattr(self, name), (None, 2)))

    def __len__(self) -> int:
        return len(self.roller)


def uncertain(surface: Surface) -> bool:
    """Whether a coefficient of the surface has a spread."""
    pairs = (surface.roller, surface.rigid)
    return any(isinstance(v, Uncertain) for pair in pairs for v in (pair.drive, pair.transverse))


def draws(surface: Surface, count: int, seed: int) -> Draws:
    """Random coefficients of a surface; each coefficient is drawn once for all wheels, by itself."""
    rng = np.random.default_rng(seed)

    def factors(value: float) -> Array:
        return value.drawn(rng, count) / float(value) if isinstance(value, Uncertain) else np.ones(count)

    roller, rigid = (
        np.column_stack([factors(p.drive), factors(p.transverse)]) for p in (surface.roller, surface.rigid)
    )
    return Draws(roller=roller, rigid=rigid)


def lowest_pulls(model: Model, phi_rad: Array, drawn: Draws) -> Array:
    """The paper's pull (D,) before a wheel slips, the lowest over headings φ (M,) and contact states [N].

    A wheel with rigid sectors takes the smaller of its roller's and its rigid coefficient, component by
    component: the lowest state, or a little below it where the two cross.  Where the robot slips without
    any pull the value is 0.

    Raises
    ------
    InputError
        For a coupled grip with an effect that changes friction or adds an external force.
    """
    phi = np.atleast_1d(np.asarray(phi_rad, dtype=float))
    base = _lowest_coefficients(model, drawn)
    box = polyhedral(model.grip.shape, model.grip.coupling)
    if model.external.terms or model.grip.multipliers:
        if not box:
            raise InputError(
                "chance",
                f"is not computed for the grip {model.grip.shape.value!r} with effects on friction or forces",
                'use grip = "box", or leave the effects out',
            )
        return _one_by_one(model, phi, base)
    maps, load = wrench_maps(model), model.loads.rest_N
    normals = box_normals(maps) if box else _cone_normals(model, phi, base)
    # h does not depend on the heading, so at each normal the heading with the largest −n·d is the weakest.
    most = np.max(-(Pull().rays(model, phi) @ normals.T), axis=0)
    normals, most = normals[most > 1e-12], most[most > 1e-12]
    out = np.empty(len(base))
    for start in range(0, len(base), _BLOCK):
        mu = np.repeat(base[start : start + _BLOCK, :, :, None], 2, axis=3)
        share = wheel_share(maps, mu, normals, model.grip.shape, model.grip.coupling)
        out[start : start + _BLOCK] = np.min(share @ load / most, axis=1)
    return out


def _lowest_coefficients(model: Model, drawn: Draws) -> Array:
    """(D, N, 2) drive and transverse coefficient of each wheel in its lowest contact state."""
    roller = model.grip.roller * drawn.roller[:, None, :]
    rigid = model.grip.rigid * drawn.rigid[:, None, :]
    fraction = model.grip.rigid_fraction[:, None]
    mixed = np.where(fraction <= 0.0, roller, np.minimum(roller, rigid))
    return np.asarray(np.where(fraction >= 1.0, rigid, mixed))


def _cone_normals(model: Model, phi: Array, base: Array) -> Array:
    """(K, 3) normals at which the limits lie, by cone programs over the spread of the coefficients."""
    from slipmargin.limits.cones import cone_limits  # clarabel is loaded only where a cone needs it

    some = phi[np.unique(np.linspace(0, len(phi) - 1, _HEADINGS).astype(int))]
    low, middle, high = np.quantile(base, [0.02, 0.5, 0.98], axis=0)
    state = np.zeros(model.count, dtype=bool)
    found = []
    for drive, transverse in ((middle, middle), (low, low), (low, high), (high, low), (high, high)):
        mu = np.column_stack([drive[:, 0], transverse[:, 1]])
        at = replace(model, grip=replace(model.grip, roller=mu))
        found.append(cone_limits(at, some, Pull(), state).normals)
    return np.concatenate(found)


def _one_by_one(model: Model, phi: Array, base: Array) -> Array:
    """The same where friction or forces depend on the heading: rows anew for each draw."""
    state, out = np.zeros(model.count, dtype=bool), np.empty(len(base))
    for d, mu in enumerate(base):
        at = replace(model, grip=replace(model.grip, roller=mu))
        geometry = pull_geometry(at, phi, Pull())
        rows = facet_rows(geometry, coefficients(at, state, phi, Extreme.LOW), Extreme.LOW)
        out[d] = np.min(np.nan_to_num(largest(*rows), nan=0.0))
    return out


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SlipChance:
    """How likely a pull makes a wheel slip, over the spread of the coefficients.

    ``at_recommended`` is the share of the draws that slip at the recommended pull, ``force_N`` the pull at
    which the share ``chance`` of them slips, whichever heading swept.
    """

    at_recommended: float
    chance: float
    force_N: float
    draws: int
    seed: int


def slip_chance(
    model: Model,
    surface: Surface,
    phi_rad: Array,
    recommended_N: float,
    *,
    chance: float = 0.01,
    seed: int = 0,
    count: int = 10_000,
) -> SlipChance:
    """The chance of slip at a pull, and the pull for a chosen chance.

    Raises
    ------
    InputError
        If the chance is not from 10 draws of ``count`` to 0.5.
    """
    chance = real(
        "chance", chance, low=10.0 / count, high=0.5, cure=f"give a chance from {10 / count:g} to 0.5"
    )
    lowest = np.sort(lowest_pulls(model, phi_rad, draws(surface, count, seed)))
    return SlipChance(
        at_recommended=float(np.searchsorted(lowest, recommended_N)) / count,
        chance=chance,
        force_N=float(lowest[int(chance * count)]),
        draws=count,
        seed=seed,
    )
