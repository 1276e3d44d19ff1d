"""Which entries of the screened list are worth a fit by simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS


def finalists(screening: Screening, many: int) -> list[Screened]:
    """What is fitted: the ``many`` best names of the list, half as many general forms, and as many pairs.

    Single candidates are taken by what they promise.  A name takes one place, in the form that promises
    most: the forms of one would keep others out.  Names that promise nearly as much as the last of them
    are taken as well, up to as many again.  The best name is fitted in its other forms too, since
    a list says little about which of them is meant.  A pair is fitted only where its two tangents together
    leave clearly less than any single one, or where it is one thing in two halves, of which one is fitted.
    """
    alone, two = _alone(screening), _pairs(screening)
    best = max((e.gain for e in alone), default=0.0)
    enough = screening.total - SETTINGS.pair_leaves * (screening.total - max(0.0, best))
    pairs = [e for e in two if e.gain > enough]
    least = SETTINGS.hopeless * max([0.0, best, *(e.gain for e in pairs)])
    single = [e for e in alone if e.promise > least]
    names = [e for e in single if e.named]
    each = _best_of_each(names)
    first = each[:many]
    first += [e for e in each[many : 2 * many] if e.promise >= SETTINGS.nearly_promised * first[-1].promise]
    other = [e for e in names if e not in first and e.structure[0].name == first[0].structure[0].name]
    forms = [e for e in single if not e.named]
    chosen = [
        *first,
        *other[: many // 2],
        *forms[: many // 2],
        *[e for e in pairs if e.gain > least][: many // 2],
        *_best_of_each([e for e in two if _halves(e, first)]),
    ]
    return sorted(dict.fromkeys(chosen), key=_first_promised)


def of_other_variables(screening: Screening, fitted: Sequence[Screened], many: int) -> list[Screened]:
    """The ``many`` general forms that promise most over variables of which no form is ``fitted``.

    A tangent, or a step of it simulated, says little about which of several variables is meant: they follow
    one another in every run.
    """
    known = {e.structure[0].name for e in fitted if not e.named}
    forms = [e for e in _alone(screening) if not e.named and e.structure[0].name not in known]
    return _best_of_each(forms)[:many]


def other_names(screening: Screening, fitted: Sequence[Screened], many: int) -> list[Screened]:
    """The ``many`` names, a wheel or a form each, that promise most of those that are not ``fitted``.

    Each has one start, its second: what tangents put first has led nowhere, or there is no other.
    """
    return [replace(e, starts=e.starts[:2][-1:]) for e in _names_but(screening, fitted)[:many]]


def pointed_at(screening: Screening, sought: Sequence[Screened]) -> list[Screened]:
    """Names of the variable of a probe that stands above them, with all of their places or times as starts;
    but those whose places were ``sought`` already.

    What no fit can vary says that something happens there, and tangents may have led a name elsewhere: where
    friction holds the robot a small push moves it hardly at all, and by nothing that a larger one does.
    """
    probe = max((e for e in screening.entries if not e.structure), key=lambda e: e.gain, default=None)
    if probe is None:
        return []
    own = [e for e in _names_but(screening, sought) if e.parts[0].trace == probe.parts[0].trace]
    astray = [e for e in own if e.structure[0].idle.any() and e.promise < probe.gain]
    return [replace(e, starts=tuple(e.structure[0].starts)) for e in astray]


def _alone(screening: Screening) -> list[Screened]:
    """Single candidates, the one that promises most first."""
    return sorted((e for e in screening.entries if e.stands_alone), key=_first_promised)


def _names_but(screening: Screening, known: Sequence[Screened]) -> list[Screened]:
    """Single names that are not ``known``, the one that promises most first."""
    labels = {e.label for e in known}
    return [e for e in _alone(screening) if e.named and e.label not in labels]


def _pairs(screening: Screening) -> list[Screened]:
    """Two named candidates together, those that gain most first."""
    return sorted((e for e in screening.entries if len(e.structure) == 2), key=lambda e: -e.gain)


def _halves(pair: Screened, fitted: Sequence[Screened]) -> bool:
    """Whether two candidates are the halves of one thing of which one, by name, is ``fitted``."""
    names = {c.name for c in pair.structure}
    known = any(e.structure[0].name in names for e in fitted)
    return known and any(c.other_half in names for c in pair.structure)


def _best_of_each(entries: Sequence[Screened]) -> list[Screened]:
    """The first entry of each name, or of each two; a general form has that of its variable."""
    found: dict[frozenset[str], Screened] = {}
    for entry in entries:
        found.setdefault(frozenset(c.name for c in entry.structure), entry)
    return list(found.values())


def _first_promised(entry: Screened) -> float:
    return -entry.promise
