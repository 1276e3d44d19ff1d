"""What general forms take off as simulated where their tangents put them.

A tangent is taken where the form does nothing, and friction that sticks answers a small force hardly at all:
a steady push or twist takes off four fifths of a residual of which its tangent knows a twentieth.  Named
effects are simulated at their starts; a form has none but its own step.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.diagnosis.fit import build
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State


def as_simulated(before: State, screening: Screening) -> Screening:
    """The list with what each form that stands alone promises: the better of its tangent and a simulation.

    Its step suits the runs that it is simulated in: two parameters' worth of noise is taken off for each.
    """
    base, shares = before.fit, SETTINGS.step_shares
    asked = [e for e in screening.entries if _is_a_form(e)]
    if not asked:
        return screening
    effects = [
        build(
            (*base.structure, form),
            np.concatenate([base.x, form.null + share * (entry.starts[0] - form.null)]),
        )
        for entry in asked
        for form in entry.structure
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


def _is_a_form(entry: Screened) -> bool:
    """Whether it is one free form that may also do nothing."""
    return len(entry.parts) == 1 and bool(entry.structure) and not entry.named and entry.structure[0].nested
