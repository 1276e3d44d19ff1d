"""The chance of slip of a robot whose numbers are uncertain, by sampling the closed forms of its limits.

Drawn are mass, yaw inertia, place and height of the centre of mass, load fractions and coefficients, each by
itself, a coefficient once for all wheels.  Everything is taken about the stated centre of mass, so that the
wheels' wrench maps and the normals of their sets stay the same in every draw.

At an outward normal n of the wrench set the pull limit is F = h(n) / (−n·d), where the support h follows
from the coefficients and loads without a solver (docs/theory.md, section 4).  The box has finitely many
normals, whatever its coefficients.  A coupled grip has a curved set: its
normals are taken from a few cone programs over the spread, so its limit is that of a set a little too
large (by a fraction of a percent of F).  Motion is in :mod:`~slipmargin.limits.uncertainty_motion`.
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
from slipmargin.limits.wrench_set import box_normals, moved_normals, wheel_share, wrench_maps
from slipmargin.model import Model
from slipmargin.model.loads import nominal_loads
from slipmargin.physics.grips import polyhedral
from slipmargin.physics.loads import LoadRule, sharing_matrix
from slipmargin.robot import Robot
from slipmargin.robot.uncertain import drawn as drawn_values, spread

#: Draws at once; bounds the memory that a sweep of many orientations needs.
_BLOCK = 500
#: Headings for whose limits a coupled grip's normals are found.
_HEADINGS = 36
#: Wheel shares that are computed for a chance where every draw needs facets of its own: 16 ns each, so
#: that a sweep answers within 10 s.
_ONE_BY_ONE = 5e8
#: Draws of which a chance is counted, unless another number is asked for.
DRAWS = 10_000


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Draws:
    """D drawn robots, relative to the model they are drawn around.

    Parameters
    ----------
    roller, rigid : (D, 2)
        Drive and transverse coefficients over the stated ones [1].
    mass, inertia : (D,)
        Over the stated ones [1].
    com_shift_m : (D, 2)
        Centre of mass minus the stated one [m].
    rest_N : (D, N)
        Loads at rest on a level, even floor [N]; below 0 where the robot falls over.
    per_acceleration_kg : (D, N, 2)
        Change of load per acceleration of the centre of mass [kg].
    """

    roller: Array
    rigid: Array
    mass: Array
    inertia: Array
    com_shift_m: Array
    rest_N: Array
    per_acceleration_kg: Array

    def __post_init__(self) -> None:
        shapes: dict[str, tuple[int | None, ...]] = {
            "roller": (None, 2),
            "rigid": (None, 2),
            "mass": (None,),
            "inertia": (None,),
            "com_shift_m": (None, 2),
            "rest_N": (None, None),
            "per_acceleration_kg": (None, None, 2),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(name, getattr(self, name), shape))

    def __len__(self) -> int:
        return len(self.roller)

    def take(self, rows: slice) -> Draws:
        """Some of the draws."""
        return Draws(**{name: getattr(self, name)[rows] for name in self.__slots__})

    def model(self, model: Model, at: int) -> Model:
        """The model of one draw."""
        inertia, loads, grip = model.inertia, model.loads, model.grip
        return replace(
            model,
            inertia=replace(
                inertia,
                mass_kg=inertia.mass_kg * self.mass[at],
                inertia_kg_m2=inertia.inertia_kg_m2 * self.inertia[at],
                com_m=inertia.com_m + self.com_shift_m[at],
            ),
            loads=replace(
                loads,
                rest_N=np.maximum(self.rest_N[at], 0.0),
                per_acceleration_kg=self.per_acceleration_kg[at],
            ),
            grip=replace(grip, roller=grip.roller * self.roller[at], rigid=grip.rigid * self.rigid[at]),
        )


def draws(robot: Robot, model: Model, count: int, seed: int) -> Draws:
    """Random robots around a model of ``robot``; effects stay as they are.

    Raises
    ------
    InputError
        For an uncertain mass with an effect that adds an external force: some follow the mass, some do not.
    """
    rng, body, floor = np.random.default_rng(seed), robot.body, robot.surface(model.surface)
    factors = {
        name: np.column_stack(
            [
                drawn_values(v, rng, count) / (float(v) if spread(v) else v or 1.0)
                for v in (p.drive, p.transverse)
            ]
        )
        for name, p in (("roller", floor.roller), ("rigid", floor.rigid))
    }
    for name in factors:  # a coefficient of zero stays zero
        factors[name][~np.isfinite(factors[name])] = 1.0
    mass, inertia, com, height = (
        drawn_values(v, rng, count) for v in (body.mass_kg, body.inertia_kg_m2, body.com_m, body.com_height_m)
    )
    if model.external.terms and spread(body.mass_kg):
        raise InputError(
            "chance",
            "is not computed for an uncertain mass with an effect that adds a force",
            "give body.mass_kg as one number, or leave the effect out",
        )
    place, share = model.geometry.position_m, sharing_matrix(model.geometry.position_m)
    scale, shift = mass / body.mass_kg, com - np.asarray(body.com_m)
    weight = model.inertia.weight_N / model.inertia.mass_kg * mass
    stated = nominal_loads(robot)
    if robot.load_rule is LoadRule.EQUAL:
        even = weight[:, None] * np.full(len(place), 1.0 / len(place))
    elif robot.load_rule is LoadRule.FIXED:
        part = drawn_values(robot.load_fractions, rng, count)
        even = weight[:, None] * part / part.sum(axis=1, keepdims=True)
    else:
        even = (weight[:, None] * np.column_stack([np.ones(count), com])) @ share.T
    # What effects changed grows with the mass; what the drawn numbers change comes on top.
    rest = scale[:, None] * (model.loads.rest_N - stated.rest_N) + even
    per = scale[:, None, None] * model.loads.per_acceleration_kg
    if robot.load_rule is LoadRule.QUASI_STATIC:
        raised = mass * (height - body.com_height_m)
        per = per - raised[:, None, None] * share[:, 1:]
    return Draws(
        roller=factors["roller"],
        rigid=factors["rigid"],
        mass=scale,
        inertia=inertia / body.inertia_kg_m2,
        com_shift_m=shift,
        rest_N=rest,
        per_acceleration_kg=per,
    )


def lowest_pulls(model: Model, phi_rad: Array, drawn: Draws) -> Array:
    """The paper's pull (D,) before a wheel slips, the lowest over headings φ (M,), contacts and loads [N].

    A wheel with rigid sectors takes the smaller of its roller's and its rigid coefficient, component by
    component: the lowest state, or a little below it where the two cross.  Where the robot slips without
    any pull, or falls over, the value is 0.

    Raises
    ------
    InputError
        For a coupled grip with an effect that changes friction or adds an external force, and for more
        wheels and headings with one than are computed within seconds.
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
        normals = box_normals(wrench_maps(model))
        work = len(base) * len(phi) * len(normals) * model.count
        if work > _ONE_BY_ONE:
            raise InputError(
                "chance",
                f"is not computed for {model.count} wheels at {len(phi)} headings with effects on friction "
                f"or forces: that asks for {work:.0e} wheel shares, {_ONE_BY_ONE:.0e} at most",
                "give a larger --step, or leave the effects out",
            )
        found = _one_by_one(model, phi, base, drawn, normals)
    else:
        maps = wrench_maps(model)
        normals = box_normals(maps) if box else _cone_normals(model, phi, base)
        rays = Pull().rays(model, phi)
        found = np.empty(len(base))
        for start in range(0, len(base), _BLOCK):
            rows = slice(start, start + _BLOCK)
            mu = np.repeat(base[rows, :, :, None], 2, axis=3)
            share = wheel_share(maps, mu, normals, model.grip.shape, model.grip.coupling)
            found[rows] = _lowest(model, share, normals, rays, drawn.take(rows))
    return np.asarray(np.where(np.min(drawn.rest_N, axis=1) < 0.0, 0.0, found))


def _lowest(model: Model, share: Array, normals: Array, rays: Array, drawn: Draws) -> Array:
    """(b,) lowest pull of a block of draws; ``share`` (b, K, N), ``rays`` (M, 3) about the stated centre."""
    # h does not depend on the heading, so at each normal the heading with the largest −n·d is the weakest.
    if np.any(drawn.com_shift_m):
        most = _towards(rays, normals, drawn.com_shift_m)
    else:
        most = np.max(-(rays @ normals.T), axis=0)[None]
    held = np.min(
        [
            np.einsum("bkn,bn->bk", share, np.maximum(drawn.rest_N + shift, 0.0))
            for shift in model.loads.shifts()
        ],
        axis=0,
    )
    most = np.broadcast_to(most, held.shape)
    out = np.full(held.shape, np.inf)
    np.divide(held, most, out=out, where=most > 1e-12)
    return np.asarray(out.min(axis=1))


def _towards(rays: Array, normals: Array, shift: Array) -> Array:
    """(b, K) largest −n·d over unit pulls ``rays`` (M, 3) through centres of mass moved by ``shift`` (b, 2).

    About the stated centre the pull (x, y) through c has the moment c_x y − c_y x.  So −n·d is the product of
    (x, y) with one vector, largest for the pull nearest to it in direction.
    """
    x = -normals[:, 0] + np.multiply.outer(shift[:, 1], normals[:, 2])
    y = -normals[:, 1] - np.multiply.outer(shift[:, 0], normals[:, 2])
    angle = np.sort(np.arctan2(rays[:, 1], rays[:, 0]))
    after = np.searchsorted(angle, np.arctan2(y, x))
    best = [x * np.cos(a) + y * np.sin(a) for a in (angle[after % len(angle)], angle[after - 1])]
    return np.asarray(np.maximum(*best))


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
        for shift in model.loads.shifts():
            loads = replace(model.loads, rest_N=np.maximum(model.loads.rest_N + shift, 0.0))
            at = replace(model, grip=replace(model.grip, roller=mu), loads=loads)
            found.append(cone_limits(at, some, Pull(), state).normals)
    return np.concatenate(found)


def _one_by_one(model: Model, phi: Array, base: Array, drawn: Draws, normals: Array) -> Array:
    """The same where friction or forces depend on the heading: rows anew for each draw."""
    state, out = np.zeros(model.count, dtype=bool), np.empty(len(base))
    for d, mu in enumerate(base):
        own, about = drawn.model(model, d), moved_normals(normals, drawn.com_shift_m[d])
        for shift in model.loads.shifts():
            loads = replace(own.loads, rest_N=np.maximum(own.loads.rest_N + shift, 0.0))
            at = replace(own, grip=replace(model.grip, roller=mu), loads=loads)
            geometry = pull_geometry(at, phi, Pull(), about)
            rows = facet_rows(geometry, coefficients(at, state, phi, Extreme.LOW), Extreme.LOW)
            lowest = np.min(np.nan_to_num(largest(*rows), nan=0.0))
            out[d] = lowest if not np.any(shift) else min(out[d], lowest)
    return out


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SlipChance:
    """How likely a recommended number makes a wheel slip, or the robot tip, over the spread of the robot.

    ``at_recommended`` is the share of the draws that slip there, ``value`` the pull [N] or acceleration
    [m/s²] at which the share ``chance`` of them slips, whichever heading swept.
    """

    at_recommended: float
    chance: float
    value: float
    draws: int
    seed: int

    def table(self, name: str) -> dict[str, float]:
        """As plain data, ``value`` under its name with its unit."""
        return {
            "at_recommended": self.at_recommended,
            "chance": self.chance,
            name: self.value,
            "draws": self.draws,
            "seed": self.seed,
        }


def checked_chance(chance: float) -> float:
    """The chance, from that of ten draws to 0.5.

    Raises
    ------
    InputError
        Placed at ``chance``.
    """
    return real(
        "chance", chance, low=10.0 / DRAWS, high=0.5, cure=f"give a chance from {10 / DRAWS:g} to 0.5"
    )


def counted(lowest: Array, recommended: float, *, chance: float, seed: int) -> SlipChance:
    """The chance at a recommended number, and the number for a chance, of the limits (D,) of the draws.

    A draw whose limit is 0 slips in any case, also where nothing more than 0 is recommended.
    """
    ordered = np.sort(lowest)
    slips = np.searchsorted(ordered, recommended, side="left" if recommended > 0.0 else "right")
    return SlipChance(
        at_recommended=float(slips) / len(ordered),
        chance=chance,
        value=float(ordered[int(chance * len(ordered))]),
        draws=len(ordered),
        seed=seed,
    )
