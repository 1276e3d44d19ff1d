"""What columns take off the residual of left-out runs, by linear algebra alone: each group, and pairs.

The step that suits all runs but a fold is applied to the fold: its gain is what the squared residual falls
by.  Surrogates, whose blocks change their sign at random, go through the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.fit import Fit, misfit_of
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.tangents import Columns


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gains:
    """What groups of columns, by their ``numbers``, together take off folds left out.

    ``gains`` (1 + S,) are what the sum of squares falls by, that of the residual and those of S surrogates;
    ``step`` (M,) suits all runs; ``by_run`` (R,) is what the logarithm of each run's chi falls by, left out.
    """

    numbers: tuple[int, ...]
    parts: tuple[Columns, ...]
    gains: Array
    step: Array
    by_run: Array

    @property
    def gain(self) -> float:
        """Of the residual."""
        return float(self.gains[0])


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GainTable:
    """The columns (R, K, M) of all groups beside what is known, and what scoring some of them needs.

    ``place`` says where each group's begin; ``pulls`` as of :func:`_pulls`; ``pull_of_runs`` (R, M) and
    ``squares`` (R,) are products of each run's residual with the columns and with itself.
    """

    groups: Sequence[Columns]
    parts: Sequence[Index]
    columns: Array
    place: Index
    pulls: Array
    pull_of_runs: Array
    squares: Array
    misfit: float

    @staticmethod
    def of(base: Fit, groups: Sequence[Columns], parts: Sequence[Index], block: int, seed: int) -> GainTable:
        """The table for what ``base`` leaves: folds, and how many samples of a surrogate have one sign."""
        columns = _beside(base, np.concatenate([g.columns for g in groups], axis=2))
        return GainTable(
            groups=groups,
            parts=parts,
            columns=columns,
            place=np.cumsum([0, *(g.columns.shape[2] for g in groups)]),
            pulls=_pulls(base.residual, columns, parts, block, seed),
            pull_of_runs=np.einsum("rk,rkm->rm", base.residual, columns),
            squares=np.sum(base.residual**2, axis=1),
            misfit=misfit_of(base.residual),
        )

    def alone(self) -> list[Gains]:
        """Each group by itself, in their order."""
        return [self._gains((n,), _products(self._of(n))) for n in range(len(self.groups))]

    def pairs(self, names: Sequence[Gains]) -> Iterator[Gains]:
        """Every two of some groups that may be missing together, in the order given."""
        numbers = [one.numbers[0] for one in names]
        if len(numbers) < 2:
            return
        products = _products(np.concatenate([self._of(n) for n in numbers], axis=2))
        ends = np.cumsum([0, *(self.groups[n].columns.shape[2] for n in numbers)])
        for one, two in combinations(range(len(numbers)), 2):
            if _can_be_two(self.groups[numbers[one]], self.groups[numbers[two]]):
                own = np.concatenate([np.arange(ends[k], ends[k + 1]) for k in (one, two)])
                yield self._gains((numbers[one], numbers[two]), products[:, own[:, None], own])

    def _of(self, number: int) -> Array:
        """The columns (R, K, M) of one group."""
        return self.columns[:, :, self.place[number] : self.place[number + 1]]

    def _gains(self, numbers: tuple[int, ...], products: Array) -> Gains:
        """Groups together, whose columns have these ``products`` (R, M, M) with one another."""
        own = tuple(self.groups[n] for n in numbers)
        rows = np.concatenate([np.arange(self.place[n], self.place[n + 1]) for n in numbers])
        gram = np.array([products[part].sum(axis=0) for part in self.parts])
        gains, step, steps = _left_out(own, gram, self.pulls[:, :, rows], self.misfit)
        by_run = np.zeros(len(self.squares))
        for part, one in zip(self.parts, steps, strict=True):
            left = self.squares[part] + 2.0 * self.pull_of_runs[np.ix_(part, rows)] @ one
            left += (products[part] @ one) @ one
            least = 1e-6 * self.squares[part] + 1e-12
            by_run[part] = 0.5 * np.log((self.squares[part] + 1e-12) / np.maximum(left, least))
        return Gains(numbers=numbers, parts=own, gains=gains, step=step, by_run=by_run)


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


def _can_be_two(one: Columns, two: Columns) -> bool:
    """Whether two named effects may be missing together: not two forms of one on the same wheels."""
    assert one.candidate is not None and two.candidate is not None
    same = one.candidate.name == two.candidate.name
    return not same or one.candidate.wheels != two.candidate.wheels
