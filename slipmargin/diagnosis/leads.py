"""Leads: the variables that a residual may follow, in order, each with its evidence and the next run.

They are ordered by what they take off the logarithm of the chi of each run, on average over the runs: a sum
of squares would let the one or two runs that are farthest off decide.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    rows = [] if last is None else followed(last)
    # one run is a fold of its own: nothing is left out of any fit
    one_run = last is not None and len(last.before.parts) == 1
    best: dict[Trace, Followed] = {}
    for row in rows:
        best.setdefault(row.trace, row)
    fits: dict[Trace, str] = {}
    for row in rows:
        if row.fitted:
            fits.setdefault(row.trace, row.label)
    refused = {label: r for r in rejected for label in r.labels}
    # of several together, or beside what was found, none has shown anything by itself
    alone = [r for r in rejected if len(r.labels) == 1 and not found]
    borne_out = {r.labels[0]: r for r in alone if r.borne_out}
    lower = [r for r in sorted(alone, key=lambda r: r.chi_after) if r.lowers]
    made: list[Lead] = []

    def add(lead: Lead) -> None:
        if lead.traced_to not in {*found, *(m.traced_to for m in made)}:
            made.append(lead)

    def place(entry: MapEntry) -> tuple[int, float, bool, float]:
        trace = entry.traced_to
        row, before = best.get(trace), 0.0 if last is None else last.before.chi
        unseen = next((i for i, r in enumerate(lower) if trace in r.traced_to), len(lower))
        if row is not None and not row.worse:  # what takes off more, and hurts no run, comes before
            less = (i for i, r in enumerate(lower) if 1.0 - (r.chi_after / r.chi_before) ** 2 < entry.share)
            unseen = min(unseen, next(less, unseen))
        noise_alone = before * np.sqrt(max(0.0, 1.0 - entry.share)) <= SETTINGS.noise_chi < before
        all_of_it = -entry.share if noise_alone else 0.0
        of_runs = (False, 0.0) if row is None else (row.hurts, -row.gain)
        return unseen, all_of_it, *of_runs

    def of_fit(row: Followed) -> Lead:
        no = borne_out.get(row.label) or refused.get(row.label)
        source = LeadSource.FIT if no is None else LeadSource.REJECTED
        searched = "the run" if one_run else "the runs"
        by = f"by {100.0 * (1.0 - np.sqrt(1.0 - row.share)):.0f} % on {searched} it was searched with"
        if no is not None and row.label in borne_out:
            source = LeadSource.BORNE_OUT
            by = f"on runs it was not fitted to from {no.chi_before:.3g} to {no.chi_after:.3g}"
        return Lead(
            traced_to=row.trace,
            source=source,
            why=f"`{row.label}` lowers chi {by}" + ("" if no is None else f"; not claimed: {no.failures[0]}"),
            next_run=TRIALS[row.trace],
            candidate=row.label,
        )

    def of_map(entry: MapEntry) -> Lead:
        return Lead(
            traced_to=entry.traced_to,
            source=LeadSource.MAP,
            why=f"{entry.form} takes {100.0 * entry.share:.2g} % off the squared residual of "
            f"{'the one run, which it was fitted to' if one_run else 'runs left out'} "
            f"(p = {entry.p_value:.2g} among all candidates)"
            + _of_runs(best.get(entry.traced_to), entry.form, one_run),
            next_run=TRIALS[entry.traced_to],
            share=entry.share,
            p_value=entry.p_value,
            candidate=fits.get(entry.traced_to),
        )

    for row in rows:
        if row.label in borne_out:
            add(of_fit(row))
    most = max((e.share for e in entries if e.supported), default=0.0)
    if drift is not None and drift.share > most:
        add(_of_drift(drift))
    hurting: list[MapEntry] = []
    for entry in sorted(entries, key=place):
        no, own = refused.get(entry.form), best.get(entry.traced_to)
        if not entry.supported or (no is not None and no.chi_after >= no.chi_before):
            continue
        if own is not None and own.hurts:
            hurting.append(entry)
        else:
            add(of_map(entry))
    if drift is not None:
        add(_of_drift(drift))
    for turn in turns:
        add(
            Lead(
                traced_to=Trace.WHEEL_ANGLE,
                source=LeadSource.ORDER,
                why=turn.sentence,
                next_run=TRIALS[Trace.WHEEL_ANGLE],
                p_value=turn.p_value,
                candidate=fits.get(Trace.WHEEL_ANGLE),
            )
        )
    for row in rows:
        if not row.fitted or row.hurts or row.share < SETTINGS.least_lead_of_squares:
            continue
        add(of_fit(row))
    for entry in hurting:
        add(of_map(entry))
    if not made and entries:
        entry = max(entries, key=lambda e: e.share)
        add(
            Lead(
                traced_to=entry.traced_to,
                source=LeadSource.MAP,
                why=f"weak: nothing stands out; {entry.form} comes nearest (p = {entry.p_value:.2g} among all"
                " candidates)" + _of_runs(best.get(entry.traced_to), entry.form, one_run),
                next_run=TRIALS[entry.traced_to],
                share=entry.share,
                p_value=entry.p_value,
                candidate=fits.get(entry.traced_to),
            )
        )
    return tuple(made[: SETTINGS.most_leads])


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
