"""One pull, with its proof: the number, the certificate, the rows that bind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.cones import cone_limit, limit_program
from slipmargin.limits.pull import Pull
from slipmargin.model import Model
from slipmargin.solve.program import Certificate, Solution


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullLimit:
    """F_emax at one heading and the cone program's solution that proves it."""

    force_N: float
    solution: Solution

    def certificate(self) -> Certificate:
        """Primal and dual residual and gap, from the definition."""
        return self.solution.certificate()

    def binding(self) -> tuple[str, ...]:
        """Names of the rows and cones whose multiplier is not zero."""
        return self.solution.binding()


def pull_limit(
    model: Model, phi_rad: float, pull: Pull | None = None, rigid: Array | None = None
) -> PullLimit:
    """The largest pull at heading φ, certified.

    Raises
    ------
    NoSolution
        If the robot slips without any pull, or the certificate is not good enough.
    """
    from slipmargin.solve.clarabel_ import solve

    pull = Pull() if pull is None else pull
    if model.external.terms:
        state = np.zeros(model.count, dtype=bool) if rigid is None else rigid
        cone_limit(model, np.array([phi_rad]), pull, state)  # refuses a robot that slips without any pull
    solution = solve(limit_program(model, phi_rad, pull, rigid)).proven()
    return PullLimit(force_N=-solution.value * model.inertia.weight_N, solution=solution)
