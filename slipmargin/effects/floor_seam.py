"""The effect ``floor_seam``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi
from typing import final

from slipmargin.effects.effect import IN_MOTIONS, Effect, Part, Quantity, Scope, Trace, parameter
from slipmargin.effects.places import EDGE_M, line
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.relief import Profile, Relief, steepest

#: Where fits start: wide ridges across what the runs cover, their lines turned by 30 degrees each.
_AHEAD = tuple(k * pi / 6.0 for k in range(6))
_AT, _WIDE = (-0.75, -0.25, 0.25, 0.75), 0.2
#: … and on a line that the data point to ridges and grooves as wide [m] as a wheel makes of a seam or of a
#: cable, high enough [m] to hold it back noticeably.
_NARROW, _HIGH = (0.06, 0.12), (0.006, -0.006)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorSeam(Effect):
    """F_i = −N_i h′(d_i) n, h(d) = height · 2^−(2 d/width)², d_i = n·x_i − offset, n at ``direction_rad``.

    A wheel is held back while it climbs the ridge and pushed on while it comes down, at its contact; a
    negative height is a groove.  The profile is the path of the wheel's axle: a wheel bridges a ridge
    narrower than itself, so the width that it feels is larger, and the height of a groove smaller, than a
    ruler says.
    """

    name = "floor_seam"
    summary = "A low ridge or groove runs across the floor (a seam, a cable under the carpet, a joint)."
    traced_to = Trace.POSITION
    part = Part.LOSSES
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "height_m",
            "m",
            (-0.05, 0.0, 0.05),
            0.0005,
            "height of the ridge; negative: depth of a groove",
            starts=(0.002,),
            near=_HIGH,
        ),
        *line(
            "distance of the ridge from the floor's origin along its normal",
            "direction of the normal, across the ridge",
            _AT,
            _AHEAD,
        ),
        parameter(
            "width_m",
            "m",
            (0.004, 0.1, 10.0),
            0.01,
            "width of the ridge at half its height",
            starts=(_WIDE,),
            near=_NARROW,
            idle=True,
            along="position",
        ),
    )
    counts_in = IN_MOTIONS + "a level floor"
    source = "weight on a slope that changes its sign, wheel by wheel; positive = a ridge"
    confirm = "lay a straight edge across the line and measure the gap beside it"

    height_m: float
    offset_m: float = 0.0
    direction_rad: float = 0.0
    width_m: float = 0.1

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the ridge's push at each wheel."""
        del nominal
        ridge = Relief(
            profile=Profile.RIDGE,
            size=self.height_m,
            extent_m=self.width_m,
            place=(self.offset_m, self.direction_rad),
            edge_m=EDGE_M,
        )
        return replace(part, reliefs=(*part.reliefs, ridge))

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """The steepest slope on the way up."""
        del model
        value = steepest(self.height_m, self.width_m)
        return (Quantity(name="steepest_slope", value=value, unit="1"),)
