"""The effect ``wheel_wobble``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import IN_MOTIONS, Part, Quantity, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.physics.kinematics import WheelGeometry

#: Where fits start: about 6° in three directions.  Less hardly shows beside what wheels slip [rad].
_COSINE, _SINE = (0.1, -0.05, -0.05), (0.0, 0.087, -0.087)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelWobble(WheelEffect):
    """ŝ_i, ĝ_i, f̂_i turned by cosine_rad · cos θ_i + sine_rad · sin θ_i about the vertical.

    The wheel is not square to its axle, or that is bent.  The robot weaves once a turn of the wheel.
    Limits are those of wheels that run true.
    """

    name = "wheel_wobble"
    summary = "A wheel wobbles: its axle is bent, or it is not square on its axle."
    traced_to = Trace.WHEEL_ANGLE
    part = Part.CONTACTS
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "cosine_rad",
            "rad",
            (-0.5, 0.0, 0.5),
            0.01,
            "angle of the wheel from where it should point at wheel angle 0",
            starts=_COSINE,
        ),
        parameter(
            "sine_rad", "rad", (-0.5, 0.0, 0.5), 0.01, "the same a quarter of a turn later", starts=_SINE
        ),
    )
    all_wheels, one_wheel = False, True
    needs_wheel_phase = True
    needs_wheel_angles = True
    counts_in = IN_MOTIONS + "wheels that run true"
    source = "Fig. 3, direction of the wheels, at the wheel's angle; positive counter-clockwise from above"
    confirm = "lift the robot, turn the wheel and see from above how far its rim swings to and fro"

    cosine_rad: float
    sine_rad: float = 0.0

    def rewrite(self, part: WheelGeometry, nominal: Model) -> WheelGeometry:
        """WheelGeometry whose wheels wobble by as much more."""
        more = self.mask(nominal)[:, None] * np.array([self.cosine_rad, self.sine_rad])
        return replace(part, wobble=part.wobble + more)

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """How far the front of the rim swings from side to side in one turn."""
        radius = float(np.max(self.mask(model) * model.geometry.radius_m))
        swing = float(np.hypot(self.cosine_rad, self.sine_rad))
        return (Quantity(name="rim_swings_m", value=2.0 * radius * float(np.sin(swing)), unit="m"),)
