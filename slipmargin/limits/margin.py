"""How far a wrench is from slipping: the distance to the boundary, and how often it fits.

Newtons and newton metres do not mix, so the distance needs a length ℓ: |(Fx, Fy, Mz/ℓ)| [N].  The nearest
boundary point of a convex set from inside lies where some normal n, |(nx, ny, ℓ nz)| = 1, has the least
h(n) − n·w.  (Compare the residual wrench of grasp planning: Ferrari and Canny, ICRA 1992.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.limits.wrench_set import WrenchSet

#: Search over normals of a coupled grip: starting spread, how many are moved, tries a round, rounds.
_SPREAD, _FEW, _RING, _ROUNDS = 400, 4, 60, 60
#: From inside, the normal found is then followed to where the ray along it leaves, for so many turns or until
#: the way gets no shorter by this share [1]: cone programs know it no better.
_TURNS, _SHORTER = 30, 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Margin:
    """Distance of a wrench from the boundary of the set the wheels can resist.

    Parameters
    ----------
    distance_N : float
        Signed distance [N], moments divided by ``length_m``; negative outside (by the row broken most).
    factor : float
        How often the wrench can be multiplied before a wheel slips; below 1 it slips already.
    length_m : float
    nearest : (3,)
        The boundary's point (or, outside, the foot on the plane broken most).
    normal : (3,)
        The normal there [1, 1, 1/m].
    limiting : tuple of str
        The wheels that saturate where scaling ends.
    """

    distance_N: float
    factor: float
    length_m: float
    nearest: Array
    normal: Array
    limiting: tuple[str, ...]


def margin(wrenches: WrenchSet, wrench: Array, length_m: float | None = None) -> Margin:
    """The margin of an external wrench (3,) on the body at rest [N, N, N m].

    Parameters
    ----------
    length_m : float, optional
        By default the largest lever arm of the wheels' forces about the centre of mass.

    Notes
    -----
    Friction answers with −w.  Exact by facets for the box grip.  A coupled grip has no facets: the factor
    is a cone program's, and the distance is searched over normals from an even spread over the sphere.  From
    inside cone programs end the search: where the ray along the best normal leaves, the plane that touches
    the set is no farther, and its normal is the next ray's.
    """
    demand = -frozen("wrench", wrench, (3,))
    scale = (
        arm(wrenches)
        if length_m is None
        else real("length_m", length_m, above=0.0, cure="give a positive length [m]")
    )
    per = np.array([1.0, 1.0, scale])  # normals below are unit vectors of the scaled space

    def room(normal: Array) -> Array:
        return np.asarray(wrenches.support(normal / per) - (normal / per) @ demand)

    def ratio(normal: Array) -> Array:
        along = (normal / per) @ demand
        out = np.full(len(normal), np.inf)
        np.divide(wrenches.support(normal / per), along, out=out, where=along > 1e-12 * np.max(np.abs(along)))
        return out

    start = unit(wrenches.normals * per)
    if not wrenches.polyhedral:
        start = np.vstack([start, sphere(_SPREAD)])
    nearest = _best(room, start, wrenches.polyhedral)
    if not wrenches.polyhedral and room(nearest[None])[0] > 0.0:
        nearest = _followed(wrenches, room, demand, per, nearest)
    distance = float(room(nearest[None])[0])
    if not np.any(demand):
        factor, leaving = np.inf, nearest / per
    elif wrenches.polyhedral:
        leaving = start[int(np.argmin(ratio(start)))] / per
        factor = float(np.min(ratio(start)))
    else:
        from slipmargin.limits.cones import cone_exit  # clarabel is loaded only where a cone needs it

        many, normals = cone_exit(wrenches, demand[None])
        factor, leaving = float(many[0]), normals[0]
    seen = np.abs(np.einsum("a,aij->ij", leaving, wrenches.maps))
    held = np.any(seen > 1e-6 * np.max(seen), axis=1)
    return Margin(
        distance_N=distance,
        factor=factor,
        length_m=scale,
        nearest=-(demand + distance * nearest * per),
        normal=-nearest / per,
        limiting=tuple(n for n, on in zip(wrenches.names, held, strict=True) if on),
    )


def arm(wrenches: WrenchSet) -> float:
    """The largest lever arm of any wheel's force about the centre of mass [m]."""
    return float(np.max(np.abs(wrenches.maps[2])))


def sphere(count: int) -> Array:
    """(count, 3) unit vectors spread evenly (Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z**2)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)


def _best(value: Callable[[Array], Array], start: Array, exact: bool) -> Array:
    # The best of the starting normals; where they are not all facets, the few best are moved downhill.
    order = np.argsort(value(start), kind="stable")
    if exact:
        return np.asarray(start[order[0]])
    here, size, steps = start[order[:_FEW]], 0.3, sphere(_RING)
    for _ in range(_ROUNDS):
        tries = unit(here[:, None] + size * np.concatenate([np.zeros((1, 3)), steps]))
        found = value(tries.reshape(-1, 3)).reshape(tries.shape[:2])
        here = tries[np.arange(len(here)), np.argmin(found, axis=1)]
        size *= 0.75
    return np.asarray(here[int(np.argmin(value(here)))])


def _followed(
    wrenches: WrenchSet, room: Callable[[Array], Array], demand: Array, per: Array, normal: Array
) -> Array:
    # The normal where the ray along this one leaves the set, the normal where the ray along that one does, …
    from slipmargin.limits.cones import cone_exit  # clarabel is loaded only where a cone needs it

    distance = room(normal[None])[0]
    for _ in range(_TURNS):
        onward = unit(cone_exit(wrenches, (normal * per)[None], demand)[1] * per)
        gained = distance - room(onward)[0]
        if gained <= 0.0:
            break
        normal, distance = onward[0], distance - gained
        if gained <= _SHORTER * distance:
            break
    return normal


def unit(vectors: Array) -> Array:
    """Vectors of length 1, and none of none."""
    size = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(size > 0.0, size, 1.0))
