"""What candidates take off as simulated where their tangents put them.

A tangent is taken where a candidate does nothing, and friction that sticks answers a small force hardly at
all: a steady push or twist takes off four fifths of a residual of which its tangent knows a twentieth, and
coefficients that are 5 % off came thirtieth in a list that they explain to the noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import build
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.tangents import in_parts


def as_simulated(
    before: State, screening: Screening, overdue: Callable[[], bool] = lambda: False
) -> Screening:
    """The list with what each candidate that stands alone promises: the better of tangent and simulation.

    Its step suits the runs that it is simulated in: two parameters' worth of noise is taken off for each.
    Once it is ``overdue`` the others, which stand further down the list, keep what their tangents gain.
    """
    base, shares = before.fit, SETTINGS.step_shares
    asked = [e for e in screening.entries if _stands_alone(e)]
    if not asked:
        return screening
    problem = before.view.rough()
    effects = [
        build((*base.structure, *entry.structure), np.concatenate([base.x, part_way(entry, share)]))
        for entry in asked
        for share in shares
    ]
    known, *left = in_parts(problem, [base.effects, *effects], base.trials, overdue) or [base.residual]
    off = float(np.sum(known**2))
    misfit = max(1.0, off / max(1, int(np.count_nonzero(known))))
    found = {}
    for entry, *residuals in zip(asked, *(left[i :: len(shares)] for i in range(len(shares))), strict=False):
        taken = off - min(float(np.sum(r**2)) for r in residuals)
        found[entry.label] = replace(entry, promise=taken - 2.0 * misfit * entry.structure[0].size)
    return replace(screening, entries=tuple(found.get(e.label, e) for e in screening.entries))


def _stands_alone(entry: Screened) -> bool:
    """Whether it is one candidate, not a pair, and no probe."""
    return len(entry.parts) == 1 and bool(entry.structure)


def part_way(entry: Screened, share: float) -> Array:
    """Parameters (P,) at a share of the step from null; those that say where or how stay where it led."""
    candidate, start = entry.structure[0], entry.starts[0]
    part = np.where(candidate.idle, 1.0, share)
    there = candidate.null + part * (start - candidate.null)
    return np.clip(there, candidate.low, candidate.high)  # a start at a bound must not pass it by rounding
