"""The effect ``speed_droop``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedDroop(WheelEffect):
    """ω_i = ω_cmd,i · gain − droop · T_i, T_i the torque the wheel delivers to the floor."""

    name = "speed_droop"
    summary = "Under load the wheels turn slower than commanded."
    traced_to = Trace.ACTUATION
    part = Part.TRANSIENTS
    scope = Scope.MACHINE
    one_wheel = True
    parameters = (
        parameter(
            "droop_rad_s_per_N_m", "rad/(s N m)", (0.0, 0.0, 500.0), 2.0, "speed lost per torque delivered"
        ),
        parameter("speed_factor", "1", (0.2, 1.0, 2.0), 0.02, "true over commanded speed without load"),
    )
    needs_commands = True
    source = "the motor’s straight torque–speed line; positive = slower under load"
    confirm = "log the measured wheel speeds beside the commands, once with a heavier robot"

    droop_rad_s_per_N_m: float
    speed_factor: float = 1.0

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics with droop."""
        mask = self.mask(nominal)
        return replace(
            part,
            droop_rad_s_per_N_m=part.droop_rad_s_per_N_m + mask * self.droop_rad_s_per_N_m,
            gain=part.gain * (1.0 + mask * (self.speed_factor - 1.0)),
        )
