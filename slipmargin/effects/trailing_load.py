"""The effect ``trailing_load``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class TrailingLoad(WheelEffect):
    """N_i ← N_i (1 − (2 e/|p_i|) v̂·p̂_i): the floor carries each wheel a lever e ahead of its axle.

    From Σ N_i (p_i + e v̂) = W p_com for wheels spread evenly on a circle with nearly equal loads.
    It acts through both friction coefficients of a wheel, which is the same as its load.
    """

    name = "trailing_load"
    summary = "A driving robot rests on its trailing wheels: the contact pressure runs ahead of the axles."
    traced_to = Trace.VELOCITY
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "lever_m",
            "m",
            (-0.02, 0.0, 0.02),
            0.001,
            "how far ahead of its axle the floor carries a wheel (the lever of rolling resistance)",
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

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip whose friction falls with how much a wheel leads."""
        reach = np.hypot(*(nominal.geometry.position_m - nominal.inertia.com_m).T)
        lead = Multiplier(
            variable=Variable.LEAD,
            basis=Basis.POLYNOMIAL,
            target=Target.BOTH,
            shape=np.array([1.0, 0.0]),
            coefficients=np.array([-2.0 * self.lever_m]),
            wheels=self.mask(nominal) / np.where(reach > 0.0, reach, np.inf),
        )
        return replace(part, multipliers=(*part.multipliers, lead))
