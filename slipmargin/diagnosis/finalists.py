"""Which entries of the screened list are worth a fit by simulation."""

from __future__ import annotations

from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS


def finalists(screening: Screening, many: int) -> list[Screened]:
    """What is fitted: the ``many`` best names of the list, half as many general forms, and as many pairs.

    Forms are taken by what they promise as simulated.  A name takes one place, in the form that its tangents
    put first: the forms of one would keep others out.  The best name is fitted in its other forms too, since
    tangents say little about which of them is meant.  A pair is fitted only where its two tangents together
    leave clearly less than any single one.
    """
    able = [e for e in screening.entries if e.structure and e.gain > 0.0]
    single = [e for e in able if len(e.parts) == 1]
    best = single[0].gain if single else 0.0
    pairs = [
        e
        for e in able
        if len(e.parts) == 2 and screening.total - e.gain < SETTINGS.pair_leaves * (screening.total - best)
    ]
    least = SETTINGS.hopeless * max([best, *(e.gain for e in pairs)])
    names = [e for e in single if e.named and e.gain > least]
    of_each: dict[str, Screened] = {}
    for entry in names:
        of_each.setdefault(entry.structure[0].name, entry)
    first = list(of_each.values())[:many]
    other = [e for e in names if e not in first and e.structure[0].name == first[0].structure[0].name]
    free = [e for e in screening.entries if e.structure and len(e.parts) == 1 and not e.named]
    forms = sorted((e for e in free if e.promise > least), key=lambda e: -e.promise)
    chosen = [
        *first,
        *other[: many // 2],
        *forms[: many // 2],
        *[e for e in pairs if e.gain > least][: many // 2],
    ]
    return sorted(chosen, key=lambda e: -e.gain)
