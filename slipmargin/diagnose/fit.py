"""Fit the parameters of suspected effects by simulation: bounded, damped Gauss–Newton.

The residual of a trial is whitened and freed of its unknown start pose before it gets here; the
Jacobian is a forward difference over whole simulations, all of them in one parallel batch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnose.candidate import Candidate
from slipmargin.effects import AnyEffect

#: Forward-difference step in units of a parameter's scale: large against the integrator's error.
_STEP = 0.05
_ITERATIONS = 12
_ENOUGH = 1e-4  #: relative decrease of the cost at which a fit has converged


class Residuals(Protocol):
    """What the fit needs of a problem."""

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """For each set of effects, its residual on its trials: (R_k, K), zero where nothing was seen."""
        ...


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fit:
    """A structure with its best parameters.

    ``x`` (P,), ``residual`` (R, K), ``jacobian`` (R, K, P) on ``trials`` (R,); ``cost`` is the sum
    of squares.
    """

    structure: tuple[Candidate, ...]
    x: Array
    trials: Index
    residual: Array
    jacobian: Array
    evaluations: int

    @property
    def cost(self) -> float:
        """Sum of squares over all trials."""
        return float(np.sum(self.residual**2))

    @property
    def effects(self) -> tuple[AnyEffect, ...]:
        """The fitted effects."""
        return build(self.structure, self.x)

    def at_bound(self) -> list[str]:
        """Parameters that ended on the edge of their range."""
        low, high, scale = _limits(self.structure)
        keys = [f"{c.name}.{key}" for c in self.structure for key in c.keys]
        null = np.concatenate([c.null for c in self.structure]) if self.structure else np.zeros(0)
        stuck = ((self.x <= low + 1e-6 * scale) | (self.x >= high - 1e-6 * scale)) & (self.x != null)
        return [key for key, at in zip(keys, stuck, strict=True) if at]


def build(structure: Sequence[Candidate], x: Array) -> tuple[AnyEffect, ...]:
    """The effects of a structure at parameters ``x``."""
    made: list[AnyEffect] = []
    at = 0
    for candidate in structure:
        made.append(candidate.build(x[at : at + candidate.size]))
        at += candidate.size
    return tuple(made)


def _limits(structure: Sequence[Candidate]) -> tuple[Array, Array, Array]:
    if not structure:
        return np.zeros(0), np.zeros(0), np.ones(0)
    return (
        np.concatenate([c.low for c in structure]),
        np.concatenate([c.high for c in structure]),
        np.concatenate([c.scale for c in structure]),
    )


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Belief:
    """What is believed of the parameters before any trial: ``pull`` (P, P) towards ``null`` (P,).

    It weighs as much as one sample of the misfit at hand, so that it decides nothing that trials show.
    """

    pull: Array
    null: Array

    @staticmethod
    def of(structure: Sequence[Candidate], residual: Array) -> _Belief:
        size = sum(c.size for c in structure)
        pull = np.zeros((size, size))
        at = 0
        for candidate in structure:
            span = slice(at, at + candidate.size)
            pull[span, span] = candidate.prior.T @ candidate.prior
            at += candidate.size
        misfit = float(np.sum(residual**2) / max(1, int(np.count_nonzero(residual))))
        return _Belief(
            pull=max(1.0, misfit) * pull,
            null=np.concatenate([np.zeros(0), *(c.null for c in structure)]),
        )

    def cost(self, x: Array, scale: Array) -> float:
        """What departing from the belief costs."""
        z = (x - self.null) / scale
        return float(z @ self.pull @ z)


def evaluate(problem: Residuals, structure: tuple[Candidate, ...], x: Array, trials: Index) -> Fit:
    """Residual and Jacobian at ``x``, without moving it."""
    residual, jacobian = _linearise(problem, structure, x, trials)
    return Fit(
        structure=structure, x=x, trials=trials, residual=residual, jacobian=jacobian, evaluations=1 + len(x)
    )


def fit(
    problem: Residuals,
    structure: tuple[Candidate, ...],
    start: Array,
    trials: Index,
    iterations: int = _ITERATIONS,
    give_up_above: float = np.inf,
) -> Fit:
    """Least squares from one start.

    Parameters
    ----------
    problem : Residuals
        Gives residuals of effects.
    structure : tuple of Candidate
        What may be missing.
    start : array (P,)
        Where to begin.
    trials : array (R,) of int
        The trials to fit.
    iterations : int
        At most so many Gauss–Newton steps.
    give_up_above : float
        Stop after three steps if the cost is still above this.

    Returns
    -------
    Fit
    """
    low, high, _ = _limits(structure)
    x = np.clip(start, low, high)
    residual, jacobian = _linearise(problem, structure, x, trials)
    believed = _Belief.of(structure, residual)
    spent = 1 + len(x)
    damping = 1e-3
    for step in range(iterations if len(x) else 0):
        cost = float(np.sum(residual**2))
        if step >= 3 and cost > give_up_above:
            break
        better = _improve(problem, structure, x, residual, jacobian, damping, trials, believed)
        if better is None:
            break
        x, new, damping, tried = better
        spent += tried + len(x)
        moved = cost - float(np.sum(new**2))
        if moved < _ENOUGH * cost and step + 1 < iterations:
            iterations = step + 1  # converged: one last Jacobian where it stands
        residual, jacobian = _linearise(problem, structure, x, trials, new)
        if step + 1 >= iterations:
            break
    return Fit(
        structure=structure, x=x, trials=trials, residual=residual, jacobian=jacobian, evaluations=spent
    )


#: Dampings tried when the first step goes uphill, as multiples of the current one.
_LADDER = (1e2, 1e4, 1e6)


def _improve(
    problem: Residuals,
    structure: tuple[Candidate, ...],
    x: Array,
    residual: Array,
    jacobian: Array,
    damping: float,
    trials: Index,
    believed: _Belief,
) -> tuple[Array, Array, float, int] | None:
    """A damped step downhill: new point, its residual, next damping, simulations; None where none is."""
    low, high, scale = _limits(structure)
    flat = jacobian.reshape(-1, len(x)) * scale
    normal = flat.T @ flat + believed.pull
    gradient = flat.T @ residual.ravel() + believed.pull @ ((x - believed.null) / scale)
    free = ~(((x <= low) & (gradient > 0)) | ((x >= high) & (gradient < 0)))
    if not free.any():
        return None
    cost = float(np.sum(residual**2)) + believed.cost(x, scale)

    def point(factor: float) -> Array:
        lift = np.diag(damping * factor * (np.diag(normal)[free] + 1e-9 * np.trace(normal) + 1e-12))
        step = np.zeros(len(x))
        step[free] = np.linalg.lstsq(normal[np.ix_(free, free)] + lift, -gradient[free], rcond=None)[0]
        return np.asarray(np.clip(x + step * scale, low, high))

    first = point(1.0)
    found = problem.residuals([build(structure, first)], [trials])[0]
    if float(np.sum(found**2)) + believed.cost(first, scale) < cost:
        return first, found, max(damping / 10.0, 1e-6), 1
    points = [point(factor) for factor in _LADDER]
    ladder = problem.residuals([build(structure, p) for p in points], [trials] * len(points))
    costs = [float(np.sum(r**2)) + believed.cost(p, scale) for r, p in zip(ladder, points, strict=True)]
    best = int(np.argmin(costs))
    if not costs[best] < cost:
        return None
    return points[best], ladder[best], damping * _LADDER[best], 1 + len(points)


def _linearise(
    problem: Residuals, structure: tuple[Candidate, ...], x: Array, trials: Index, known: Array | None = None
) -> tuple[Array, Array]:
    """Residual (R, K), simulated unless ``known``, and forward-difference Jacobian (R, K, P)."""
    _, high, scale = _limits(structure)
    steps = np.where(x + _STEP * scale <= high, _STEP, -_STEP) * scale
    points = [x + step * unit for step, unit in zip(steps, np.eye(len(x)), strict=True)]
    if known is None:
        points = [x, *points]
    found = problem.residuals([build(structure, p) for p in points], [trials] * len(points)) if points else []
    base = found.pop(0) if known is None else known
    if not len(x):
        return base, np.zeros((*base.shape, 0))
    jacobian = np.stack([(r - base) / step for r, step in zip(found, steps, strict=True)], axis=-1)
    return base, jacobian


def leave_one_out(found: Fit, damping: float = 0.0) -> Array:
    """Parameters (R, P) fitted without each trial: one Gauss–Newton step −H₋ᵢ⁻¹ g₋ᵢ, damped if asked."""
    low, high, scale = _limits(found.structure)
    scaled = found.jacobian * scale
    normals = np.einsum("rkp,rkq->rpq", scaled, scaled)
    gradients = np.einsum("rkp,rk->rp", scaled, found.residual)
    believed = _Belief.of(found.structure, found.residual)
    pulled = believed.pull @ ((found.x - believed.null) / scale)
    rows = []
    for own_normal, own_gradient in zip(normals, gradients, strict=True):
        normal = normals.sum(axis=0) - own_normal + believed.pull
        gradient = gradients.sum(axis=0) - own_gradient + pulled
        ridge = 1e-8 * (np.trace(normal) + 1e-12) * np.eye(len(found.x))
        ridge += damping * np.diag(np.diag(normal))
        step = np.linalg.lstsq(normal + ridge, -gradient, rcond=None)[0]
        rows.append(np.clip(found.x + step * scale, low, high))
    return np.array(rows)


def shifted_by(other: Residuals, found: Fit) -> Array:
    """How far (P,) the parameters move, by one Gauss–Newton step, if ``other`` is the right problem."""
    _, _, scale = _limits(found.structure)
    residual = other.residuals([found.effects], [found.trials])[0]
    flat = found.jacobian.reshape(-1, len(found.x)) * scale
    step = np.linalg.lstsq(flat, -(residual - found.residual).ravel(), rcond=1e-10)[0]
    return np.asarray(step * scale)


def cross_validate(problem: Residuals, found: Fit) -> Array:
    """Sum of squares (R,) of each trial, simulated with parameters that have not seen it."""
    count = len(found.trials)
    inside = np.asarray(np.sum(found.residual**2, axis=1))
    if not len(found.x) or count < 2:
        return inside
    xs = leave_one_out(found)
    if found.cost > _BENT**2 * np.count_nonzero(found.residual):
        xs = best_left_out(problem, found, [xs, *(leave_one_out(found, d) for d in _DAMPED)])
    effects = [build(found.structure, x) for x in xs]
    out = problem.residuals(effects, [found.trials[i : i + 1] for i in range(count)])
    return np.array([float(np.sum(r**2)) for r in out])


#: Above this chi a step may be too long for its tangent: damped ones, and none at all, are tried too.
_BENT = 1.5
_DAMPED = (0.1, 10.0)


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


def tangents(problem: Residuals, base: Fit, suspects: Sequence[Candidate]) -> list[Array]:
    """Derivative (R, K, P) of the residual by each suspect's parameters at its null, beside ``base``.

    The part that ``base``'s own parameters could take up is removed.
    """
    points: list[tuple[AnyEffect, ...]] = []
    steps: list[float] = []
    for suspect in suspects:
        for at, unit in enumerate(np.eye(suspect.size)):
            step = _STEP * suspect.scale[at]
            step = step if suspect.null[at] + step <= suspect.high[at] else -step
            points.append((*base.effects, suspect.build(suspect.null + step * unit)))
            steps.append(step)
    found = problem.residuals(points, [base.trials] * len(points))
    columns = [(r - base.residual) / step for r, step in zip(found, steps, strict=True)]
    keep = np.zeros((base.residual.size, 0))
    if len(base.x):
        keep = np.linalg.qr(base.jacobian.reshape(-1, len(base.x)))[0]
    out = []
    at = 0
    for suspect in suspects:
        flat = np.stack([c.ravel() for c in columns[at : at + suspect.size]], axis=1)
        flat = flat - keep @ (keep.T @ flat)
        out.append(flat.reshape(*base.residual.shape, suspect.size))
        at += suspect.size
    return out
