"""The effect ``floor_nap``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable

#: Where fits start: a nap of 0.3 in three directions [1].
_X, _Y = (0.3, -0.15, -0.15), (0.0, 0.26, -0.26)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorNap(WheelEffect):
    """μ ← μ [1 + nap_x cos β + nap_y sin β], β the floor-frame direction in which the contact slides."""

    name = "floor_nap"
    summary = "The floor grips differently along and against its nap."
    traced_to = Trace.HEADING
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "nap_x",
            "1",
            (-0.9, 0.0, 0.9),
            0.05,
            "relative change of friction when sliding towards +x",
            starts=_X,
        ),
        parameter(
            "nap_y",
            "1",
            (-0.9, 0.0, 0.9),
            0.05,
            "relative change of friction when sliding towards +y",
            starts=_Y,
        ),
    )
    source = "directional friction of pile fabrics; positive = more friction sliding towards +x, +y"
    confirm = "drag a locked wheel over the floor in four directions and read the force"

    nap_x: float
    nap_y: float

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip that depends on the sliding direction over the floor."""
        nap = Multiplier(
            variable=Variable.SLIP_HEADING,
            basis=Basis.FOURIER,
            target=Target.BOTH,
            coefficients=np.array([self.nap_x, self.nap_y]),
            shape=np.array([2.0 * np.pi, 0.0]),
            wheels=self.mask(nominal),
        )
        return replace(part, multipliers=(*part.multipliers, nap))
