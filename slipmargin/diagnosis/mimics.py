"""What a fault of the instrument that nobody ruled out would look like: a change of the effects found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.evidence import deviations
from slipmargin.diagnosis.fit import Fit, limits_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import Scope


def mimics(problem: Problem, found: Fit, candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Sentences: which effects stand for which fault, and how much of a parameter for how much of a fault.

    Asked of every fault of the instrument that has one number and was not found, one scale of it at a time.
    """
    if not len(found.x):
        return ()
    scale, inside = limits_of(found.structure)[2], {c.label for c in found.structure}
    asked = [c for c in candidates if c.scope is Scope.INSTRUMENT and c.size == 1 and c.label not in inside]
    points = [found.effects, *((*found.effects, c.build(c.null + c.scale)) for c in asked)]
    here, *there = problem.residuals(points, [found.trials] * len(points))
    flat = found.jacobian.reshape(-1, len(found.x)) * scale
    spread = deviations(found, scale)
    keys = [f"{k} ({c.label})" for c in found.structure for k in c.keys]
    said = []
    for candidate, residual in zip(asked, there, strict=True):
        change = (residual - here).ravel()
        step = np.linalg.lstsq(flat, change, rcond=1e-8)[0]
        total = float(change @ change)
        share = 1.0 - float(np.sum((change - flat @ step) ** 2)) / max(total, 1e-300)
        moved = np.flatnonzero(np.abs(step * scale) > SETTINGS.moved * spread)
        if share < SETTINGS.taken_up or not len(moved):
            continue
        most = sorted(moved, key=lambda i: -abs(step[i] * scale[i]) / spread[i])[:3]
        told = ", ".join(f"{keys[i]} by {step[i] * scale[i]:+.2g}" for i in most)
        size = f"{candidate.scale[0]:g} {candidate.units[0]}".removesuffix(" 1")
        said.append(
            f"Hardly told apart: {candidate.label} of {size} would look, to {share:.0%}, like a change of "
            f"{told}."
        )
    return tuple(said)
