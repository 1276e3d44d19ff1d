"""The wheels follow their command late."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MotorLag(Effect):
    """τ ω̇_i = ω_cmd,i(t − delay) − ω_i."""

    name: ClassVar[str] = "motor_lag"
    traced_to: ClassVar[Trace] = Trace.ACTUATION
    part: ClassVar[Part] = Part.TRANSIENTS
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="lag_s",
            unit="s",
            low=0.0,
            high=2.0,
            null=0.0,
            scale=0.02,
            meaning="time constant of the wheel speed",
        ),
        Parameter(
            name="delay_s",
            unit="s",
            low=0.0,
            high=1.0,
            null=0.0,
            scale=0.01,
            meaning="dead time before a command acts",
            starts=(0.0,),
        ),
    )
    source: ClassVar[str] = "first-order speed loop; positive = later"
    confirm: ClassVar[str] = "log the measured wheel speeds beside the commands"

    lag_s: float
    delay_s: float = 0.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics with lag and dead time."""
        return replace(
            part,
            lag_s=part.lag_s + self.mask(nominal) * self.lag_s,
            delay_s=part.delay_s + self.delay_s,
        )
