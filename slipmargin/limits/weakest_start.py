"""The acceleration that every direction of motion allows, from a start to a brisk speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.bounds import headings, starting, top_speed
from slipmargin.limits.bounds_states import PACE
from slipmargin.limits.every_motion import turning_points
from slipmargin.limits.motion_state import Contact
from slipmargin.model import Model
from slipmargin.physics.variables import Variable

#: Speed up to which what resists motion is looked at, where the motors reach it [m/s].
BRISK_M_S = 1.0
#: Variables that follow the speed of the robot.
_BY_SPEED = frozenset(
    {
        Variable.SPEED,
        Variable.VELOCITY_X,
        Variable.VELOCITY_Y,
        Variable.HUB_SPEED,
        Variable.ROLLING_SPEED,
        Variable.PASSING_SPEED,
        Variable.SLIP_RATIO,
    }
)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WeakestStart:
    """The least safe speeding up over directions every degree and where a wheel's drag turns round.

    ``by_degree_m_s2`` (360,) is what each direction allows at a start.  ``start_m_s2`` is the least of a
    start; ``lowest_m_s2`` is lower where something that follows the speed leaves less at :data:`BRISK_M_S`,
    or at half of the motors' top speed.  ``cause`` is what sets that: grip, tips or motor torque.
    """

    by_degree_m_s2: Array
    start_m_s2: float
    lowest_m_s2: float
    cause: str


def weakest_start(model: Model, *, share: float = 1.0, contact: Contact = Contact.ROLLERS) -> WeakestStart:
    """The least safe speeding up in any direction, with a share of the grip."""
    degrees = headings(1.0)
    fine = np.concatenate([degrees, turning_points(model, 0.0) % (2.0 * np.pi)])
    order = np.argsort(fine, kind="stable")
    speeds: list[Array | None] = [None]
    variables = {t.variable for t in model.external.terms} | {m.variable for m in model.grip.multipliers}
    if np.any(model.grip.viscous_N_s_per_m) or variables & _BY_SPEED:
        speeds.append(np.minimum(BRISK_M_S, PACE * top_speed(model, fine[order])))
    found = [
        starting(model, fine[order], share=share, contact=contact, pace=PACE, speed_m_s=speed)
        for speed in speeds
    ]
    least = [float(np.min(f.value)) for f in found]
    lowest = found[int(np.argmin(least))]
    by_degree = np.empty(len(fine))
    by_degree[order] = found[0].value
    return WeakestStart(
        by_degree_m_s2=by_degree[: len(degrees)],
        start_m_s2=least[0],
        lowest_m_s2=min(least),
        cause=lowest.cause[int(np.argmin(lowest.value))],
    )
