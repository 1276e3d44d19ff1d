"""A wheel is larger or smaller than the file says: worn, swapped or pressed in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.physics.kinematics import WheelGeometry


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelRadius(Effect):
    """ρ_i ← ρ_i · radius_factor."""

    name: ClassVar[str] = "wheel_radius"
    traced_to: ClassVar[Trace] = Trace.WHEEL
    part: ClassVar[Part] = Part.CONTACTS
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="radius_factor",
            unit="1",
            low=0.5,
            high=2.0,
            null=1.0,
            scale=0.01,
            meaning="true over stated radius",
        ),
    )
    source: ClassVar[str] = "eq. (2), the wheel’s peripheral speed; above 1 = larger wheel"
    confirm: ClassVar[str] = (
        "measure the wheel with a caliper under load, or swap two wheels and see whether the error moves"
        " along"
    )

    radius_factor: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: WheelGeometry, nominal: Model) -> WheelGeometry:
        """WheelGeometry with another wheel radius."""
        return replace(part, radius_m=part.radius_m * (1.0 + self.mask(nominal) * (self.radius_factor - 1.0)))
