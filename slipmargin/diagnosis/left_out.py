"""Parameters fitted without some of the runs, from a fit to all of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.fit import ENOUGH, Fit, GaussianPrior, Residuals, build, limits_of, stepped
from slipmargin.diagnosis.settings import SETTINGS

#: Share of a step that is tried where the whole of it goes uphill.
_HALF = 0.3


def folds(runs: Sequence[int], count: int) -> list[Index]:
    """Trials in ``count`` folds of whole runs, every fold spread over the order of the runs.

    ``runs`` is the run that each trial is, or is cut from; there are as many folds as runs at most.
    """
    different = np.unique(runs)
    place = {int(run): i % min(count, len(different)) for i, run in enumerate(different)}
    fold = np.array([place[int(run)] for run in runs])
    return [np.flatnonzero(fold == i).astype(np.int64) for i in range(min(count, len(different)))]


def refitted_without(problem: Residuals, found: Fit, parts: Sequence[Index]) -> tuple[Array, Array]:
    """Parameters (F, P) refitted without each fold, and each trial's sum of squares (R,) with its own.

    Gauss–Newton steps with the Jacobian of the fit to all trials, which the folds' optima are near to; the
    residual is simulated at every step, and a step that does not lower the others' cost is shortened, then
    refused.  A fold whose cost hardly falls any more is done.
    """
    inside = np.asarray(np.sum(found.residual**2, axis=1))
    count = len(parts)
    xs = np.tile(np.asarray(found.x, dtype=float), (count, 1))
    if not len(found.x) or count < 2:
        return xs, inside
    limits = low, high, scale = limits_of(found.structure)
    scaled = found.jacobian * scale
    normals = np.einsum("rkp,rkq->rpq", scaled, scaled)
    prior = GaussianPrior.of(found.structure, found.residual)
    kept = [np.delete(np.arange(len(found.trials)), part) for part in parts]
    lifted = []
    for rows in kept:
        normal = normals[rows].sum(axis=0) + prior.precision
        lifted.append(normal + 1e-8 * (np.trace(normal) + 1e-12) * np.eye(len(found.x)))

    def cost(residual: Array, rows: Index, x: Array) -> float:
        return float(np.sum(residual[rows] ** 2)) + prior.cost(x, scale)

    residuals = [found.residual] * count
    costs = [cost(r, rows, x) for r, rows, x in zip(residuals, kept, xs, strict=True)]
    length, going = np.ones(count), np.ones(count, dtype=bool)
    for _ in range(SETTINGS.fold_steps):
        tried = xs.copy()
        for i in np.flatnonzero(going).tolist():
            rows = kept[i]
            gradient = np.einsum("rkp,rk->p", scaled[rows], residuals[i][rows])
            gradient += prior.precision @ ((xs[i] - prior.null) / scale)
            whole = stepped(xs[i], limits, lifted[i], gradient)
            tried[i] = whole if length[i] == 1.0 else np.clip(xs[i] + length[i] * (whole - xs[i]), low, high)
        moved = np.flatnonzero(np.any(np.abs(tried - xs) > 1e-4 * scale, axis=1))
        if not len(moved):
            break
        new = problem.residuals(
            [build(found.structure, tried[i]) for i in moved], [found.trials] * len(moved)
        )
        for i, residual in zip(moved.tolist(), new, strict=True):
            after = cost(residual, kept[i], tried[i])
            if after < costs[i]:
                going[i] = costs[i] - after >= ENOUGH * costs[i]
                xs[i], residuals[i], costs[i] = tried[i], residual, after
            else:
                length[i] *= _HALF
    out = inside.copy()
    for part, residual in zip(parts, residuals, strict=True):
        out[part] = np.sum(residual[part] ** 2, axis=1)
    return xs, out


def leave_one_out(found: Fit) -> Array:
    """Parameters (R, P) fitted without each trial: one Gauss–Newton step −H₋ᵢ⁻¹ g₋ᵢ, for their spread."""
    limits = limits_of(found.structure)
    scale = limits[-1]
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
        rows.append(stepped(found.x, limits, normal + ridge, gradient))
    return np.array(rows)
