"""The effect ``wheel_radius``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelRadius(WheelEffect):
    """ρ_i ← ρ_i · radius_factor."""

    name = "wheel_radius"
    summary = "A wheel is larger or smaller than the file says: worn, swapped or pressed in."
    traced_to = Trace.WHEEL
    part = Part.CONTACTS
    scope = Scope.MACHINE
    parameters = (parameter("radius_factor", "1", (0.5, 1.0, 2.0), 0.01, "true over stated radius"),)
    all_wheels, one_wheel = False, True
    source = "eq. (2), the wheel’s peripheral speed; above 1 = larger wheel"
    confirm = (
        "measure the wheel with a caliper under load, or swap two wheels and see whether the error moves"
        " along"
    )

    radius_factor: float

    def rewrite(self, part: WheelGeometry, nominal: Model) -> WheelGeometry:
        """WheelGeometry with another wheel radius."""
        return replace(part, radius_m=part.radius_m * (1.0 + self.mask(nominal) * (self.radius_factor - 1.0)))
