"""The effect ``floor_ramp``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, tan
from typing import final

from slipmargin.effects.effect import IN_MOTIONS, Effect, Part, Quantity, Scope, Trace, parameter
from slipmargin.effects.places import EDGE, EDGE_M, line
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.relief import Profile, Relief

#: Where fits start: strips over either half of what the runs cover, their lines turned by 45 degrees each.
_AHEAD = tuple(k * pi / 4.0 for k in range(4))
_FROM, _LENGTH = (-0.9, 0.0), 0.9
#: … and on lines that the data point to: slopes [1] that are noticed, short ones to as long as a robot [m].
_SLOPES, _LENGTHS = (0.03, -0.03), (0.15, 0.3, 0.6)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorRamp(Effect):
    """F_i = −N_i tan(slope) n for each wheel on the strip offset < n·x_i < offset + length.

    n points in ``direction_rad``, and the strip's ends are as wide as ``edge_m``.  Each wheel is pulled by
    its own load's share, at its contact, so the robot turns where some of its wheels stand on the slope.  A
    slope under all of every run is ``floor_tilt``; a patch of other friction stands against the motion, a
    slope pulls to one side whatever the motion is, and a robot at rest as well.
    """

    name = "floor_ramp"
    summary = "A strip of the floor slopes (a ramp, a drain, a board that lies hollow)."
    traced_to = Trace.POSITION
    part = Part.LOSSES
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "slope_rad",
            "rad",
            (-0.3, 0.0, 0.3),
            0.003,
            "slope of the strip, up in its direction where positive",
            starts=(0.01,),
            near=_SLOPES,
        ),
        *line(
            "distance of the line where it begins from the floor's origin, in its direction",
            "direction in which the floor rises",
            _FROM,
            _AHEAD,
        ),
        parameter(
            "length_m",
            "m",
            (0.01, 0.5, 200.0),
            0.02,
            "length of the strip in its direction",
            starts=(_LENGTH,),
            near=_LENGTHS,
            idle=True,
            along="position",
        ),
        EDGE,
    )
    counts_in = IN_MOTIONS + "a level floor"
    source = "weight on an inclined plane, wheel by wheel; positive = uphill in the strip's direction"
    confirm = "lay a straight edge or a spirit level on the floor there"

    slope_rad: float
    offset_m: float = 0.0
    direction_rad: float = 0.0
    length_m: float = 0.5
    edge_m: float = EDGE_M

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the slope's pull at each wheel."""
        del nominal
        ramp = Relief(
            profile=Profile.RAMP,
            size=tan(self.slope_rad),
            extent_m=self.length_m,
            place=(self.offset_m, self.direction_rad),
            edge_m=self.edge_m,
        )
        return replace(part, reliefs=(*part.reliefs, ramp))

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """How high the strip climbs."""
        del model
        return (Quantity(name="climbs_m", value=tan(self.slope_rad) * self.length_m, unit="m"),)
