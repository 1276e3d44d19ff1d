"""Screening: how much of the residual of left-out runs every candidate takes off, by its tangent alone.

The model is simulated once beside each parameter of each candidate, and at starts of named ones, because
friction that sticks hides small changes.  The rest is linear and cannot diverge: for every candidate the
step that suits all runs but a fold is applied to the fold; what the squared residual falls by is its gain.
Named effects, general forms, pairs of named effects and what no fit can vary
(:mod:`~slipmargin.diagnosis.probes`) stand in one list.  It orders the candidates and tells which variables
the residual follows.  It is tested as a whole: surrogate residuals, whose blocks change their sign at random,
go through all of it, and the largest gain of any candidate from them is what chance gives.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, Residuals, misfit_of
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.tangents import Columns, secants, tangents


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Screened:
    """One entry of the list: one candidate, or two named ones, at their best start.

    ``gain`` is what the sum of squares of left-out runs falls by, ``promise`` what a fit may be worth
    (:mod:`~slipmargin.diagnosis.promise`; the gain by default), ``step`` the step that suits all runs;
    ``starts`` are the parameters (P,) after that step, and after those from a candidate's next best places
    or times.  ``by_run`` (R,) is what the logarithm of each run's chi falls by, left out.
    """

    parts: tuple[Columns, ...]
    gain: float
    step: Array
    starts: tuple[Array, ...] = ()
    by_run: Array = field(default_factory=lambda: np.zeros(0))
    promise: float = -np.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "promise", max(self.promise, self.gain))

    @property
    def structure(self) -> tuple[Candidate, ...]:
        """The candidates to add; empty for a probe."""
        return tuple(c.candidate for c in self.parts if c.candidate is not None)

    @property
    def stands_alone(self) -> bool:
        """Whether it is one candidate, not a pair, and no probe."""
        return len(self.structure) == len(self.parts) == 1

    @property
    def named(self) -> bool:
        """Whether all of it has names."""
        return bool(self.structure) and all(c.named for c in self.structure)

    @property
    def label(self) -> str:
        """Its candidates' labels."""
        return " + ".join(c.label for c in self.parts)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Screening:
    """The list, best first; the sum of squares that gains are part of; the best gains (S,) of surrogates."""

    entries: tuple[Screened, ...]
    total: float
    chance: Array

    def share(self, entry: Screened) -> float:
        """Share of the sum of squares that an entry takes off."""
        return entry.gain / max(self.total, 1e-300)

    def with_better(self, found: Sequence[Screened]) -> Screening:
        """The list in which an entry that promises more by what was ``found`` for it starts there first."""
        better = {e.label: e for e in found}
        entries = (
            replace(e, promise=new.promise, starts=(new.starts[0], *e.starts))
            if (new := better.get(e.label)) is not None and new.promise > e.promise
            else e
            for e in self.entries
        )
        return replace(self, entries=tuple(entries))

    def p_value(self, share: float) -> float:
        """Probability that noise alone gives the best of the whole list this share of the sum of squares."""
        beaten = int(np.sum(self.chance >= share * self.total))
        return (1 + beaten) / (1 + len(self.chance))


def screen(
    problem: Residuals,
    base: Fit,
    candidates: Sequence[Candidate],
    probes: Sequence[Columns],
    parts: Sequence[Index],
    block: int,
    seed: int,
    overdue: Callable[[], bool] = lambda: False,
) -> Screening:
    """The list for what ``base`` leaves.

    Parameters
    ----------
    problem : Residuals
        Gives residuals of effects.
    base : Fit
        What is known already, on its trials.
    candidates : sequence of Candidate
        What may be added.
    probes : sequence of Columns
        What no fit can vary, on the same trials.
    parts : sequence of arrays of int
        The folds: numbers of trials of ``base``.
    block : int
        Samples whose sign surrogates change together.
    seed : int
        Draws the surrogates.
    overdue : callable
        Whether the list is to be ended with the candidates that it has.
    """
    rough = problem.rough()
    here = base.residual
    if rough is not problem:
        here = rough.residuals([base.effects], [base.trials])[0]
    groups = [
        *tangents(rough, base, here, candidates, overdue),
        *secants(rough, base, here, candidates, overdue),
        *probes,
    ]
    if not groups:
        return Screening(entries=(), total=base.cost, chance=np.zeros(0))
    columns = _beside(base, np.concatenate([g.columns for g in groups], axis=2))
    pull_of_runs = np.einsum("rk,rkm->rm", base.residual, columns)
    squares = np.sum(base.residual**2, axis=1)
    pulls = _pulls(base.residual, columns, parts, block, seed)
    place = np.cumsum([0, *(g.columns.shape[2] for g in groups)])
    misfit = misfit_of(base.residual)
    found: list[tuple[tuple[Columns, ...], Array, Array, Array]] = []

    def rows_of(numbers: Sequence[int]) -> Index:
        return np.concatenate([np.arange(place[n], place[n + 1]) for n in numbers])

    def add(numbers: Sequence[int], of_runs: Array) -> None:
        own, rows = tuple(groups[n] for n in numbers), rows_of(numbers)
        gram = np.array([of_runs[part].sum(axis=0) for part in parts])
        gains, step, steps = _left_out(own, gram, pulls[:, :, rows], misfit)
        logs = np.zeros(len(squares))
        for part, one in zip(parts, steps, strict=True):
            left = squares[part] + 2.0 * pull_of_runs[np.ix_(part, rows)] @ one
            left += (of_runs[part] @ one) @ one
            logs[part] = 0.5 * np.log(
                (squares[part] + 1e-12) / np.maximum(left, 1e-6 * squares[part] + 1e-12)
            )
        found.append((own, gains, step, logs))

    for number in range(len(groups)):
        add([number], _products(columns[:, :, place[number] : place[number + 1]]))
    ordered = _starts_of_each(found)
    singles = [numbers[0] for numbers in ordered]
    names = sorted((n for n in singles if groups[n].named), key=lambda n: -float(found[n][1][0]))
    of_names = rows_of(names) if names else np.zeros(0, dtype=np.int64)
    among = np.zeros(columns.shape[2], dtype=np.int64)
    among[of_names] = np.arange(len(of_names))
    products = _products(columns[:, :, of_names])
    for pair in combinations(names, 2):  # first what takes off more alone
        if _can_be_two(*(groups[n] for n in pair)):
            own = among[rows_of(pair)]
            add(pair, products[:, own[:, None], own])
    kept = [*ordered, *([n] for n in range(len(groups), len(found)))]
    most = np.array([gains[1:] for _, gains, _, _ in found]).max(axis=0)
    entries = [
        Screened(
            parts=found[numbers[0]][0],
            gain=float(found[numbers[0]][1][0]),
            step=found[numbers[0]][2],
            starts=tuple(_start(found[n][0], found[n][2]) for n in numbers[: 2 * SETTINGS.starts]),
            by_run=found[numbers[0]][3],
        )
        for numbers in kept
    ]
    best_first = tuple(sorted(entries, key=lambda e: -e.gain))
    return Screening(entries=best_first, total=base.cost, chance=most)


def _beside(base: Fit, columns: Array) -> Array:
    """Columns less what the parameters of ``base`` could take up."""
    if not len(base.x):
        return columns
    flat = columns.reshape(-1, columns.shape[2])
    own = base.jacobian.reshape(-1, len(base.x))
    keep = np.linalg.qr(own / np.maximum(np.linalg.norm(own, axis=0), 1e-300))[0]
    return np.asarray((flat - keep @ (keep.T @ flat)).reshape(columns.shape))


def _products(columns: Array) -> Array:
    """Products (R, M, M) of columns (R, K, M) with one another, run by run."""
    return np.asarray(columns.transpose(0, 2, 1) @ columns)


def _pulls(residual: Array, columns: Array, parts: Sequence[Index], block: int, seed: int) -> Array:
    """Products (1 + S, F, M) of columns and residual in each fold: as it is, then of surrogates."""
    length, many = columns.shape[1:]
    samples = length // 3
    edges = np.arange(0, samples, max(1, block))
    random = np.random.default_rng(seed)
    out = np.zeros((1 + SETTINGS.surrogates, len(parts), many))
    for number, part in enumerate(parts):
        for run in part:
            product = (residual[run][:, None] * columns[run]).reshape(3, samples, many)
            blocks = np.add.reduceat(product, edges, axis=1).reshape(-1, many)
            signs = np.vstack(
                [np.ones(len(blocks)), random.choice([-1.0, 1.0], size=(SETTINGS.surrogates, len(blocks)))]
            )
            out[:, number] += signs @ blocks
    return out


def _left_out(
    own: tuple[Columns, ...], gram: Array, pulls: Array, misfit: float
) -> tuple[Array, Array, Array]:
    """Gain (1 + S,) on folds left out, the step (M,) that suits all runs, those (F, M) without each.

    Free coefficients are held back by the ridge that gains most on the folds left out, surrogates' by the
    one that suits them: many coefficients need one, and how strong it should be depends on what is there.
    """
    low, high = np.concatenate([c.low for c in own]), np.concatenate([c.high for c in own])
    prior = np.zeros(gram.shape[1:])
    at = 0
    for c in own:
        many = len(c.low)
        prior[at : at + many, at : at + many] = misfit * c.prior
        at += many
    whole = gram.sum(axis=0)
    others = whole - gram if len(gram) > 1 else gram  # one run alone: surrogates are fitted to it as it is
    lift = prior + np.diag(SETTINGS.ridge * np.diag(whole) + 1e-12 * np.trace(whole) + 1e-12)
    by_fold = pulls.transpose(1, 2, 0)  # (F, M, 1 + S): all folds and surrogates in one call
    all_pulls = by_fold.sum(axis=0)
    of_others = all_pulls - by_fold if len(gram) > 1 else by_fold
    free = len(own) == 1 and not own[0].named and len(low) > 1
    best: tuple[Array, Array, Array] | None = None
    for ridge in (0.0, *(SETTINGS.ridges if free else ())):
        held = lift + ridge * np.trace(whole) / len(low) * np.eye(len(low))
        steps = np.linalg.solve(others + held, -of_others)
        steps = np.minimum(np.maximum(steps, low[:, None]), high[:, None])
        gains = -np.sum(steps * (2.0 * by_fold + gram @ steps), axis=(0, 1))
        if best is None or gains[0] > best[0][0]:
            step = np.clip(-np.linalg.solve(whole + held, all_pulls[:, 0]), low, high)
            most = gains if best is None else np.maximum(gains, best[0])
            best = most, step, steps[:, :, 0]
        else:
            best = np.maximum(gains, best[0]), best[1], best[2]
    assert best is not None
    return best


def _starts_of_each(found: Sequence[tuple[tuple[Columns, ...], Array, Array, Array]]) -> list[list[int]]:
    """Numbers of the starts of each candidate, best first."""
    numbers: dict[str, list[int]] = {}
    for number, (own, _, _, _) in enumerate(found):
        numbers.setdefault(own[0].label, []).append(number)
    return [sorted(of_one, key=lambda n: -float(found[n][1][0])) for of_one in numbers.values()]


def _start(own: tuple[Columns, ...], step: Array) -> Array:
    """Where a fit of candidates starts: after their step."""
    ends = np.cumsum([len(c.low) for c in own])[:-1]
    steps = zip(own, np.split(step, ends), strict=True)
    return np.concatenate([np.zeros(0), *(c.start(part) for c, part in steps if c.candidate is not None)])


def _can_be_two(one: Columns, two: Columns) -> bool:
    """Whether two named effects may be missing together: not two forms of one on the same wheels."""
    assert one.candidate is not None and two.candidate is not None
    same = one.candidate.name == two.candidate.name
    return not same or one.candidate.wheels != two.candidate.wheels
