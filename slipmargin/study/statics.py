"""Static slip limits of many designs at once (eqs 12–18): F_emax / (m g) over all headings.

A zonotope's exit along d is 1 / max_k |n_k·d| / h_k over the normals n_k = g_i × g_j of all pairs of
generators: one array for designs × normals × headings, in blocks that fit a processor's cache.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.band import band
from slipmargin.limits.friction import Extreme
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.limits.wrench_set import wrench_set
from slipmargin.model import Model
from slipmargin.physics.frames import to_body
from slipmargin.physics.loads import LoadRule
from slipmargin.sets.facets import batch_ray_exit
from slipmargin.study.fleet import Fleet
from slipmargin.study.machine import Machine

#: Headings of a sweep all round; the last repeats the first.
HEADINGS = 721
_BLOCK = 1_000_000  # numbers in one block


def headings(count: int = HEADINGS) -> Array:
    """(count,) headings from 0 to 2π, both included [rad]."""
    return np.linspace(0.0, 2.0 * np.pi, count)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Forces:
    """F_emax of D designs at M headings (D, M) and the largest pure yaw moment (D,).

    ``force`` per m g [1]; ``moment_m`` per m g [m].
    """

    force: Array
    moment_m: Array


def forces(fleet: Fleet, mu: Array, load: Array, phi_rad: Array) -> Forces:
    """Limits of a fleet by zonotopes; valid where ``fleet.plain``.

    Parameters
    ----------
    mu, load : (D, N, 2), (D, N)
        Coefficients and loads [shares of m g].
    phi_rad : (M,)
    """
    generators = (fleet.maps * (mu * load[..., None])[:, None]).reshape(len(mu), 3, -1)
    # A centrally symmetric set: the sign of the pull does not matter.
    along = np.column_stack([*to_body(phi_rad, 1.0, 0.0), np.zeros_like(phi_rad)])
    rays = np.vstack([along, [0.0, 0.0, 1.0]])
    pairs = fleet.wheels * (2 * fleet.wheels - 1)
    block = max(1, _BLOCK // (pairs * len(rays)))
    out = np.concatenate([batch_ray_exit(generators[i : i + block], rays) for i in range(0, len(mu), block)])
    return Forces(force=out[:, :-1], moment_m=out[:, -1])


def on_rollers(
    fleet: Fleet, phi_rad: Array, machines: Sequence[Machine | None], rule: LoadRule | None = None
) -> Forces:
    """All wheels on rollers; designs that no zonotope describes are solved one by one (0: slips unpulled).

    ``rule`` EQUAL or STATIC replaces the designs' own load model.
    """
    own = fleet.rest if rule is None else loads_by(fleet, rule)
    return _corrected(fleet, forces(fleet, fleet.roller, own, phi_rad), phi_rad, machines, None, rule)


def on_rigid(fleet: Fleet, phi_rad: Array, machines: Sequence[Machine | None]) -> Forces:
    """All wheels on rigid material, whatever its share."""
    found = forces(fleet, fleet.rigid, fleet.rest, phi_rad)
    return _corrected(fleet, found, phi_rad, machines, np.ones(fleet.wheels), None)


def lowest(fleet: Fleet, phi_rad: Array, machines: Sequence[Machine | None]) -> Array:
    """(D, M) lowest F_emax / (m g) over the 2^N roller/rigid states (see :mod:`slipmargin.limits.band`)."""
    worst = np.full((len(fleet.index), len(phi_rad)), np.inf)
    for state in _states(fleet):
        mu = np.where(state[..., None], fleet.rigid, fleet.roller)
        worst = np.minimum(worst, forces(fleet, mu, fleet.rest, phi_rad).force)
    for d in np.flatnonzero(~fleet.plain).tolist():
        worst[d] = band(_model(machines, fleet, d), phi_rad, Pull())[0] / fleet.weight_N[d]
    return worst


def _states(fleet: Fleet) -> list[NDArray[np.bool_]]:
    """Contact states (D, N) that hold the lowest; only wheels whose coefficients cross need two."""
    lower, higher = np.all(fleet.rigid <= fleet.roller, axis=2), np.all(fleet.rigid >= fleet.roller, axis=2)
    some, all_rigid = fleet.rigid_fraction > 0.0, fleet.rigid_fraction >= 1.0
    base = (some & lower & ~higher) | all_rigid
    crossing = some & ~all_rigid & ~lower & ~higher
    columns = np.flatnonzero(crossing.any(axis=0))
    out = []
    for choice in itertools.product((False, True), repeat=len(columns)):
        state = base.copy()
        for column, on in zip(columns, choice, strict=True):
            state[:, column] = np.where(crossing[:, column], on, base[:, column])
        out.append(state)
    return out


def _corrected(
    fleet: Fleet,
    found: Forces,
    phi_rad: Array,
    machines: Sequence[Machine | None],
    rigid: Array | None,
    rule: LoadRule | None,
) -> Forces:
    force, moment = found.force, found.moment_m
    for d in np.flatnonzero(~fleet.plain).tolist():
        model = _model(machines, fleet, d, rule)
        try:
            force[d] = limit(model, phi_rad, Pull(), rigid) / fleet.weight_N[d]
        except NoSolution:
            force[d] = 0.0
        moment[d] = _moment(model, rigid) / fleet.weight_N[d]
    return Forces(force=force, moment_m=moment)


def _moment(model: Model, rigid: Array | None) -> float:
    """Largest pure moment of a grip without facets: the support function's least ratio, by a search [N m]."""
    from scipy.optimize import minimize

    wrenches = wrench_set(model, rigid, extreme=Extreme.NEUTRAL)

    def height(xy: Array) -> float:
        return float(wrenches.support(np.array([xy[0], xy[1], 1.0])))

    reach = float(np.max(np.abs(wrenches.maps[2])))
    found = minimize(
        height,
        np.zeros(2),
        method="Nelder-Mead",
        options={
            "xatol": 1e-9 * reach,
            "fatol": 1e-12,
            "maxiter": 2000,
            "initial_simplex": reach * np.array([[0.0, 0.0], [0.3, 0.0], [0.0, 0.3]]),
        },
    )
    return float(found.fun)


def loads_by(fleet: Fleet, rule: LoadRule) -> Array:
    """(D, N) loads of the fleet under a rule [shares of m g]."""
    return np.full_like(fleet.rest, 1.0 / fleet.wheels) if rule is LoadRule.EQUAL else fleet.static


def _model(machines: Sequence[Machine | None], fleet: Fleet, d: int, rule: LoadRule | None = None) -> Model:
    machine = machines[int(fleet.index[d])]
    assert machine is not None
    if rule is not None:
        machine = machine.with_robot(replace(machine.robot, load_rule=rule, load_fractions=None))
    return machine.build()
