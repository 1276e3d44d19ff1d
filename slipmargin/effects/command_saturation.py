"""The effect ``command_saturation``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Quantity, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CommandSaturation(WheelEffect):
    """|ω_i| ≤ 1/saturation, and ω_i = ω_cmd,i wherever that is possible."""

    name = "command_saturation"
    summary = "A wheel does not reach the speed that it is told: its motor's top speed lies below that."
    traced_to = Trace.ACTUATION
    part = Part.TRANSIENTS
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "saturation_s_per_rad",
            "s/rad",
            (0.0, 0.0, 2.0),
            0.01,
            "one over the wheel's top speed",
            starts=(0.05, 0.1, 0.2, 0.03, 0.07, 0.14),
        ),
    )
    one_wheel = True
    needs_commands = True
    source = "a motor at the end of its voltage (an empty battery, one worn motor); positive = slower"
    confirm = "lift the robot, command a wheel ever faster, and read where its speed stays behind"

    saturation_s_per_rad: float

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics of wheels that turn no faster."""
        if self.saturation_s_per_rad == 0.0:
            return part
        top = np.where(self.mask(nominal) > 0.0, 1.0 / self.saturation_s_per_rad, np.inf)
        return replace(part, top_rad_s=np.minimum(part.top_rad_s, top))

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """The fastest that such a wheel turns."""
        del model
        size = self.saturation_s_per_rad
        return () if size == 0.0 else (Quantity(name="top_speed_rad_s", value=1.0 / size, unit="rad/s"),)
