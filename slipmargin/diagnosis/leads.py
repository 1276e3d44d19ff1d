"""Leads: the variables that a residual may follow, in order, each with its evidence and the next run.

They are ordered by what they take off the logarithm of the chi of each run, on average over the runs: a sum
of squares would let the one or two runs that are farthest off decide.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.result import Lead, LeadSource, Rejected
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.run_order import Drift
from slipmargin.diagnosis.separate import TRIALS
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import explained
from slipmargin.diagnosis.tangents import standpoints
from slipmargin.effects import Trace


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Followed:
    """How well one candidate, alone beside what is known, predicts runs that were left out of its fit.

    ``gain`` is what the logarithm of a run's chi falls by on average, ``better`` and ``worse`` count the runs
    whose chi changes clearly, ``share`` is that of the sum of squares; ``fitted``: by simulation, not by its
    tangent alone, which may still be what counts.
    """

    trace: Trace
    label: str
    gain: float
    better: int
    worse: int
    share: float
    fitted: bool

    @property
    def hurts(self) -> bool:
        """Whether no more runs get clearly better than get clearly worse."""
        return self.worse > 0 and self.worse >= self.better


def followed(last: Round) -> list[Followed]:
    """Every single candidate of a round, by its fit or its tangent, largest gain per run first."""
    made: list[Followed] = []
    for state in last.tried:
        if last.single(state):
            by_run = 0.5 * np.log(np.maximum(last.before.scores, 1e-12) / np.maximum(state.scores, 1e-12))
            share = explained(last.before, state)
            made.append(_followed(state.last.trace, state.last, by_run, share, state.last.label))
    fits = {row.label for row in made}
    for entry in last.screening.entries:
        if len(entry.parts) == 1 and len(entry.by_run):
            part, share = entry.parts[0], last.screening.share(entry)
            fit = entry.label in fits
            made.append(_followed(part.trace, part.candidate, entry.by_run, share, entry.label, fit))
    best: dict[str, Followed] = {}
    for row in sorted(made, key=lambda f: (f.hurts, -f.gain)):
        best.setdefault(row.label, row)
    return list(best.values())


def _followed(
    trace: Trace, candidate: Candidate | None, by_run: Array, share: float, label: str, fitted: bool = True
) -> Followed:
    """The best of several places or times gains by having been picked: the logarithm of their number."""
    places = 1 if candidate is None else len(standpoints(candidate))
    clear = np.log1p(SETTINGS.worse_factor)
    return Followed(
        trace=trace,
        label=label,
        gain=float(np.sum(by_run) - np.log(places)) / len(by_run),
        better=int(np.count_nonzero(by_run > clear)),
        worse=int(np.count_nonzero(by_run < -clear)),
        share=share,
        fitted=fitted,
    )


def leads(
    entries: Sequence[MapEntry],
    turns: Sequence[Periodicity],
    last: Round | None,
    rejected: Sequence[Rejected],
    found: Sequence[Trace],
    drift: Drift | None = None,
) -> tuple[Lead, ...]:
    """What to look at next, best first.

    First what runs bear out to which it was not fitted, and what is not claimed for another reason; then what
    the map supports, of that first what lowers the error of runs that it was not fitted to, if not as surely
    as a claim must (but for what takes more off runs left out, and hurts none), and what leaves nothing but
    noise; then what repeats with a wheel's angle, and what fits the searched runs best beside what was
    ``found``, in the round that began with it (``last``); then what the map supports though it makes more
    runs worse than better.  What grows or falls from run to run comes before the map where it takes more off
    than anything there, else after it.  Where there is nothing of all that, the best there is, said to be
    weak.  What was found is no lead.
    """
    evidence = _Evidence.of(last, rejected, beside=bool(found))
    of_each: dict[Trace, Lead] = {}
    for lead in evidence.in_order(entries, turns, drift):
        if lead.traced_to not in found:
            of_each.setdefault(lead.traced_to, lead)
    if not of_each and entries:
        weak = evidence.weak(max(entries, key=lambda e: e.share))
        of_each = {} if weak.traced_to in found else {weak.traced_to: weak}
    return tuple(of_each.values())[: SETTINGS.most_leads]


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Evidence:
    """What speaks for and against the candidates of a round.

    ``rows`` are those of :func:`followed`, ``best`` the first of each variable, ``fits`` the label of the
    first of each that was fitted; ``chi`` is what the round began with.  ``refused`` says by label what is
    not claimed; of what was asked by itself, ``borne_out`` holds for runs that it was not fitted to, and
    ``lower`` lowers their error, the least error first.  Of ``one_run`` nothing is left out of any fit.
    """

    rows: list[Followed]
    best: dict[Trace, Followed]
    fits: dict[Trace, str]
    chi: float
    one_run: bool
    refused: dict[str, Rejected]
    borne_out: dict[str, Rejected]
    lower: list[Rejected]

    @staticmethod
    def of(last: Round | None, rejected: Sequence[Rejected], *, beside: bool) -> _Evidence:
        """That of a round; what was rejected ``beside`` something found has shown nothing by itself."""
        rows = [] if last is None else followed(last)
        best: dict[Trace, Followed] = {}
        fits: dict[Trace, str] = {}
        for row in rows:
            best.setdefault(row.trace, row)
            if row.fitted:
                fits.setdefault(row.trace, row.label)
        alone = [] if beside else [r for r in rejected if len(r.labels) == 1]
        return _Evidence(
            rows=rows,
            best=best,
            fits=fits,
            chi=0.0 if last is None else last.before.chi,
            one_run=last is not None and len(last.before.parts) == 1,
            refused={label: r for r in rejected for label in r.labels},
            borne_out={r.labels[0]: r for r in alone if r.borne_out},
            lower=[r for r in sorted(alone, key=lambda r: r.chi_after) if r.lowers],
        )

    def in_order(
        self, entries: Sequence[MapEntry], turns: Sequence[Periodicity], drift: Drift | None
    ) -> Iterator[Lead]:
        """Every lead, best first; a variable may come more than once."""
        for row in self.rows:
            if row.label in self.borne_out:
                yield self._of_fit(row)
        drifts = [] if drift is None else [_of_drift(drift)]
        if drift is not None and drift.share > max((e.share for e in entries if e.supported), default=0.0):
            yield from drifts
        told = [e for e in sorted(entries, key=self._place) if e.supported and not self._made_worse(e.form)]
        hurting = [e for e in told if (own := self.best.get(e.traced_to)) is not None and own.hurts]
        yield from (self._of_map(entry) for entry in told if entry not in hurting)
        yield from drifts
        yield from (self._of_turn(turn) for turn in turns)
        for row in self.rows:
            if row.fitted and not row.hurts and row.share >= SETTINGS.least_lead_of_squares:
                yield self._of_fit(row)
        yield from (self._of_map(entry) for entry in hurting)

    def weak(self, entry: MapEntry) -> Lead:
        """The best there is where there is no lead."""
        nearest = f"{entry.form} comes nearest (p = {entry.p_value:.2g} among all candidates)"
        return self._mapped(entry, f"weak: nothing stands out; {nearest}")

    def _made_worse(self, label: str) -> bool:
        """Whether a candidate, judged as a correction, did not lower the error."""
        no = self.refused.get(label)
        return no is not None and no.chi_after >= no.chi_before

    def _place(self, entry: MapEntry) -> tuple[int, float, bool, float]:
        """Where an entry of the map stands among all, smallest first."""
        row = self.best.get(entry.traced_to)
        others = len(self.lower)
        unseen = next((i for i, r in enumerate(self.lower) if entry.traced_to in r.traced_to), others)
        if row is not None and not row.worse:  # what takes off more, and hurts no run, comes before
            off = (1.0 - (r.chi_after / r.chi_before) ** 2 for r in self.lower)
            unseen = min(unseen, next((i for i, share in enumerate(off) if share < entry.share), unseen))
        left = self.chi * np.sqrt(max(0.0, 1.0 - entry.share))
        all_of_it = -entry.share if left <= SETTINGS.noise_chi < self.chi else 0.0
        of_runs = (False, 0.0) if row is None else (row.hurts, -row.gain)
        return unseen, all_of_it, *of_runs

    def _of_fit(self, row: Followed) -> Lead:
        no = self.borne_out.get(row.label) or self.refused.get(row.label)
        source = LeadSource.FIT if no is None else LeadSource.REJECTED
        searched = "the run" if self.one_run else "the runs"
        by = f"by {100.0 * (1.0 - np.sqrt(1.0 - row.share)):.0f} % on {searched} it was searched with"
        if no is not None and row.label in self.borne_out:
            source = LeadSource.BORNE_OUT
            by = f"on runs it was not fitted to from {no.chi_before:.3g} to {no.chi_after:.3g}"
        return Lead(
            traced_to=row.trace,
            source=source,
            why=f"`{row.label}` lowers chi {by}" + ("" if no is None else f"; not claimed: {no.failures[0]}"),
            next_run=TRIALS[row.trace],
            candidate=row.label,
        )

    def _of_map(self, entry: MapEntry) -> Lead:
        why = (
            f"{entry.form} takes {100.0 * entry.share:.2g} % off the squared residual of "
            f"{'the one run, which it was fitted to' if self.one_run else 'runs left out'} "
            f"(p = {entry.p_value:.2g} among all candidates)"
        )
        return self._mapped(entry, why)

    def _mapped(self, entry: MapEntry, why: str) -> Lead:
        return Lead(
            traced_to=entry.traced_to,
            source=LeadSource.MAP,
            why=why + _of_runs(self.best.get(entry.traced_to), entry.form, self.one_run),
            next_run=TRIALS[entry.traced_to],
            share=entry.share,
            p_value=entry.p_value,
            candidate=self.fits.get(entry.traced_to),
        )

    def _of_turn(self, turn: Periodicity) -> Lead:
        return Lead(
            traced_to=Trace.WHEEL_ANGLE,
            source=LeadSource.ORDER,
            why=turn.sentence,
            next_run=TRIALS[Trace.WHEEL_ANGLE],
            p_value=turn.p_value,
            candidate=self.fits.get(Trace.WHEEL_ANGLE),
        )


def _of_drift(drift: Drift) -> Lead:
    return Lead(
        traced_to=Trace.TIME,
        source=LeadSource.RUN_ORDER,
        why=drift.sentence,
        next_run=TRIALS[Trace.TIME],
        share=drift.share,
        p_value=drift.p_value,
    )


def _of_runs(row: Followed | None, form: str, one_run: bool) -> str:
    if row is None:
        return ""
    return f"; {'' if row.label == form else f'{row.label}: '}{_counted(row, one_run)}"


def _counted(row: Followed, one_run: bool) -> str:
    """How many runs a candidate predicts better and worse; of one run what it does to its chi."""
    by = 100.0 * (1.0 - np.exp(-row.gain))
    change = f"{by:.0f} % lower" if by >= 0.0 else f"{-by:.0f} % higher"
    if one_run:
        return f"its chi gets {change}"
    return (
        f"of the runs left out {row.better} get clearly better, {row.worse} worse, chi {change} in the mean"
    )
