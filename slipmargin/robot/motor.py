"""The motors of a robot, as the robot file describes them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

from slipmargin.robot.fields import check, number


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """Drive limits on the wheel side; a straight torque–speed line if both are given."""

    max_speed_rad_s: float = field(
        metadata=number(
            "rad/s",
            "top speed of a wheel without load",
            0.0,
            1e6,
            above=True,
            vary=("max_speed_rad_s",),
        )
    )
    stall_torque_N_m: float | None = field(
        default=None,
        metadata=number(
            "N m",
            "torque on a wheel at standstill; it falls in a straight line to none at the top speed",
            0.0,
            1e6,
            above=True,
            vary=("stall_torque_N_m",),
        ),
    )
    reflected_inertia_kg_m2: float | None = field(
        default=None,
        metadata=number(
            "kg m²",
            "inertia that a motor turns, at the wheel: wheel plus rotor times gear ratio squared",
            0.0,
            1e6,
            above=True,
            needs=("stall_torque_N_m", ""),
            vary=("reflected_inertia_kg_m2",),
        ),
    )

    def __post_init__(self) -> None:
        check(self)
