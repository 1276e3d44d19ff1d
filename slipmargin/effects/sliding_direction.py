"""Friction that repeats with the direction in which a contact slides over the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from slipmargin.effects.effect import Part, Quantity, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable

MOST_FRICTION = "most_friction_towards_rad"


@dataclass(frozen=True, slots=True, kw_only=True)
class SlidingDirection(WheelEffect):
    """Abstract.  μ ← μ [1 + cosine · cos nβ + sine · sin nβ], β the floor direction of the whole slip.

    n is :attr:`repeats`.
    """

    #: How often friction repeats in a turn of β.
    repeats: ClassVar[int]
    traced_to = Trace.HEADING
    part = Part.GRIP
    parameters = (
        parameter("cosine", "1", (-0.9, 0.0, 0.9), 0.05, "relative change of friction when sliding along x"),
        parameter(
            "sine", "1", (-0.9, 0.0, 0.9), 0.05, "the same a quarter of a period further to the left of x"
        ),
    )
    source = "friction of grooved and woven surfaces over the sliding direction; positive = more friction"
    confirm = "drag a locked wheel over the floor in eight directions and read the force"

    cosine: float
    sine: float = 0.0

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip that depends on the direction in which a contact slides over the floor."""
        grain = Multiplier(
            variable=Variable.SLIP_DIRECTION,
            basis=Basis.FOURIER,
            target=Target.BOTH,
            coefficients=np.array([self.cosine, self.sine]),
            shape=np.array([2.0 * np.pi / self.repeats, 0.0]),
            wheels=self.mask(nominal),
        )
        return replace(part, multipliers=(*part.multipliers, grain))

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """By how much friction changes, and the sliding direction of the most friction."""
        del model
        way = math.atan2(self.sine, self.cosine) / self.repeats
        return (
            Quantity(name="amplitude", value=math.hypot(self.cosine, self.sine), unit="1"),
            Quantity(name=MOST_FRICTION, value=way, unit="rad"),
        )
