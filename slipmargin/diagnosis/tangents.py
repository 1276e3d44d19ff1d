"""Tangents of candidates: how the residual changes with each parameter of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import compress
from typing import TypeVar, final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import STEP, Fit, Residuals, spans, steps_inside
from slipmargin.diagnosis.near import Way
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect, Trace

T = TypeVar("T")


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Columns:
    """The tangents of one candidate: ``columns`` (R, K, M), a column a unit of scale.

    Parameters
    ----------
    trace : Trace
        The variable it stands for.
    label : str
        That of the candidate.
    columns : array (R, K, M)
        How the residual changes.
    prior : array (M, M)
        Precision of the prior.
    low, high : array (M,)
        How far each column may be followed.
    candidate : Candidate, optional
        What a fit can vary; None for a probe.
    at : array (P,), optional
        Where the candidate stands.
    along : array (M, P), optional
        Which way each column moves its parameters; zero for the change from the present law to that at
        ``at``.
    """

    trace: Trace
    label: str
    columns: Array
    prior: Array
    low: Array
    high: Array
    candidate: Candidate | None = None
    at: Array | None = None
    along: Array | None = None

    @property
    def named(self) -> bool:
        """Whether it has a name."""
        return self.candidate is not None and self.candidate.named

    def start(self, step: Array) -> Array:
        """The candidate's parameters after a step (M,), where a fit may start."""
        assert self.candidate is not None and self.at is not None and self.along is not None
        return np.asarray(np.clip(self.at + step @ self.along, self.candidate.low, self.candidate.high))


def tangents(
    problem: Residuals,
    base: Fit,
    known: Array,
    candidates: Sequence[Candidate],
    overdue: Callable[[], bool],
) -> list[Columns]:
    """Columns of every candidate at each of its starts.

    ``known`` (R, K) is the residual of ``base`` in ``problem``.  Once it is ``overdue`` the rest is left out.
    What does nothing at its null is compared to first order; laws that take another's place are simulated.
    """

    def near(ways: Sequence[Way]) -> list[Array]:
        return problem.near(base.effects, ways, base.trials)

    def far(ways: Sequence[Way]) -> list[Array]:
        return problem.residuals([way(1.0) for way in ways], [base.trials] * len(ways))

    return [
        *_tangents(near, base, known, [c for c in candidates if c.nested], overdue),
        *_tangents(far, base, known, [c for c in candidates if not c.nested], overdue),
    ]


def _tangents(
    after: Callable[[Sequence[Way]], list[Array]],
    base: Fit,
    known: Array,
    candidates: Sequence[Candidate],
    overdue: Callable[[], bool],
) -> list[Columns]:
    """Columns of candidates, by the residuals ``after`` a step on several ways."""
    ways: list[Way] = []
    plans: list[tuple[Candidate, Array, list[tuple[int, float]]]] = []
    for candidate in candidates:
        for at in standpoints(candidate):
            columns: list[tuple[int, float]] = [] if candidate.nested else [(-1, 1.0)]
            steps = (steps_inside((candidate,), at, STEP) / candidate.scale).tolist()
            acts = ~candidate.idle | (not candidate.nested)
            columns += [(j, step) for j, step in enumerate(steps) if acts[j]]
            for j, step in columns:
                unit = np.arange(candidate.size) == j
                ways.append(from_null(base.effects, candidate, at, step * unit * candidate.scale))
            plans.append((candidate, at, columns))
    residuals = in_parts(after, ways, overdue)
    reached = np.cumsum([len(plan) for _, _, plan in plans]) <= len(residuals)
    found, out = iter(residuals), []
    for candidate, at, plan in compress(plans, reached):
        made, here = [], known
        for j, step in plan:
            residual = next(found)
            made.append((residual - here) / step)
            here = residual if j < 0 else here
        free = [j for j, _ in plan]
        low = [0.0 if j < 0 else (candidate.low[j] - at[j]) / candidate.scale[j] for j in free]
        high = [1.0 if j < 0 else (candidate.high[j] - at[j]) / candidate.scale[j] for j in free]
        prior = np.zeros((len(free), len(free)))
        inner = [k for k, j in enumerate(free) if j >= 0]
        rows = candidate.prior[:, [free[k] for k in inner]]
        prior[np.ix_(inner, inner)] = rows.T @ rows
        out.append(
            Columns(
                trace=candidate.trace,
                label=candidate.label,
                columns=np.stack(made, axis=2),
                prior=prior,
                low=np.array(low),
                high=np.array(high),
                candidate=candidate,
                at=at,
                along=np.array([np.eye(candidate.size)[j] * candidate.scale[j] * (j >= 0) for j in free]),
            )
        )
    return out


def secants(
    problem: Residuals,
    base: Fit,
    known: Array,
    candidates: Sequence[Candidate],
    overdue: Callable[[], bool],
) -> list[Columns]:
    """A column from each named candidate's null to each of its first starts: sticking hides small changes."""
    plans = [
        (c, np.where(c.idle, start, c.null), start)
        for c in candidates
        if c.named and c.nested
        for start in c.starts[: SETTINGS.secants]
    ]
    points = [(*base.effects, c.build(start)) for c, _, start in plans]
    found = simulated(problem, points, base.trials, overdue)
    return [
        Columns(
            trace=c.trace,
            label=c.label,
            columns=(residual - known)[:, :, None],
            prior=np.zeros((1, 1)),
            low=np.array([-1.0]),
            high=np.array([2.0]),
            candidate=c,
            at=at,
            along=(start - at)[None],
        )
        for (c, at, start), residual in zip(plans, found, strict=False)
    ]


#: What is compared in one go: its poses stay in the processor's memory.
_AT_ONCE = 24


def in_parts(
    compare: Callable[[Sequence[T]], list[Array]], points: Sequence[T], overdue: Callable[[], bool]
) -> list[Array]:
    """The residual of each of several points, of the first ones only once it is ``overdue``."""
    out: list[Array] = []
    for at in range(0, len(points), _AT_ONCE):
        if overdue():
            break
        out += compare(points[at : at + _AT_ONCE])
    return out


def simulated(
    problem: Residuals, points: Sequence[tuple[AnyEffect, ...]], trials: Index, overdue: Callable[[], bool]
) -> list[Array]:
    """The residual of each of several sets of effects, of the first ones only once it is ``overdue``."""
    return in_parts(lambda some: problem.residuals(some, [trials] * len(some)), points, overdue)


def standpoints(candidate: Candidate) -> list[Array]:
    """Where a candidate's tangents are taken: it does nothing there, its idle parameters at each start."""
    if not candidate.idle.any():
        return [np.array(candidate.null)]
    rows = [np.where(candidate.idle, start, candidate.null) for start in candidate.starts]
    return [rows[i] for i in sorted(np.unique(np.array(rows), axis=0, return_index=True)[1])]


def from_null(effects: tuple[AnyEffect, ...], candidate: Candidate, at: Array, step: Array) -> Way:
    """The way on which a candidate that does nothing ``at`` parameters (P,) moves beside some effects."""
    return lambda part: (*effects, candidate.build(at + part * step))


def free_slopes(problem: Residuals, base: Fit, candidates: Sequence[Candidate]) -> list[Array]:
    """Derivative (R, K, P) of the residual by each candidate's parameters at its null, beside ``base``.

    The part that ``base``'s own parameters could take up is removed.
    """
    nulls = np.concatenate([np.zeros(0), *(c.null for c in candidates)])
    steps = steps_inside(candidates, nulls, STEP)
    ways = [
        from_null(base.effects, candidate, candidate.null, along)
        for candidate, span in zip(candidates, spans(candidates), strict=True)
        for along in np.diag(steps[span])
    ]
    found = problem.near(base.effects, ways, base.trials)
    columns = [(r - base.residual) / step for r, step in zip(found, steps, strict=True)]
    keep = np.zeros((base.residual.size, 0))
    if len(base.x):
        keep = np.linalg.qr(base.jacobian.reshape(-1, len(base.x)))[0]
    out = []
    for span in spans(candidates):
        flat = np.stack([c.ravel() for c in columns[span]], axis=1)
        flat = flat - keep @ (keep.T @ flat)
        out.append(flat.reshape(*base.residual.shape, -1))
    return out


def score_test_gain(residual: Array, slope: Array) -> float:
    """Decrease of the sum of squares that a linear step along ``slope`` (R, K, P) promises."""
    flat = slope.reshape(-1, slope.shape[-1])
    size = np.linalg.norm(flat, axis=0)
    flat = flat[:, size > 0.0] / size[size > 0.0]
    if not flat.shape[1]:
        return 0.0
    step = np.linalg.lstsq(flat, residual.ravel(), rcond=1e-8)[0]
    return float(np.sum((flat @ step) ** 2))
