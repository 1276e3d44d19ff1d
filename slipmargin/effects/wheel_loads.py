"""The weight is shared differently than the file says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.loads import tagged
from slipmargin.physics.loads import Loads, sharing_matrix


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelLoads(Effect):
    """N_i ← N_i + m g (S [0, dx, dy])_i: the loads' resultant acts (dx, dy) away from where it did.

    For three wheels every possible sharing of the weight is such a shift.  The centre of mass goes
    ``com_share`` of the way to where the loads then say it is.
    """

    name: ClassVar[str] = "wheel_loads"
    traced_to: ClassVar[Trace] = Trace.WHEEL_LOAD
    part: ClassVar[Part] = Part.LOADS
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="shift_x_m",
            unit="m",
            low=-0.5,
            high=0.5,
            null=0.0,
            scale=0.005,
            meaning="shift of the load centre to the right",
        ),
        Parameter(
            name="shift_y_m",
            unit="m",
            low=-0.5,
            high=0.5,
            null=0.0,
            scale=0.005,
            meaning="shift of the load centre forwards",
        ),
        Parameter(
            name="com_share",
            unit="1",
            low=0.0,
            high=1.0,
            null=0.0,
            scale=0.2,
            meaning="how far the centre of mass follows the loads’ centre (1: all the way)",
        ),
    )
    source: ClassVar[str] = (
        "moment balance about the floor (docs/theory.md, section 3); positive right, forwards"
    )
    confirm: ClassVar[str] = "weigh the wheels: put each on a scale, the others level"

    shift_x_m: float
    shift_y_m: float
    com_share: float = 0.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Loads, nominal: Model) -> Loads:
        """Loads with the shifted resultant."""
        share = sharing_matrix(nominal.geometry.position_m)
        moved = nominal.inertia.weight_N * share @ np.array([0.0, self.shift_x_m, self.shift_y_m])
        return replace(
            part,
            rest_N=part.rest_N + moved,
            rule=tagged(part.rule, "shifted"),
            centred=max(part.centred, self.com_share),
        )
