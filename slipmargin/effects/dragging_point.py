"""The effect ``dragging_point``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable

#: Where fits look for the place: six around the middle, in shares of the wheels' mean distance from it.
_AROUND = tuple(0.7 * math.cos(k * math.pi / 3.0) for k in range(6))
_UP = tuple(0.7 * math.sin(k * math.pi / 3.0) for k in range(6))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class DraggingPoint(Effect):
    """F ← F − force · v_p/|v_p| at the place p of the body, with its moment; v_p is the velocity of p."""

    name = "dragging_point"
    summary = (
        "Something drags over the floor at one place of the robot: a castor, a skid, a sprung tracking wheel."
    )
    traced_to = Trace.VELOCITY
    part = Part.LOSSES
    scope = Scope.LOADING
    parameters = (
        parameter("force_N", "N", (-10.0, 0.0, 1000.0), 0.3, "drag against the motion of the place", meant=1),
        parameter(
            "place_x_m",
            "m",
            (-5.0, 0.0, 5.0),
            0.01,
            "place of the body, x",
            starts=_AROUND,
            idle=True,
            along="body",
        ),
        parameter(
            "place_y_m", "m", (-5.0, 0.0, 5.0), 0.01, "the same, y", starts=_UP, idle=True, along="body"
        ),
    )
    source = "dry friction of what is pulled along; positive = against the motion of the place"
    confirm = "lift the castor, skid or cable and drive the same runs once more"

    force_N: float
    place_x_m: float = 0.0
    place_y_m: float = 0.0

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the drag."""
        del nominal
        drag = ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            frame=Frame.AT_PLACE,
            shape=np.array([1.0, 0.0]),
            coefficients=np.array([[self.force_N], [0.0], [0.0]]),
            place_m=np.array([self.place_x_m, self.place_y_m]),
        )
        return replace(part, terms=(*part.terms, drag))
