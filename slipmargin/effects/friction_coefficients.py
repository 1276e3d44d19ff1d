"""The coefficients were measured wrongly, or the floor is another one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionCoefficients(Effect):
    """μ_W ← μ_W · drive_factor, μ_T ← μ_T · transverse_factor, on rollers."""

    name: ClassVar[str] = "friction_coefficients"
    traced_to: ClassVar[Trace] = Trace.COEFFICIENT
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="drive_factor",
            unit="1",
            low=0.05,
            high=20.0,
            null=1.0,
            scale=0.05,
            meaning="true over stated drive coefficient",
        ),
        Parameter(
            name="transverse_factor",
            unit="1",
            low=0.0,
            high=50.0,
            null=1.0,
            scale=0.05,
            meaning="true over stated transverse coefficient",
        ),
    )
    source: ClassVar[str] = "Williams et al. 2002, Table I and eq. (11); above 1 = more friction than stated"
    confirm: ClassVar[str] = (
        "tilt board in both roller directions: the coefficient is the tangent of the angle at which it slides"
    )

    drive_factor: float
    transverse_factor: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with other coefficients on rollers."""
        factor = np.array([self.drive_factor, self.transverse_factor])
        weight = self.mask(nominal)[:, None]
        return replace(part, roller=part.roller * (1.0 + weight * (factor - 1.0)))
