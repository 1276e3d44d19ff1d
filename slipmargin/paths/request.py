"""What is asked of a plan."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

from slipmargin.checks import FASTEST_M_S, real
from slipmargin.limits.motion_state import Contact
from slipmargin.paths.along import Caps
from slipmargin.paths.grid import check_points


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Request:
    """What a plan has to obey.

    ``share`` λ = 1 − margin of every wheel's grip, of every motor's torque and of what lifts a wheel;
    ``start_m_s`` and ``end_m_s`` are speeds over the floor at the ends, those of the wheels where the robot
    turns on the spot there;
    ``contact`` what the wheels stand on (UNKNOWN: robust).
    """

    share: float = 0.9
    points: int = 400
    start_m_s: float = 0.0
    end_m_s: float = 0.0
    caps: Caps = field(default_factory=Caps)
    contact: Contact = Contact.ROLLERS

    def __post_init__(self) -> None:
        check_points(self.points)
        real("margin", 1.0 - self.share, low=0.0, high=0.99, cure="give a slip margin from 0 to 0.99")
        for place, speed in (("start_speed_m_s", self.start_m_s), ("end_speed_m_s", self.end_m_s)):
            cure = f"give a speed along the path from 0 to {FASTEST_M_S:g} m/s"
            real(place, speed, low=0.0, high=FASTEST_M_S, cure=cure)
