"""The effect ``floor_border``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.effects.places import EDGE, EDGE_M, LINE_DIRECTION, LINE_OFFSET, line
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorBorder(Effect):
    """μ_i ← factor μ_i for contacts beyond a straight line: n·x_i > offset, n at ``direction_rad``.

    1 + (factor − 1)(1 + tanh((n·x_i − offset)/2w))/2 with an edge of width w.
    """

    name = "floor_border"
    summary = "Beyond a straight line the floor is another one."
    traced_to = Trace.POSITION
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "factor",
            "1",
            (0.0, 1.0, 5.0),
            0.1,
            "friction beyond the border over that before it",
            starts=(0.7,),
        ),
        *line(
            "distance of the border from the floor's origin along its normal",
            "direction of the normal, which points beyond the border",
            LINE_OFFSET,
            LINE_DIRECTION,
        ),
        EDGE,
    )
    source = "two floors that meet at a line; factor below 1 = slicker beyond it"
    confirm = "repeat one manoeuvre wholly on either side of the line"

    factor: float
    offset_m: float = 0.0
    direction_rad: float = 0.0
    edge_m: float = EDGE_M

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip that changes beyond the border."""
        normal = np.array([np.cos(self.direction_rad), np.sin(self.direction_rad)])
        border = Multiplier(
            variable=Variable.BEFORE_LINE,
            basis=Basis.STEP,
            target=Target.BOTH,
            shape=np.array([0.0, self.edge_m]),
            coefficients=np.array([self.factor - 1.0]),
            wheels=np.ones(nominal.count),
            place=np.array([*(self.offset_m * normal), self.direction_rad]),
        )
        return replace(part, multipliers=(*part.multipliers, border))
