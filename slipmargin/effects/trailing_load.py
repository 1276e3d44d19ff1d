"""The effect ``trailing_load``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class TrailingLoad(WheelEffect):
    """Σ N_i (p_i − com) = −e W v̂: the floor carries each wheel a lever e ahead of its axle.

    It is a couple of two forces W, one against the motion at the height e and one along it at the
    floor.  So it shifts the loads and does not brake.  Some of the wheels count by their share of W.
    """

    name = "trailing_load"
    summary = "A driving robot rests on its trailing wheels: the contact pressure runs ahead of the axles."
    traced_to = Trace.VELOCITY
    part = Part.LOSSES
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "lever_m",
            "m",
            (-0.02, 0.0, 0.02),
            0.001,
            "how far ahead of its axle the floor carries a wheel (the lever of rolling resistance)",
            meant=1,
        ),
    )
    source = (
        "moment balance about the floor (docs/theory.md, section 3) with the lever of rolling resistance "
        "(Johnson, Contact Mechanics, ch. 9); positive = leading wheels lighter"
    )
    confirm = (
        "drive a path forwards and backwards: the lost share of the distance differs and swaps with the "
        "direction; the force that tows the robot, times the wheel radius, is the weight times e"
    )

    lever_m: float

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with a couple that tips the robot back."""
        rest = nominal.loads.rest_N
        carried = nominal.inertia.weight_N * float(self.mask(nominal) @ rest / np.sum(rest))
        against = ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            frame=Frame.AGAINST_MOTION,
            shape=np.array([1.0, 0.0]),
            coefficients=np.array([[carried], [0.0], [0.0]]),
            height_m=self.lever_m,
        )
        along = replace(against, coefficients=-against.coefficients, height_m=0.0)
        return replace(part, terms=(*part.terms, against, along))
