"""The effect ``command_dead_band``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ActuatorDynamics
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Variable

#: Width of the edge, as a share of the band [1]: narrow beside it, and wide enough that a fit sees its slope.
_EDGE = 0.05


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CommandDeadBand(WheelEffect):
    """ω_i = ω_cmd,i (1 − s(|ω_cmd,i|)), s from 1 below the band to 0 above, over a twentieth of it."""

    name = "command_dead_band"
    summary = "A wheel that is commanded to turn slowly stands: its drive has a dead band."
    traced_to = Trace.ACTUATION
    part = Part.TRANSIENTS
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "dead_band_rad_s",
            "rad/s",
            (0.0, 0.0, 20.0),
            0.1,
            "commanded speed below which a wheel stands",
            starts=(0.3, 1.0, 3.0, 0.5, 1.7, 6.0),
        ),
    )
    needs_commands = True
    source = "a motor controller's neutral dead band, or friction that a small command does not overcome"
    confirm = "lift the robot, command a wheel ever faster, and read when it begins to turn"

    dead_band_rad_s: float

    def rewrite(self, part: ActuatorDynamics, nominal: Model) -> ActuatorDynamics:
        """ActuatorDynamics that answer no small command."""
        band = self.dead_band_rad_s
        if band == 0.0:
            return part
        stands = Multiplier(
            variable=Variable.COMMAND_SPEED,
            basis=Basis.STEP,
            shape=np.array([band, _EDGE * band]),
            coefficients=np.array([-1.0]),
            wheels=self.mask(nominal),
        )
        return replace(part, multipliers=(*part.multipliers, stands))
