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
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, Residuals
from slipmargin.diagnosis.gains import Gains, GainTable
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
    table = GainTable.of(base, groups, parts, block, seed)
    found = table.alone()
    starts = _starts_of_each(found)
    names = sorted((first for first, *_ in starts if first.parts[0].named), key=lambda g: -g.gain)
    pairs = list(table.pairs(names))  # first those of what takes off more alone
    entries = [_entry(tried) for tried in (*starts, *([pair] for pair in pairs))]
    return Screening(
        entries=tuple(sorted(entries, key=lambda e: -e.gain)),
        total=base.cost,
        chance=np.array([one.gains[1:] for one in (*found, *pairs)]).max(axis=0),
    )


def _starts_of_each(found: Sequence[Gains]) -> list[list[Gains]]:
    """The starts of each candidate, best first."""
    of_each: dict[str, list[Gains]] = {}
    for one in found:
        of_each.setdefault(one.parts[0].label, []).append(one)
    return [sorted(starts, key=lambda g: -g.gain) for starts in of_each.values()]


def _entry(starts: Sequence[Gains]) -> Screened:
    """The entry of a candidate, or of two, with its best start first."""
    best = starts[0]
    return Screened(
        parts=best.parts,
        gain=best.gain,
        step=best.step,
        starts=tuple(_start(one.parts, one.step) for one in starts[: 2 * SETTINGS.starts]),
        by_run=best.by_run,
    )


def _start(own: tuple[Columns, ...], step: Array) -> Array:
    """Where a fit of candidates starts: after their step."""
    ends = np.cumsum([len(c.low) for c in own])[:-1]
    steps = zip(own, np.split(step, ends), strict=True)
    return np.concatenate([np.zeros(0), *(c.start(part) for c, part in steps if c.candidate is not None)])
