"""The effect ``command_ramp``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Quantity, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CommandRamp(Effect):
    """|ω̇_i| ≤ 1/ramp, and ω_i = ω_cmd,i wherever that is possible."""

    name = "command_ramp"
    summary = "The drives ramp their commands: no wheel's speed changes faster than they allow."
    traced_to = Trace.ACTUATION
    part = Part.TRANSIENTS
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "ramp_s2_per_rad",
            "s²/rad",
            (0.0, 0.0, 1.0),
            0.001,
            "time that the speed of a wheel takes for a change of 1 rad/s",
            starts=(0.01, 0.02, 0.04, 0.005, 0.08),
        ),
    )
    needs_commands = True
    source = "a motor controller's ramp (open-loop ramp, slew rate, acceleration limit); positive = slower"
    confirm = "read the controller's ramp or acceleration limit, or command a step and log the wheel speeds"

    ramp_s2_per_rad: float

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics with as much more of a ramp."""
        del nominal
        return replace(part, ramp_s2_per_rad=part.ramp_s2_per_rad + self.ramp_s2_per_rad)

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """The fastest change of a wheel's speed."""
        ramp = model.actuators.ramp_s2_per_rad
        return () if ramp == 0.0 else (Quantity(name="fastest_rad_s2", value=1.0 / ramp, unit="rad/s²"),)
