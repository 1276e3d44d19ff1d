"""The coefficients were measured wrongly, or the floor is another one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionCoefficients(Effect):
    """μ_W ← μ_W · drive_factor, μ_T ← μ_T · transverse_factor on rollers; k ← k · steepness_factor."""

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
        Parameter(
            name="steepness_factor",
            unit="1",
            low=0.01,
            high=100.0,
            null=1.0,
            scale=0.2,
            meaning="true over stated steepness k of eq. (11)",
            starts=(0.3, 3.0),
        ),
    )
    source: ClassVar[str] = "Williams et al. 2002, Table I and eq. (11); above 1 = more friction than stated"
    confirm: ClassVar[str] = (
        "tilt board in both roller directions: the coefficient is the tangent of the angle at which it slides"
    )

    drive_factor: float
    transverse_factor: float
    steepness_factor: float = 1.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with other coefficients on rollers."""
        factor = np.array([self.drive_factor, self.transverse_factor])
        weight = self.mask(nominal)
        roller = part.roller * (1.0 + weight[:, None] * (factor - 1.0))
        if self.steepness_factor == 1.0:
            return replace(part, roller=roller)
        steeper = Multiplier(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            target=Target.STIFFNESS,
            shape=np.array([1.0, 0.0]),
            coefficients=np.array([self.steepness_factor - 1.0]),
            wheels=weight,
        )
        return replace(part, roller=roller, multipliers=(*part.multipliers, steeper))
