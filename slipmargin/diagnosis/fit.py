"""Fit the parameters of candidates by simulation: bounded, damped Gauss–Newton.

The residual of a trial is whitened and freed of its unknown start pose before it gets here; the
Jacobian is a forward difference, to first order from one simulation where parameters act by forces alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Protocol, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.near import Way
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect

#: Forward-difference step in units of a parameter's scale: large against the integrator's error.
STEP = 0.05
#: At most so many steps: the edges of a patch of floor, which a run feels or not, took up to thirty.
_ITERATIONS = 30
ENOUGH = 1e-4  #: relative decrease of the cost at which a fit has converged
_FAIR = 2  #: steps that a fit is given before it may be given up …
_USUAL = 12  #: … and within which most fits converge: by then it must be in reach of what it is to beat
#: Damping of the next step [1] from which on the last one counts as cut short: it had as much, or ten times
#: as much where it went downhill at once, and 1 halves a step.
_SHORTENED = 0.1
#: A Jacobian is carried along a step whose residual it foretold to this share of what the step changed [1];
#: after a longer bend it is simulated anew.
_FORETOLD = 0.3


class Residuals(Protocol):
    """What the fit needs of a problem."""

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """For each set of effects, its residual on its trials: (R_k, K), zero where nothing was seen."""
        ...

    def near(self, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index) -> list[Array]:
        """The residual (R, K) a step on each of several ways from ``effects``: to first order if faster."""
        ...

    def rough(self) -> Residuals:
        """The same for differences between sets of effects: faster where that is possible, else itself."""
        ...


#: Step of a derivative of what follows from parameters, in their scales [1].
_SMALL = 1e-3


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

    @property
    def said(self) -> str:
        """What it explains the data by, as a reader calls it."""
        return " + ".join(c.label for c in self.structure) or "the model as believed"

    def slope(self, values: Callable[[Array], Array]) -> Array:
        """(P, Q) derivative of ``values(x)`` (Q,) by its parameters, from small steps inside their range."""
        steps, here = steps_inside(self.structure, self.x, _SMALL), values(self.x)
        return np.array([(values(self.x + d) - here) / d.sum() for d in np.diag(steps)])

    def at_bound(self) -> list[str]:
        """Parameters that ended on the edge of what makes sense, where that is not their ordinary value.

        Each is ``label.key``: two candidates may have one name, such as an effect of each of two wheels.
        """
        keys = [f"{c.label}.{key}" for c in self.structure for key in c.keys]
        return [key for key, at in zip(keys, self._at_bound(), strict=True) if at]

    @property
    def stuck(self) -> bool:
        """Whether one is of an effect that acts: where another has made it idle, it may end anywhere."""
        at_bound, own = self._at_bound(), zip(self.structure, spans(self.structure), strict=True)
        return any(at_bound[span].any() and not self._idles(c, span) for c, span in own)

    def _at_bound(self) -> NDArray[np.bool_]:
        low, high, scale = limits_of(self.structure)
        usual = np.concatenate([np.zeros(0), *(c.usual for c in self.structure if c.usual is not None)])
        least = np.concatenate([np.zeros(0), *(c.least for c in self.structure if c.least is not None)])
        off = np.abs(self.x - usual)
        stuck = (self.x <= low + 1e-6 * scale) | (self.x >= high - 1e-6 * scale) | (off < least)
        return np.asarray(stuck & (off > 0.0))

    def _idles(self, own: Candidate, span: slice) -> bool:
        """Whether an effect changes the residual, to first order, by no more than noise gives it to do."""
        away = np.where(own.idle, 0.0, self.x[span] - own.null)
        change = self.jacobian[..., span] @ away
        return own.nested and bool(np.sum(change**2) <= own.size * misfit_of(self.residual))


def build(structure: Sequence[Candidate], x: Array) -> tuple[AnyEffect, ...]:
    """The effects of a structure at parameters ``x``."""
    return tuple(c.build(x[span]) for c, span in zip(structure, spans(structure), strict=True))


def spans(structure: Sequence[Candidate]) -> list[slice]:
    """Where the parameters of each candidate stand among those of the structure."""
    return [slice(*ends) for ends in pairwise(np.cumsum([0, *(c.size for c in structure)]).tolist())]


def limits_of(structure: Sequence[Candidate]) -> tuple[Array, Array, Array]:
    """Lower and upper bounds and scales (P,) of a structure's parameters."""
    if not structure:
        return np.zeros(0), np.zeros(0), np.ones(0)
    return (
        np.concatenate([c.low for c in structure]),
        np.concatenate([c.high for c in structure]),
        np.concatenate([c.scale for c in structure]),
    )


def steps_inside(structure: Sequence[Candidate], x: Array, size: float) -> Array:
    """Steps (P,) of ``size`` scales for difference quotients at ``x``: down where up is out of range."""
    _, high, scale = limits_of(structure)
    return np.asarray(np.where(x + size * scale <= high, size, -size) * scale)


def misfit_of(residual: Array) -> float:
    """Mean square [1] of a residual over the noise, 1 at least: what a parameter takes off by chance."""
    return max(1.0, float(np.sum(residual**2)) / max(1, int(np.count_nonzero(residual))))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GaussianPrior:
    """A Gaussian prior on a structure's parameters: precision (P, P) per scale², mean ``null`` (P,).

    It has the weight of one sample of the present misfit, so it only matters for parameters that the
    trials do not constrain.
    """

    precision: Array
    null: Array

    @staticmethod
    def of(structure: Sequence[Candidate], residual: Array) -> GaussianPrior:
        """The prior of a structure's parameters where ``residual`` (R, K) is left."""
        size = sum(c.size for c in structure)
        precision = np.zeros((size, size))
        for candidate, span in zip(structure, spans(structure), strict=True):
            precision[span, span] = candidate.prior.T @ candidate.prior
        return GaussianPrior(
            precision=misfit_of(residual) * precision,
            null=np.concatenate([np.zeros(0), *(c.null for c in structure)]),
        )

    def cost(self, x: Array, scale: Array) -> float:
        """Minus twice its log density at ``x``, up to a constant."""
        z = (x - self.null) / scale
        return float(z @ self.precision @ z)


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
    expired: Callable[[], bool] = lambda: False,
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
        Stop where the cost would stay above this even if every step that fits usually take were as good as
        the last.
    expired : callable
        Whether to stop after the step that was made.

    Returns
    -------
    Fit
    """
    x, residual, jacobian, spent = _descended(
        problem, structure, start, trials, iterations, give_up_above, expired
    )
    if jacobian is None:
        residual, jacobian = _linearise(problem, structure, x, trials, residual)
        spent += len(x)
    return Fit(
        structure=structure, x=x, trials=trials, residual=residual, jacobian=jacobian, evaluations=spent
    )


def few_steps(
    problem: Residuals,
    structure: tuple[Candidate, ...],
    start: Array,
    trials: Index,
    expired: Callable[[], bool] = lambda: False,
) -> tuple[Array, float]:
    """Where the first steps of a fit lead (P,), and the cost there."""
    x, residual, _, _ = _descended(problem, structure, start, trials, SETTINGS.first_steps, np.inf, expired)
    return x, float(np.sum(residual**2))


def _descended(
    problem: Residuals,
    structure: tuple[Candidate, ...],
    start: Array,
    trials: Index,
    iterations: int,
    give_up_above: float,
    expired: Callable[[], bool],
) -> tuple[Array, Array, Array | None, int]:
    """Where steps lead: x (P,), residual, simulations; the Jacobian there, None where it is not known.

    The Jacobian is carried along steps that it foretells (C. G. Broyden, Mathematics of Computation 19(92),
    1965), for each simulation costs as much as the step itself; but the last step follows a simulated one.
    """
    low, high, scale = limits_of(structure)
    x = np.clip(start, low, high)
    residual, first = _linearise(problem, structure, x, trials)
    prior = GaussianPrior.of(structure, residual)
    jacobian: Array | None = first
    spent, damping, simulated = 1 + len(x), 1e-3, True
    for step in range(iterations if len(x) else 0):
        if jacobian is None:
            jacobian, simulated = _linearise(problem, structure, x, trials, residual)[1], True
            spent += len(x)
        better = _improve(problem, structure, x, residual, jacobian, damping, trials, prior, simulated)
        if better is None and simulated:
            return x, residual, jacobian, spent
        if better is None:
            jacobian = None
            continue
        there, new, damping, tried = better
        cost, left = float(np.sum(residual**2)), float(np.sum(new**2))
        carried, straight = _carried(jacobian, (there - x) / scale, scale, residual, new)
        x, residual, spent = there, new, spent + tried
        told = step >= _FAIR and damping < _SHORTENED  # a shortened step says little about what others bring
        given_up = told and cost * (left / cost) ** max(1, _USUAL - step) > give_up_above
        converged = cost - left < ENOUGH * cost
        if given_up or (converged and simulated) or expired():
            return x, residual, carried, spent
        jacobian, simulated = (carried if straight and not converged else None), False
    return x, residual, None, spent


def _carried(jacobian: Array, step: Array, scale: Array, residual: Array, new: Array) -> tuple[Array, bool]:
    """The Jacobian after a ``step`` (P,) [scales] to a ``new`` residual, and whether it had foretold that."""
    told = (jacobian * scale) @ step
    missed = new - residual - told
    straight = float(np.sum(missed**2)) <= _FORETOLD**2 * float(np.sum(told**2))
    return jacobian + missed[..., None] * (step / (step @ step) / scale), straight


def stepped(x: Array, limits: tuple[Array, Array, Array], normal: Array, gradient: Array) -> Array:
    """Where a Gauss–Newton step from ``x`` (P,) leads within the ``limits``: bounds, and units of the step.

    A parameter on a bound that the way downhill leads beyond stays; one that the step would take beyond a
    bound ends on it, and the others take the step that suits this.
    """
    low, high, scale = limits
    free = ~(((x <= low) & (gradient > 0)) | ((x >= high) & (gradient < 0)))
    step = np.zeros(len(x))
    while free.any():
        pull = gradient[free] + normal[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.lstsq(normal[np.ix_(free, free)], -pull, rcond=None)[0]
        there = np.clip(x + step * scale, low, high)
        beyond = free & (there != x + step * scale)
        if not beyond.any():
            break
        step[beyond] = ((there - x) / scale)[beyond]
        free &= ~beyond
    return np.asarray(np.clip(x + step * scale, low, high))


#: Dampings tried when the first step goes uphill, as multiples of the current one.
_LADDER = (1e1, 1e2, 1e3, 1e4, 1e6)


def _improve(
    problem: Residuals,
    structure: tuple[Candidate, ...],
    x: Array,
    residual: Array,
    jacobian: Array,
    damping: float,
    trials: Index,
    prior: GaussianPrior,
    persist: bool,
) -> tuple[Array, Array, float, int] | None:
    """A damped step downhill: new point, its residual, next damping, simulations; None where none is.

    Only those who ``persist`` try shorter steps where the first one goes uphill.
    """
    limits = limits_of(structure)
    scale = limits[-1]
    flat = jacobian.reshape(-1, len(x)) * scale
    normal = flat.T @ flat + prior.precision
    gradient = flat.T @ residual.ravel() + prior.precision @ ((x - prior.null) / scale)
    cost = float(np.sum(residual**2)) + prior.cost(x, scale)

    def point(factor: float) -> Array:
        lift = np.diag(damping * factor * (np.diag(normal) + 1e-9 * np.trace(normal) + 1e-12))
        return stepped(x, limits, normal + lift, gradient)

    first = point(1.0)
    if np.array_equal(first, x):
        return None
    found = problem.residuals([build(structure, first)], [trials])[0]
    if float(np.sum(found**2)) + prior.cost(first, scale) < cost:
        return first, found, max(damping / 10.0, 1e-6), 1
    if not persist:
        return None
    points = [point(factor) for factor in _LADDER]
    ladder = problem.residuals([build(structure, p) for p in points], [trials] * len(points))
    costs = [float(np.sum(r**2)) + prior.cost(p, scale) for r, p in zip(ladder, points, strict=True)]
    best = int(np.argmin(costs))
    if not costs[best] < cost:
        return None
    return points[best], ladder[best], damping * _LADDER[best], 1 + len(points)


def _linearise(
    problem: Residuals, structure: tuple[Candidate, ...], x: Array, trials: Index, known: Array | None = None
) -> tuple[Array, Array]:
    """Residual (R, K), simulated unless ``known``, and its Jacobian (R, K, P)."""
    steps = steps_inside(structure, x, STEP)
    if not len(x):
        base = problem.residuals([build(structure, x)], [trials])[0] if known is None else known
        return base, np.zeros((*base.shape, 0))
    rough, effects = problem.rough(), build(structure, x)
    if known is None:
        known = problem.residuals([effects], [trials])[0]
    here = known if rough is problem else rough.residuals([effects], [trials])[0]

    def way(along: Array) -> Way:
        return lambda part: build(structure, x + part * along)

    found = rough.near(effects, [way(along) for along in np.diag(steps)], trials)
    jacobian = np.stack([(r - here) / step for r, step in zip(found, steps, strict=True)], axis=-1)
    return known, jacobian


def shifted_by(other: Residuals, found: Fit) -> Array:
    """How far (P,) the parameters move, by one Gauss–Newton step in bounds, if ``other`` is right."""
    limits = limits_of(found.structure)
    residual = other.residuals([found.effects], [found.trials])[0]
    flat = found.jacobian.reshape(-1, len(found.x)) * limits[-1]
    gradient = flat.T @ (residual - found.residual).ravel()
    return stepped(found.x, limits, flat.T @ flat, gradient) - found.x
