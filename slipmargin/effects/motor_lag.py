"""The effect ``motor_lag``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, WheelEffect, parameter
from slipmargin.errors import InputError
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MotorLag(WheelEffect):
    """τ ω̇_i = ω_cmd,i(t − delay) − ω_i; the dead time is that of all wheels."""

    name = "motor_lag"
    summary = "The wheels follow their command late."
    traced_to = Trace.ACTUATION
    part = Part.TRANSIENTS
    scope = Scope.MACHINE
    parameters = (
        parameter("lag_s", "s", (0.0, 0.0, 2.0), 0.02, "time constant of the wheel speed"),
        parameter("delay_s", "s", (0.0, 0.0, 1.0), 0.01, "dead time before a command acts", starts=(0.0,)),
    )
    needs_commands = True
    source = "first-order speed loop; positive = later"
    confirm = "log the measured wheel speeds beside the commands"

    lag_s: float
    delay_s: float = 0.0

    def __post_init__(self) -> None:
        Effect.__post_init__(self)
        if self.wheels and self.delay_s != 0.0:
            raise InputError(
                "delay_s",
                f"is {self.delay_s:g}, but a dead time acts on every wheel",
                "set it to 0, or leave out wheels",
            )

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics with lag and dead time."""
        return replace(
            part,
            lag_s=part.lag_s + self.mask(nominal) * self.lag_s,
            delay_s=part.delay_s + self.delay_s,
        )
