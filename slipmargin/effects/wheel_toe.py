"""A wheel is mounted at an angle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelToe(Effect):
    """ŝ_i, ĝ_i, f̂_i turned by toe_rad about the vertical."""

    name: ClassVar[str] = "wheel_toe"
    traced_to: ClassVar[Trace] = Trace.WHEEL
    part: ClassVar[Part] = Part.CONTACTS
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="toe_rad",
            unit="rad",
            low=-0.5,
            high=0.5,
            null=0.0,
            scale=0.01,
            meaning="angle of the wheel from where it should point",
        ),
    )
    source: ClassVar[str] = "Fig. 3, direction of the wheels; positive counter-clockwise from above"
    confirm: ClassVar[str] = (
        "lay a straight edge along the wheel, or swap two wheels and see that the error stays"
    )

    toe_rad: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: WheelGeometry, nominal: Model) -> WheelGeometry:
        """WheelGeometry with turned wheels."""
        angle = self.mask(nominal) * self.toe_rad
        cos, sin = np.cos(angle), np.sin(angle)
        turn = np.stack([np.stack([cos, -sin], -1), np.stack([sin, cos], -1)], 1)
        drive, grip, free = (np.einsum("nij,nj->ni", turn, v) for v in (part.drive, part.grip, part.free))
        return replace(part, drive=drive, grip=grip, free=free)
