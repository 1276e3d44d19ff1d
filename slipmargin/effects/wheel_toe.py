"""The effect ``wheel_toe``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.physics.frames import rotate_rows
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelToe(WheelEffect):
    """ŝ_i, ĝ_i, f̂_i turned by toe_rad about the vertical."""

    name = "wheel_toe"
    summary = "A wheel is mounted at an angle."
    traced_to = Trace.WHEEL
    part = Part.CONTACTS
    scope = Scope.MACHINE
    parameters = (
        parameter("toe_rad", "rad", (-0.5, 0.0, 0.5), 0.01, "angle of the wheel from where it should point"),
    )
    all_wheels, one_wheel = False, True
    source = "Fig. 3, direction of the wheels; positive counter-clockwise from above"
    confirm = "lay a straight edge along the wheel, or swap two wheels and see that the error stays"

    toe_rad: float

    def rewrite(self, part: WheelGeometry, nominal: Model) -> WheelGeometry:
        """WheelGeometry with turned wheels."""
        angle = self.mask(nominal) * self.toe_rad
        drive, grip, free = (rotate_rows(angle, v) for v in (part.drive, part.grip, part.free))
        return replace(part, drive=drive, grip=grip, free=free)
