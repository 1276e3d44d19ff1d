"""One step of the search: what it started from, what it listed and fitted, what it took."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.screen import Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good, explained, worthwhile
from slipmargin.effects import Trace


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Round:
    """One step: where it started, the screened list, the fits (best first), the chosen one, if taken.

    ``names_only``: the list held no general forms, so that it is no map of what is left.
    """

    before: State
    screening: Screening
    tried: tuple[State, ...]
    best: State | None
    taken: bool
    names_only: bool = False

    def p_value_of(self, state: State | None) -> float:
        """Probability that noise alone gives the best of the list as large a gain as a state has; None: 1."""
        return 1.0 if state is None else self.screening.p_value(explained(self.before, state))

    def moved(self, problem: Problem, runs: tuple[int, ...]) -> Round:
        """The same of a problem in which trials that it has not looked at are cut."""
        tried = tuple(s.moved(problem, runs) for s in self.tried)
        best = next((new for old, new in zip(self.tried, tried, strict=True) if old is self.best), None)
        return replace(self, before=self.before.moved(problem, runs), tried=tried, best=best)

    def map(self) -> tuple[MapEntry, ...]:
        """The best candidate of each variable: what the residual follows, strongest first.

        A candidate's share is that of its fit by simulation or that of its tangent, whichever is larger:
        both are of runs left out, and a fit may end beside a place that its tangent has seen.
        """
        rows = [(explained(self.before, s), s.last.trace, s.last.label) for s in self.tried if self.single(s)]
        rows += [
            (self.screening.share(entry), entry.parts[0].trace, entry.label)
            for entry in self.screening.entries
            if len(entry.parts) == 1
        ]
        best: dict[Trace, MapEntry] = {}
        for share, trace, label in sorted(rows, key=lambda row: -row[0]):
            p_value = self.screening.p_value(share)
            best.setdefault(trace, MapEntry(traced_to=trace, form=label, share=share, p_value=p_value))
        return tuple(best.values())

    def single(self, state: State) -> bool:
        """Whether a state adds one candidate."""
        return len(state.structure) == len(self.before.structure) + 1

    def with_alone(self, candidate: Candidate) -> State | None:
        """The best state that adds nothing but a candidate, in whichever form; None where none was tried."""
        return next((s for s in self.tried if self.single(s) and s.last.is_same_as(candidate)), None)

    def rivals(self, of: State | None = None) -> list[State]:
        """States that these trials cannot tell from one, by default the best.

        They are as good as the least error of the round where that one is.
        """
        one = of or self.best
        if one is None:
            return []
        level = self.tried[0] if as_good(one, self.tried[0]) else one
        return [s for s in self.tried if s is not one and as_good(s, level)]

    def others(self) -> list[State]:
        """Names worth following beside the best one, the best of each other variable: those that take off at
        least a share of what it does, and, if it has no name, the best that has one."""
        best, before = self.best, self.before
        if best is None or not self.taken:
            return []
        named = (s for s in self.tried if s.named and worthwhile(before, s.chi))
        first = None if best.named else next(named, None)
        found: dict[Trace, State] = {} if first is None else {first.last.trace: first}
        for state in self._of_its_size(best):
            if state.named:
                found.setdefault(state.last.trace, state)
        if best.named:
            found.pop(best.last.trace, None)
        return list(found.values())[: SETTINGS.followed]

    def of_other_variables(self) -> list[State]:
        """The best single candidate of each variable but that of the best one, named or not, with the same
        least share."""
        if self.best is None:
            return []
        known = {c.trace for c in self.best.structure}
        return self._instead_of(self.best, known)[: SETTINGS.followed]

    def part_alone(self) -> list[State]:
        """Where the best adds two, the one of them that is better alone, if it was tried alone."""
        best, before = self.best, self.before
        if best is None or not self.taken or self.single(best):
            return []
        parts = (s for s in self.tried if s.named and self.single(s) and s.things < best.things)
        return [s for s in parts if worthwhile(before, s.chi)][:1]

    def instead_of(self, known: Candidate) -> list[State]:
        """Names that stand here in the place of a known one, the best of each other variable: those that take
        off at least a share of what it does.

        A name's rank depends on what is still missing: which is meant shows once that is known.
        """
        own = self.with_alone(known)
        return [] if own is None else self._instead_of(own, {known.trace}, names_only=True)

    def _instead_of(self, one: State, known: set[Trace], *, names_only: bool = False) -> list[State]:
        """The best single candidate of its size of each variable that is not ``known``."""
        found: dict[Trace, State] = {}
        for state in self._of_its_size(one):
            if self.single(state) and state.last.trace not in known and (state.named or not names_only):
                found.setdefault(state.last.trace, state)
        return list(found.values())

    def _of_its_size(self, one: State) -> list[State]:
        """The others that take off at least a share of what one state does."""
        before, least = self.before, SETTINGS.followed_share * (self.before.chi - one.chi)
        others = (s for s in self.tried if s is not one and worthwhile(before, s.chi, s.last.named))
        return [s for s in others if before.chi - s.chi >= least]


def candidates_of(rounds: Sequence[Round]) -> list[Candidate]:
    """Everything that was screened."""
    return list({c.label: c for r in rounds for e in r.screening.entries for c in e.structure}.values())
