"""What rollers that do not turn may add to a limit of motion, and take from it (docs/theory.md, section 8).

Where all wheels roll along their drive directions (a mecanum robot straight ahead) no roller turns.  Limits
of motion then count no roller friction: neither what it holds, as at rest, while the wheels creep along the
motion, nor the drag that it becomes once the robot drifts to a side faster than its wheels creep.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.limits.bounds import Directions, ahead_of, starting
from slipmargin.limits.every_motion import BESIDE
from slipmargin.limits.motion_friction import STILL
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_rows import CAUSES, GRIP
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model

#: Halvings of the interval in which the helped limit lies.
_HALVINGS = 50


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class StillRollers:
    """Speeding up [m/s²] in a direction in which no roller turns: with their help, and with their drag."""

    heading_rad: float
    helped_m_s2: float
    dragged_m_s2: float


def still_rollers(model: Model, found: Directions, contact: Contact) -> StillRollers | None:
    """The strongest direction of ``found`` (all of the grip) with rollers that help and that drag.

    None where some roller turns in it, where wheels may stand on rigid material, or where something other
    than the grip limits it.
    """
    if contact is not Contact.ROLLERS:
        return None
    at = found.strongest
    heading = float(found.heading_rad[at])
    limit, ahead = float(found.starting_m_s2[at]), ahead_of(np.array([heading]))
    slide = np.max(np.abs(ahead @ model.geometry.lateral_rows().T))
    if slide > STILL or limit <= 0.0 or found.starting.cause[at] != CAUSES[GRIP]:
        return None
    motion = Motion.full_drag(ahead)

    def holds(acceleration: float) -> bool:
        asked = Motion(velocity=motion.velocity, acceleration=acceleration * ahead)
        return bool(np.max(realised(model, asked, contact=contact).use) <= 1.0)

    low, high = 0.0, 2.0 * limit
    while holds(high):
        low, high = high, 2.0 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    beside = starting(model, np.array([heading - BESIDE, heading + BESIDE]), contact=contact).value
    return StillRollers(heading_rad=heading, helped_m_s2=low, dragged_m_s2=float(np.min(beside)))
