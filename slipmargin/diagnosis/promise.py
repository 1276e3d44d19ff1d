"""What candidates take off as simulated where their tangents put them.

A tangent is taken where a candidate does nothing, and friction that sticks answers a small force hardly at
all: a steady push or twist takes off four fifths of a residual of which its tangent knows a twentieth, and
coefficients that are 5 % off came thirtieth in a list that they explain to the noise.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import build
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State


def as_simulated(before: State, screening: Screening) -> Screening:
    """The list with what each candidate that stands alone promises: the better of tangent and simulation.

    Its step suits the runs that it is simulated in: two parameters' worth of noise is taken off for each.
    """
    base, shares = before.fit, SETTINGS.step_shares
    asked = [e for e in screening.entries if _stands_alone(e)]
    if not asked:
        return screening
    effects = [
        build((*base.structure, *entry.structure), np.concatenate([base.x, part_way(entry, share)]))
        for entry in asked
        for share in shares
    ]
    left = before.view.residuals(effects, [base.trials] * len(effects))
    costs = np.array([float(np.sum(r**2)) for r in left]).reshape(len(asked), len(shares))
    misfit = max(1.0, base.cost / max(1, int(np.count_nonzero(base.residual))))
    found = {
        entry.label: replace(entry, promise=base.cost - cost.min() - 2.0 * misfit * entry.structure[0].size)
        for entry, cost in zip(asked, costs, strict=True)
    }
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
