"""What candidates take off as simulated where their tangents put them, or after a few steps of a fit.

A tangent is taken where a candidate does nothing, and friction that sticks answers a small force hardly at
all: a steady push or twist takes off four fifths of a residual of which its tangent knows a twentieth, and
coefficients that are 5 % off came thirtieth in a list that they explain to the noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import build, few_steps, misfit_of
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.tangents import simulated


def as_simulated(
    before: State, screening: Screening, overdue: Callable[[], bool] = lambda: False
) -> Screening:
    """The list with what each candidate that stands alone promises: the better of tangent and simulation.

    The steps from its best starts are simulated, since a start that its tangents put first may lead astray,
    and where it says a place, a time or an angle, all of its starts as they are: one roller that turns
    heavily, or dust on a place, takes off much where it is and no step of its tangents finds it.  A fit may
    start at what takes off most.
    They suit the runs that they are simulated in: two parameters' worth of noise is taken off for each.
    Once it is ``overdue`` the others, which stand further down the list, keep what their tangents gain.
    """
    base, shares, tried = before.fit, SETTINGS.step_shares, SETTINGS.starts
    asked = [e for e in screening.entries if e.stands_alone]
    if not asked:
        return screening
    problem = before.view.rough()
    points = [
        [
            *(
                part_way(entry.structure[0], start, share)
                for start in entry.starts[:tried]
                for share in shares
            ),
            *(entry.structure[0].starts if entry.structure[0].idle.any() else ()),
        ]
        for entry in asked
    ]
    effects = [
        build((*base.structure, *entry.structure), np.concatenate([base.x, x]))
        for entry, of_entry in zip(asked, points, strict=True)
        for x in of_entry
    ]
    known, *left = simulated(problem, [base.effects, *effects], base.trials, overdue) or [base.residual]
    off = float(np.sum(known**2))
    misfit = misfit_of(known)
    found, squares = {}, iter([float(np.sum(r**2)) for r in left])
    for entry, of_entry in zip(asked, points, strict=True):
        own = list(islice(squares, len(of_entry)))
        if len(own) < len(of_entry):
            break
        promise = off - min(own) - 2.0 * misfit * entry.structure[0].size
        best = [of_entry[i] for i in np.argsort(own, kind="stable")]
        starts = _elsewhere(entry.structure[0], [entry.starts[0], *best])[: 1 + tried]
        found[entry.label] = replace(entry, promise=promise, starts=starts or entry.starts)
    return replace(screening, entries=tuple(found.get(e.label, e) for e in screening.entries))


def after_steps(
    before: State, entries: Sequence[Screened], expired: Callable[[], bool] = lambda: False
) -> list[Screened]:
    """Entries with what a few steps of a fit from their starts take off, and where the best of these ended;
    the best entry first.
    """
    base, found = before.fit, []
    for entry in entries:
        if expired():
            break
        structure = (*base.structure, *entry.structure)
        begins = [np.concatenate([base.x, x]) for x in entry.starts]
        ends = [few_steps(before.view, structure, x, base.trials) for x in begins]
        ends = sorted(ends, key=lambda end: end[1])[: SETTINGS.starts]
        starts = tuple(x[len(base.x) :] for x, _ in ends)
        found.append(replace(entry, starts=starts, promise=base.cost - ends[0][1]))
    return sorted(found, key=lambda e: -e.promise)


def _elsewhere(candidate: Candidate, points: Sequence[Array]) -> tuple[Array, ...]:
    """The first point at each place, time or angle that a candidate names; nothing where it names none."""
    there, found = candidate.idle, dict[tuple[float, ...], Array]()
    for x in points:
        found.setdefault(tuple(np.round(x[there] / candidate.scale[there], 3).tolist()), x)
    return tuple(found.values()) if there.any() else ()


def part_way(candidate: Candidate, start: Array, share: float) -> Array:
    """Parameters (P,) at a share of the step from null to a start; those that say where or how stay there."""
    part = np.where(candidate.idle, 1.0, share)
    there = candidate.null + part * (start - candidate.null)
    return np.clip(there, candidate.low, candidate.high)  # a start at a bound must not pass it by rounding
