"""The effect ``floor_patch``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.effects.places import EDGE, EDGE_M, PLACE_RADIUS, PLACE_X, PLACE_Y, place
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPatch(Effect):
    """μ_i ← μ_i [1 + (factor − 1) s(d_i)], d_i from contact to centre; s is 1 inside the radius, else 0.

    s(d) = (1 − tanh((d − radius)/2w))/2 with an edge of width w.
    """

    name = "floor_patch"
    summary = (
        "A round patch of the floor grips less, or more, than the rest (oil, dust, tape, another coating)."
    )
    traced_to = Trace.POSITION
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "factor",
            "1",
            (0.0, 1.0, 5.0),
            0.1,
            "friction on the patch over that beside it",
            starts=(0.5,),
            near=(0.3, 0.7, 1.5),
        ),
        *place("centre", "centre of the patch on the floor", 0.02, (PLACE_X, PLACE_Y), along="position"),
        parameter(
            "radius_m",
            "m",
            (0.0, 0.2, 10.0),
            0.02,
            "radius of the patch",
            starts=PLACE_RADIUS,
            idle=True,
            along="position",
        ),
        EDGE,
    )
    source = "friction of a floor that is not everywhere the same; factor below 1 = slicker than the rest"
    confirm = "wipe the place clean, or drag a locked wheel across it and read the force"

    factor: float
    centre_x_m: float = 0.0
    centre_y_m: float = 0.0
    radius_m: float = 0.2
    edge_m: float = EDGE_M

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip that changes where a contact stands on the patch."""
        patch = Multiplier(
            variable=Variable.FROM_PLACE,
            basis=Basis.STEP,
            target=Target.BOTH,
            shape=np.array([self.radius_m, self.edge_m]),
            coefficients=np.array([self.factor - 1.0]),
            wheels=np.ones(nominal.count),
            place=np.array([self.centre_x_m, self.centre_y_m, 0.0]),
        )
        return replace(part, multipliers=(*part.multipliers, patch))
