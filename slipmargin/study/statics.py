"""Static slip limits of many designs at once (eqs 12–18): F_emax / (m g) over all headings.

A zonotope's exit along d is 1 / max_k |n_k·d| / h_k over the normals n_k = g_i × g_j of all pairs of
generators: one array for designs × normals × headings, in blocks that fit a processor's cache.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.limits.band import band
from slipmargin.limits.bias import loads_at_rest
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit_or_zero
from slipmargin.model import Model
from slipmargin.physics.frames import to_body
from slipmargin.physics.loads import LoadRule
from slipmargin.physics.variables import Target
from slipmargin.sets.facets import batch_ray_exit
from slipmargin.study.batch import Batch
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.work import STANDING_STATES, allow_states

#: Headings of a sweep all round; the last repeats the first.
HEADINGS = 721
_BLOCK = 1_000_000  # numbers in one block


def headings(count: int = HEADINGS) -> Array:
    """(count,) headings from 0 to 2π, both included [rad]."""
    return np.linspace(0.0, 2.0 * np.pi, count)


def forces(batch: Batch, mu: Array, load: Array, phi_rad: Array) -> Array:
    """F_emax / (m g) of D designs at M headings (D, M) by zonotopes; valid where ``batch.plain``.

    Parameters
    ----------
    mu, load : (D, N, 2), (D, N)
        Coefficients and loads [shares of m g].
    phi_rad : (M,)
    """
    # A centrally symmetric set: the sign of the pull does not matter.
    return _exits(batch, mu, load, np.column_stack([*to_body(phi_rad, 1.0, 0.0), np.zeros_like(phi_rad)]))


def _exits(batch: Batch, mu: Array, load: Array, rays: Array) -> Array:
    """(D, M) where rays (M, 3) leave the zonotopes [shares of m g]."""
    generators = (batch.maps * (mu * load[..., None])[:, None]).reshape(len(mu), 3, -1)
    pairs = batch.wheels * (2 * batch.wheels - 1)
    block = max(1, _BLOCK // (pairs * len(rays)))
    return np.concatenate([batch_ray_exit(generators[i : i + block], rays) for i in range(0, len(mu), block)])


def on_rollers(
    batch: Batch, phi_rad: Array, designs: Sequence[RobotOnSurface | None], rule: LoadRule | None = None
) -> Array:
    """(D, M) F_emax / (m g) on rollers; designs that no zonotope describes are solved one by one.

    It is 0 where the robot slips without any pull.
    ``rule`` EQUAL or STATIC replaces the designs' own load model.
    """
    own = batch.rest if rule is None else loads_by(batch, rule)
    return _corrected(batch, forces(batch, batch.roller, own, phi_rad), phi_rad, designs, None, rule)


def on_rigid(batch: Batch, phi_rad: Array, designs: Sequence[RobotOnSurface | None]) -> Array:
    """(D, M) F_emax / (m g) with all wheels on rigid material, whatever its share."""
    found = forces(batch, batch.rigid, batch.rest, phi_rad)
    return _corrected(batch, found, phi_rad, designs, np.ones(batch.wheels), None)


def lowest(batch: Batch, phi_rad: Array, designs: Sequence[RobotOnSurface | None]) -> Array:
    """(D, M) lowest F_emax / (m g) over the 2^N roller/rigid states (see :mod:`slipmargin.limits.band`)."""
    worst = np.full((len(batch.index), len(phi_rad)), np.inf)
    for state in _states(batch):
        mu = np.where(state[..., None], batch.rigid, batch.roller)
        worst = np.minimum(worst, forces(batch, mu, batch.rest, phi_rad))
    for d in np.flatnonzero(~batch.plain).tolist():
        worst[d] = band(_model(designs, batch, d), phi_rad, Pull())[0] / batch.weight_N[d]
    return worst


def _states(batch: Batch) -> list[NDArray[np.bool_]]:
    """Contact states (D, N) that hold the lowest; only wheels whose coefficients cross need two."""
    lower, higher = np.all(batch.rigid <= batch.roller, axis=2), np.all(batch.rigid >= batch.roller, axis=2)
    some, all_rigid = batch.rigid_fraction > 0.0, batch.rigid_fraction >= 1.0
    base = (some & lower & ~higher) | all_rigid
    crossing = some & ~all_rigid & ~lower & ~higher
    columns = np.flatnonzero(crossing.any(axis=0))
    allow_states("wheel", len(columns), STANDING_STATES)
    out = []
    for choice in itertools.product((False, True), repeat=len(columns)):
        state = base.copy()
        for column, on in zip(columns, choice, strict=True):
            state[:, column] = np.where(crossing[:, column], on, base[:, column])
        out.append(state)
    return out


def _corrected(
    batch: Batch,
    force: Array,
    phi_rad: Array,
    designs: Sequence[RobotOnSurface | None],
    rigid: Array | None,
    rule: LoadRule | None,
) -> Array:
    for d in np.flatnonzero(~batch.plain).tolist():
        model = _model(designs, batch, d, rule)
        force[d] = limit_or_zero(model, phi_rad, Pull(), rigid) / batch.weight_N[d]
    return force


def yaw_moments(batch: Batch, phi_rad: Array, designs: Sequence[RobotOnSurface | None]) -> Array:
    """(D,) largest pure moment held on rollers in both senses at every heading [N m]; 0 where it slips."""
    out = _exits(batch, batch.roller, batch.rest, np.array([[0.0, 0.0, 1.0]]))[:, 0] * batch.weight_N
    for d in np.flatnonzero(~batch.plain).tolist():
        model, at = _model(designs, batch, d), phi_rad
        if not model.external.terms and not any(
            t.target is not Target.STIFFNESS for t in model.grip.multipliers
        ):
            at = at[:1]  # nothing depends on the heading
        out[d] = min(float(np.min(limit_or_zero(model, at, Pull(pure_moment=w)))) for w in (1.0, -1.0))
    return out


def loads_by(batch: Batch, rule: LoadRule) -> Array:
    """(D, N) loads of the batch under a rule [shares of m g]."""
    return np.full_like(batch.rest, 1.0 / batch.wheels) if rule is LoadRule.EQUAL else batch.static


def least_loads(batch: Batch, phi_rad: Array, designs: Sequence[RobotOnSurface | None]) -> Array:
    """(D,) load of the lightest wheel, the least over headings [shares of m g]."""
    out = np.array(np.min(batch.rest, axis=1))
    for d in np.flatnonzero(~batch.plain).tolist():
        out[d] = float(np.min(loads_at_rest(_model(designs, batch, d), phi_rad))) / batch.weight_N[d]
    return out


def _model(
    designs: Sequence[RobotOnSurface | None], batch: Batch, d: int, rule: LoadRule | None = None
) -> Model:
    design = designs[int(batch.index[d])]
    assert design is not None
    if rule is not None:
        design = design.with_robot(replace(design.robot, load_rule=rule, load_fractions=None))
    return design.build()
