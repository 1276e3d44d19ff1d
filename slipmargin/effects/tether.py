"""The effect ``tether``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, Variant, parameter
from slipmargin.effects.places import place
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable

#: Farther from the middle of where the runs were an anchor pulls the same everywhere, as a slope does [m].
_WITHIN_M = 5.0
#: Where fits put the anchor first: there, and 1.5 m away all around [m].
_X = (0.0, *(1.5 * math.cos(k * math.pi / 3.0) for k in range(6)))
_Y = (0.0, *(1.5 * math.sin(k * math.pi / 3.0) for k in range(6)))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Tether(Effect):
    """F = k (anchor − p) in the floor frame: no pull at the anchor, more the farther away.

    It acts ``height_m`` above the floor and so shifts load to the wheels on its side.
    """

    name = "tether"
    summary = "A cable pulls the robot towards where it is held."
    traced_to = Trace.POSITION
    part = Part.LOSSES
    scope = Scope.LOADING
    parameters = (
        parameter("stiffness_N_per_m", "N/m", (0.0, 0.0, 200.0), 0.5, "pull per distance from the anchor"),
        *place("anchor", "where it does not pull", 0.1, (_X, _Y), within_m=_WITHIN_M),
        parameter("height_m", "m", (0.0, 0.0, 2.0), 0.05, "height above the floor at which the cable pulls"),
    )
    variants = (Variant(free=("stiffness_N_per_m", "anchor_x_m", "anchor_y_m")),)
    source = (
        "Williams et al. 2002, section III.B.2 (the cables are held by hand); positive = towards the anchor"
    )
    confirm = "hold the cable elsewhere and repeat one trial"

    stiffness_N_per_m: float
    anchor_x_m: float
    anchor_y_m: float
    height_m: float = 0.0

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the cable’s pull."""
        k = self.stiffness_N_per_m

        def pull(variable: Variable, basis: Basis, fx: float, fy: float) -> ForceTerm:
            return ForceTerm(
                variable=variable,
                basis=basis,
                shape=np.ones(2),
                frame=Frame.FLOOR,
                coefficients=np.array([[fx], [fy], [0.0]]),
                height_m=self.height_m,
            )

        return replace(
            part,
            terms=(
                *part.terms,
                pull(Variable.UNITY, Basis.CONSTANT, k * self.anchor_x_m, k * self.anchor_y_m),
                pull(Variable.POSITION_X, Basis.POLYNOMIAL, -k, 0.0),
                pull(Variable.POSITION_Y, Basis.POLYNOMIAL, 0.0, -k),
            ),
        )
