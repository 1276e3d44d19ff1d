"""A standard move planned with the believed and with the corrected model, and whether the old plan slips."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.errors import NoSolution
from slipmargin.model import Model
from slipmargin.paths.path import Path
from slipmargin.paths.pieces import line
from slipmargin.paths.plan import Plan, Request, plan
from slipmargin.paths.sample import trajectory, use_along

#: The move: one metre diagonally, to the right and forwards at once, with a quarter turn; a tenth of the
#: grip kept in reserve.
MOVE = (np.sqrt(0.5), np.sqrt(0.5), np.pi / 2.0)
MARGIN = 0.1
_POINTS = 150


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlanChange:
    """The move as each model plans it.

    Parameters
    ----------
    before_s, after_s : float or None
        Duration of the plan [s]; None where that model finds no motion without slip.
    use_believed, use_real : float or None
        Largest share of a wheel's grip that the believed model's plan takes, by the believed and by the
        corrected model: above 1 it slips.
    """

    before_s: float | None
    after_s: float | None
    use_believed: float | None
    use_real: float | None


def plan_change(believed: Model, corrected: Model) -> PlanChange:
    """Plan the move with both models and ask the corrected one about the believed one's plan."""
    arm = float(np.max(np.hypot(*(believed.geometry.position_m - believed.inertia.com_m).T)))
    goal = np.array([*believed.convention.from_right_forward(*MOVE[:2]), MOVE[2]])
    path = Path(pieces=(line(np.zeros(3), goal, arm),))
    old = _plan(believed, path)
    new = old if corrected is believed else _plan(corrected, path)
    return PlanChange(
        before_s=None if old is None else old.duration_s,
        after_s=None if new is None else new.duration_s,
        use_believed=None if old is None else old.max_use,
        use_real=None if old is None else _use(corrected, old),
    )


def _plan(model: Model, path: Path) -> Plan | None:
    try:
        return plan(model, path, Request(share=1.0 - MARGIN, points=_POINTS))
    except NoSolution:
        return None


def _use(model: Model, made: Plan) -> float | None:
    """Largest use of a plan by another model; None where its forces have no balance at all."""
    way = trajectory(made)
    try:
        return float(np.max(use_along(model, way.t_s, way.pose, way.velocity, way.acceleration)))
    except NoSolution:
        return None
