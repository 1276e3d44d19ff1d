"""The effect ``stiff_roller``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.sectors import pitch
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable

#: Where fits look for the roller: every 30°, as many as a wheel has rollers or more [rad].
_ROUND = tuple(k * math.pi / 6.0 for k in range(12))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class StiffRoller(WheelEffect):
    """μ_T,i ← factor · μ_T,i while one roller, of pitch 2π/n around the angle, stands on the floor.

    The change sets in and ends over a fifteenth of the pitch, as one roller hands over to the next.
    """

    name = "stiff_roller"
    summary = "One roller of a wheel turns heavily: dirt, hair or a worn bearing."
    traced_to = Trace.WHEEL_ANGLE
    part = Part.GRIP
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "factor",
            "1",
            (0.0, 1.0, 20.0),
            0.2,
            "transverse friction while this roller stands on the floor over that of the others",
            starts=(3.0,),
            meant=1,
        ),
        parameter(
            "angle_rad",
            "rad",
            (-7.0, 0.0, 7.0),
            0.1,
            "wheel angle at which the middle of the roller stands on the floor",
            starts=_ROUND,
            idle=True,
        ),
    )
    all_wheels, one_wheel = False, True
    needs_wheel_phase = True
    needs_wheel_angles = True
    source = "eq. (11) with a friction of its own for one roller; factor above 1 = turns more heavily"
    confirm = "lift the robot and flick every roller of the wheel: one stops sooner than the others"

    factor: float
    angle_rad: float = 0.0

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with one roller that is unlike the others."""
        on, own = self.mask(nominal), pitch(nominal.grip.rollers)
        each = [
            Multiplier(
                variable=Variable.WHEEL_ANGLE,
                basis=Basis.LOBE,
                target=Target.TRANSVERSE,
                shape=np.array([self.angle_rad, width]),
                coefficients=np.array([self.factor - 1.0]),
                wheels=on * (own == width),
            )
            for width in np.unique(own[on > 0])
        ]
        return replace(part, multipliers=(*part.multipliers, *each))
