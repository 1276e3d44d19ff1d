"""The effect ``friction_coefficients``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, Variant, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionCoefficients(WheelEffect):
    """μ_W ← μ_W · drive_factor, μ_T ← μ_T · transverse_factor on rollers; k ← k · steepness_factor."""

    name = "friction_coefficients"
    summary = "The coefficients were measured wrongly, or the floor is another one."
    traced_to = Trace.COEFFICIENT
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter("drive_factor", "1", (0.05, 1.0, 20.0), 0.05, "true over stated drive coefficient"),
        parameter(
            "transverse_factor", "1", (0.0, 1.0, 50.0), 0.05, "true over stated transverse coefficient"
        ),
        parameter(
            "steepness_factor",
            "1",
            (0.01, 1.0, 100.0),
            0.2,
            "true over stated steepness k of eq. (11)",
            starts=(0.3, 3.0),
        ),
    )
    variants = (
        Variant(free=("drive_factor", "transverse_factor")),
        Variant(free=("drive_factor", "transverse_factor", "steepness_factor"), label="with their steepness"),
    )
    source = "Williams et al. 2002, Table I and eq. (11); above 1 = more friction than stated"
    confirm = (
        "tilt board in both roller directions: the coefficient is the tangent of the angle at which it slides"
    )

    drive_factor: float
    transverse_factor: float
    steepness_factor: float = 1.0

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
