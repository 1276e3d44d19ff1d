"""The effect ``floor_bump``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import IN_MOTIONS, Effect, Part, Quantity, Scope, Trace, parameter
from slipmargin.effects.places import AROUND_X, AROUND_Y, EDGE_M, place
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.relief import Profile, Relief, steepest

#: Where fits start: in the middle of the runs and around it, a third as wide as they reach …
_WIDE = 0.35
#: … and on a place that the data point to: heights [m] that are noticed on a bump as wide as a robot.
_HIGH = (0.01, -0.01)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorBump(Effect):
    """F_i = −N_i ∇h(x_i), h(x) = height · 2^−(d/radius)², d = |x − centre|.

    A wheel is pushed away from the middle of a bump, and drawn into a hollow, at its contact.  The profile is
    the path of the wheel's axle, as for ``floor_seam``.
    """

    name = "floor_bump"
    summary = "A round bump or hollow of the floor (a lump under the carpet, a dent, a worn place)."
    traced_to = Trace.POSITION
    part = Part.LOSSES
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "height_m",
            "m",
            (-0.1, 0.0, 0.1),
            0.001,
            "height of the bump; negative: depth of a hollow",
            starts=(0.003,),
            near=_HIGH,
        ),
        *place(
            "centre",
            "middle of the bump on the floor",
            0.02,
            (AROUND_X, AROUND_Y),
            along="position",
        ),
        parameter(
            "radius_m",
            "m",
            (0.01, 0.2, 10.0),
            0.02,
            "distance from the middle at which it is half as high",
            starts=(_WIDE,),
            idle=True,
            along="position",
        ),
    )
    counts_in = IN_MOTIONS + "a level floor"
    source = "weight on a slope around a middle, wheel by wheel; positive = a bump"
    confirm = "lay a straight edge over the place, or see which way a ball rolls there"

    height_m: float
    centre_x_m: float = 0.0
    centre_y_m: float = 0.0
    radius_m: float = 0.2

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the push of the bump at each wheel."""
        del nominal
        bump = Relief(
            profile=Profile.BUMP,
            size=self.height_m,
            extent_m=2.0 * self.radius_m,
            place=(self.centre_x_m, self.centre_y_m),
            edge_m=EDGE_M,
        )
        return replace(part, reliefs=(*part.reliefs, bump))

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """The steepest slope on the way up."""
        del model
        value = steepest(self.height_m, 2.0 * self.radius_m)
        return (Quantity(name="steepest_slope", value=value, unit="1"),)
