"""Leave-one-out predictions: each trial predicted with parameters fitted to the others."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import Fit, GaussianPrior, Residuals, build, limits_of

#: Above this chi a step may be too long for its tangent: damped ones, and none at all, are tried too.
_BENT = 1.5
_DAMPED = (0.1, 10.0)


def leave_one_out(found: Fit, damping: float = 0.0) -> Array:
    """Parameters (R, P) fitted without each trial: one Gauss–Newton step −H₋ᵢ⁻¹ g₋ᵢ, damped if asked."""
    low, high, scale = limits_of(found.structure)
    scaled = found.jacobian * scale
    normals = np.einsum("rkp,rkq->rpq", scaled, scaled)
    gradients = np.einsum("rkp,rk->rp", scaled, found.residual)
    prior = GaussianPrior.of(found.structure, found.residual)
    pulled = prior.precision @ ((found.x - prior.null) / scale)
    rows = []
    for own_normal, own_gradient in zip(normals, gradients, strict=True):
        normal = normals.sum(axis=0) - own_normal + prior.precision
        gradient = gradients.sum(axis=0) - own_gradient + pulled
        ridge = 1e-8 * (np.trace(normal) + 1e-12) * np.eye(len(found.x))
        ridge += damping * np.diag(np.diag(normal))
        step = np.linalg.lstsq(normal + ridge, -gradient, rcond=None)[0]
        rows.append(np.clip(found.x + step * scale, low, high))
    return np.array(rows)


def cross_validate(problem: Residuals, found: Fit) -> Array:
    """Sum of squares (R,) of each trial, simulated with parameters that have not seen it."""
    count = len(found.trials)
    inside = np.asarray(np.sum(found.residual**2, axis=1))
    if not len(found.x) or count < 2:
        return inside
    xs = leave_one_out(found)
    if found.cost > _BENT**2 * np.count_nonzero(found.residual):
        xs = best_left_out(problem, found, [xs, *(leave_one_out(found, d) for d in _DAMPED)])
    return each_by_its_own(problem, found, xs)


def each_by_its_own(problem: Residuals, found: Fit, xs: Array) -> Array:
    """Sum of squares (R,) of each trial of a fit, simulated with parameters of its own (R, P)."""
    effects = [build(found.structure, x) for x in xs]
    out = problem.residuals(effects, [found.trials[i : i + 1] for i in range(len(xs))])
    return np.array([float(np.sum(r**2)) for r in out])


def best_left_out(problem: Residuals, found: Fit, tried: list[Array]) -> Array:
    """Of the parameters tried without each trial, those (R, P) that suit the other trials best."""
    count = len(found.trials)
    others = [np.delete(found.trials, i) for i in range(count)]
    inside = np.sum(found.residual**2, axis=1)
    best, cost = np.tile(found.x, (count, 1)), inside.sum() - inside
    for xs in tried:
        out = problem.residuals([build(found.structure, x) for x in xs], others)
        costs = np.array([float(np.sum(r**2)) for r in out])
        better = costs < cost
        best[better], cost = xs[better], np.where(better, costs, cost)
    return best
