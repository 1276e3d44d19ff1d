"""Which other names explain the runs as well as an effect that holds, beside all else that was found.

A round compares names beside what was known when it began.  Far above the noise, where another effect is
still missing, many names leave as much as one another; once that effect is known, most of them do not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import build, spans
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import refitted
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rival:
    """What stands in the place of one effect of a state, and where a fit of it and the other effects starts.

    ``compared``: the round in which it was as good knew all the other effects.
    """

    new: tuple[Candidate, ...]
    structure: tuple[Candidate, ...]
    x: Array
    compared: bool


def origin(
    candidate: Candidate, structure: Sequence[Candidate], rounds: Sequence[Round]
) -> tuple[Round, State | None]:
    """The round that tried a candidate beside most of what else is found, and its state there.

    If none did, it is the one taken with it in it, or one tried.
    """
    others = {c.thing for c in structure} - {candidate.thing}
    alone = [
        (step, state)
        for step in rounds
        for state in step.tried
        if step.single(state) and state.last.is_same_as(candidate) and step.before.things <= others
    ]

    def fits(row: tuple[Round, State]) -> tuple[int, bool, bool]:
        step, state = row
        own = state.last.label == candidate.label
        return len(step.before.structure), step.taken and state is step.best, own

    if alone:
        return max(alone, key=fits)
    taken = [(r, r.best) for r in rounds if r.taken and r.best is not None]
    for step, state in (*taken, *((r, s) for r in rounds for s in r.tried)):
        if any(c.is_same_as(candidate) for c in state.structure):
            return step, state
    return rounds[0], None


def instead_of(state: State, index: int, rounds: Sequence[Round]) -> Iterator[Rival]:
    """What was as good as one effect of ``state`` in the round that tried it, in its place.

    A form over a name's own variable is no other explanation: it says the same with free coefficients.
    """
    candidate = state.structure[index]
    step, own = origin(candidate, state.structure, rounds)
    if own is None:
        return
    known = {c.name for c in own.structure}
    for other in step.rivals(own):
        if candidate.name in {c.name for c in other.structure}:
            continue
        gone = {candidate.thing} | (own.things - other.things)
        kept = [(c, x) for c, x in _split(state) if c.thing not in gone]
        there = {c.thing for c, _ in kept}
        new = [
            (c, x)
            for c, x in _split(other)
            if c.name not in known
            and c.thing not in there
            and (c.named or not candidate.named or c.trace is not candidate.trace)
        ]
        if new:
            yield Rival(
                new=tuple(c for c, _ in new),
                structure=tuple(c for c, _ in (*kept, *new)),
                x=np.concatenate([x for _, x in (*kept, *new)]),
                compared=state.things <= own.things,
            )


def cannot_be_told(
    state: State, rounds: Sequence[Round], runs: Sequence[int], expired: Callable[[], bool]
) -> list[tuple[str, ...]]:
    """Labels of what explains the runs as well as each effect of ``state``, all others as they may be.

    What no round has compared beside them is fitted there; once the time has ``expired``, it is left among
    them.  ``runs`` is the run that each trial of the fit is, or is cut from.
    """
    found = []
    for index in range(len(state.structure)):
        as_well: dict[str, None] = {}
        for rival in instead_of(state, index, rounds):
            if {c.label for c in rival.new} <= as_well.keys():
                continue
            if rival.compared or expired() or _as_good_there(rival, state, runs):
                as_well |= dict.fromkeys(c.label for c in rival.new)
        found.append(tuple(as_well))
    return found


def _as_good_there(rival: Rival, state: State, runs: Sequence[int]) -> bool:
    if not can_be(state.view, rival.structure, rival.x):
        return False
    worst = SETTINGS.out_of_reach * state.fit.cost
    there = refitted(state, rival.structure, rival.x, runs, worst)
    return bool(np.isfinite(there.chi)) and as_good(there, state)


def can_be(problem: Problem, structure: Sequence[Candidate], x: Array) -> bool:
    """Whether these effects can stand beside each other in the robot: two laws for one thing refuse."""
    return problem.possible(build(structure, x)) is not None


def _split(state: State) -> list[tuple[Candidate, Array]]:
    """The candidates with their parameters."""
    return [(c, state.fit.x[s]) for c, s in zip(state.structure, spans(state.structure), strict=True)]
