"""The effect ``floor_tilt``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorTilt(Effect):
    """Weight on a slope: F = m g sin|t| along t = (tilt_x, tilt_y) in the floor frame, Σ N_i = m g cos|t|.

    |t| is the angle of the slope and t points downhill.  F acts at the height of the centre of mass, so
    the wheels below carry more.
    """

    name = "floor_tilt"
    summary = "The floor is not level."
    traced_to = Trace.CONSTANT_FORCE
    part = Part.LOSSES
    scope = Scope.FLOOR
    parameters = (
        parameter("tilt_x_rad", "rad", (-0.3, 0.0, 0.3), 0.003, "slope down towards +x"),
        parameter("tilt_y_rad", "rad", (-0.3, 0.0, 0.3), 0.003, "slope down towards +y"),
    )
    source = "weight on an inclined plane; positive = downhill towards +x, +y of the floor frame"
    confirm = "a spirit level on the floor, or run the same trial turned by 180 degrees"

    tilt_x_rad: float
    tilt_y_rad: float

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the slope's pull."""
        weight, tilt = nominal.inertia.weight_N, np.array([self.tilt_x_rad, self.tilt_y_rad])
        angle = float(np.hypot(*tilt))
        along = weight * np.sinc(angle / np.pi) * tilt  # sin|t| t/|t|, also where t is zero
        term = ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            coefficients=np.array([[along[0]], [along[1]], [0.0]]),
            shape=np.ones(2),
            frame=Frame.FLOOR,
            height_m=None,
            lift_N=weight * (1.0 - np.cos(angle)),
        )
        return replace(part, terms=(*part.terms, term))
