"""Leads: the variables that a residual may follow, in order, each with its evidence and the next run."""

from __future__ import annotations

from collections.abc import Sequence

from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.order_analysis import Periodicity
from slipmargin.diagnosis.result import Lead, LeadSource, Rejected
from slipmargin.diagnosis.search import Round
from slipmargin.diagnosis.separate import TRIALS
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Trace

#: At most so many leads are listed.
_MOST = 6


def leads(
    entries: Sequence[MapEntry],
    turns: Sequence[Periodicity],
    last: Round | None,
    rejected: Sequence[Rejected],
    found: Sequence[Trace],
) -> tuple[Lead, ...]:
    """What to look at next, best first.

    First what the map supports, then what repeats with a wheel's angle, then what fits the searched runs
    best beside what was ``found``, in the round that began with it (``last``).  What was found is no lead.
    """
    fits = {} if last is None else _fits(last)
    refused = {label: r for r in rejected for label in r.labels}
    made: list[Lead] = []

    def add(lead: Lead) -> None:
        if lead.traced_to not in {*found, *(m.traced_to for m in made)}:
            made.append(lead)

    for entry in entries:
        no = refused.get(entry.form)
        if entry.supported and not (no is not None and no.chi_after >= no.chi_before):
            label = fits.get(entry.traced_to, (None, 0.0))[0]
            add(
                Lead(
                    traced_to=entry.traced_to,
                    source=LeadSource.MAP,
                    why=f"{entry.form} takes {100.0 * entry.share:.2g} % off the squared residual of runs "
                    f"left out (p = {entry.p_value:.2g} among all candidates)",
                    next_run=TRIALS[entry.traced_to],
                    share=entry.share,
                    p_value=entry.p_value,
                    candidate=label,
                )
            )
    for turn in turns:
        add(
            Lead(
                traced_to=Trace.WHEEL_ANGLE,
                source=LeadSource.ORDER,
                why=turn.sentence,
                next_run=TRIALS[Trace.WHEEL_ANGLE],
                p_value=turn.p_value,
                candidate=fits.get(Trace.WHEEL_ANGLE, (None, 0.0))[0],
            )
        )
    for trace, (label, drop) in fits.items():
        if drop < SETTINGS.least_lead:
            continue
        no = refused.get(label)
        add(
            Lead(
                traced_to=trace,
                source=LeadSource.FIT if no is None else LeadSource.REJECTED,
                why=f"`{label}` lowers chi by {100.0 * drop:.0f} % on the runs it was searched with"
                + ("" if no is None else f"; not claimed: {no.failures[0]}"),
                next_run=TRIALS[trace],
                candidate=label,
            )
        )
    return tuple(made[:_MOST])


def _fits(last: Round) -> dict[Trace, tuple[str, float]]:
    """The best single addition to what was found, for every variable, and by what share chi falls with it."""
    best: dict[Trace, tuple[str, float]] = {}
    for state in last.tried:
        if last.single(state):
            best.setdefault(state.last.trace, (state.last.label, 1.0 - state.chi / last.before.chi))
    return best
