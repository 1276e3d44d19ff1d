"""Under load the wheels turn slower than told."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedDroop(Effect):
    """ω_i = ω_cmd,i · gain − droop · T_i, T_i the torque the wheel delivers to the floor."""

    name: ClassVar[str] = "speed_droop"
    traced_to: ClassVar[Trace] = Trace.ACTUATION
    part: ClassVar[Part] = Part.TRANSIENTS
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="droop_rad_s_per_N_m",
            unit="rad/(s N m)",
            low=0.0,
            high=500.0,
            null=0.0,
            scale=2.0,
            meaning="speed lost per torque delivered",
        ),
        Parameter(
            name="speed_factor",
            unit="1",
            low=0.2,
            high=2.0,
            null=1.0,
            scale=0.02,
            meaning="true over commanded speed without load",
        ),
    )
    source: ClassVar[str] = "the motor’s straight torque–speed line; positive = slower under load"
    confirm: ClassVar[str] = "log the measured wheel speeds beside the commands, once with a heavier robot"

    droop_rad_s_per_N_m: float
    speed_factor: float = 1.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics with droop."""
        mask = self.mask(nominal)
        return replace(
            part,
            droop_rad_s_per_N_m=part.droop_rad_s_per_N_m + mask * self.droop_rad_s_per_N_m,
            gain=part.gain * (1.0 + mask * (self.speed_factor - 1.0)),
        )
