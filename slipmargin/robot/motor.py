"""The motors of a robot, as the robot file describes them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

from slipmargin.errors import InputError
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
            needs=(("stall_torque_N_m", ""),),
            vary=("reflected_inertia_kg_m2",),
        ),
    )

    rotor_inertia_kg_m2: float | None = field(
        default=None,
        metadata=number(
            "kg m²",
            "inertia of a motor's rotor about its own axis; at the wheel times `gear_ratio` squared",
            0.0,
            1e6,
            above=True,
            reason="instead of `reflected_inertia_kg_m2`, where the wheel itself may be left out",
            needs=(("stall_torque_N_m", ""), ("gear_ratio", "")),
        ),
    )
    gear_ratio: float | None = field(
        default=None,
        metadata=number(
            "1",
            "turns of the rotor per turn of the wheel; speed and torque stay those of the wheel",
            0.0,
            1e5,
            above=True,
            needs=(("rotor_inertia_kg_m2", ""),),
        ),
    )
    nominal_voltage_V: float | None = field(
        default=None,
        metadata=number(
            "V",
            "voltage for which speed and torque are stated",
            0.0,
            1e5,
            above=True,
            needs=(("supply_voltage_V", ""),),
        ),
    )
    supply_voltage_V: float | None = field(
        default=None,
        metadata=number(
            "V",
            "voltage that the motors get, a battery's under load; speed and torque are in proportion to it",
            0.0,
            1e5,
            above=True,
            needs=(("nominal_voltage_V", ""),),
        ),
    )

    def __post_init__(self) -> None:
        check(self)
        if self.rotor_inertia_kg_m2 is not None and self.reflected_inertia_kg_m2 is not None:
            raise InputError(
                "rotor_inertia_kg_m2",
                "says the same as reflected_inertia_kg_m2",
                "leave one of the two out",
            )

    def at_the_wheel(self) -> tuple[float, float | None, float | None]:
        """Top speed [rad/s], stall torque [N m] and turned inertia [kg m²] of a wheel at the supply voltage.

        The torque–speed line of a direct-current motor moves with its voltage: both ends in proportion.
        """
        volts = 1.0
        if self.supply_voltage_V is not None and self.nominal_voltage_V is not None:
            volts = self.supply_voltage_V / self.nominal_voltage_V
        inertia = self.reflected_inertia_kg_m2
        if self.rotor_inertia_kg_m2 is not None and self.gear_ratio is not None:
            inertia = self.rotor_inertia_kg_m2 * self.gear_ratio**2
        stall = None if self.stall_torque_N_m is None else volts * self.stall_torque_N_m
        return volts * self.max_speed_rad_s, stall, inertia
