"""The effect ``wheel_loads``."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Quantity, Scope, Trace, Variant, parameter
from slipmargin.model import Model
from slipmargin.model.loads import tagged
from slipmargin.physics.loads import Loads, out_of_plane, sharing_matrix

#: Starts of the shift, as shares of how far out the wheels are: a small one, and three directions to where
#: other wheels begin to slip.  Where none of them slips, a small shift changes nothing.
_AHEAD = (0.02, *(0.25 * math.cos(k * 2.0 * math.pi / 3.0) for k in range(3)))
_ASIDE = (0.02, *(0.25 * math.sin(k * 2.0 * math.pi / 3.0) for k in range(3)))


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class WheelLoads(Effect):
    """N_i ← N_i + m g ((S [0, dx, dy])_i + w Π_i1 / Π_11): the loads' resultant acts (dx, dy) away, and a
    contact out of the plane of the others shifts loads without a resultant.

    For three wheels every possible sharing of the weight is a shift: three contacts have a plane, Π is zero.
    For four it is a shift and the diagonals' share w.  The centre of mass goes ``com_share`` of the way to
    where the loads then say it is.
    """

    name = "wheel_loads"
    summary = "The weight is shared differently than the file says."
    traced_to = Trace.WHEEL_LOAD
    part = Part.LOADS
    scope = Scope.LOADING
    parameters = (
        parameter(
            "shift_x_m",
            "m",
            (-0.5, 0.0, 0.5),
            0.005,
            "shift of the load centre along the body's x",
            starts=_AHEAD,
            along="body",
        ),
        parameter(
            "shift_y_m",
            "m",
            (-0.5, 0.0, 0.5),
            0.005,
            "shift of the load centre along the body's y",
            starts=_ASIDE,
            along="body",
        ),
        parameter(
            "com_share",
            "1",
            (0.0, 0.0, 1.0),
            0.2,
            "how far the centre of mass follows the loads’ centre (1: all the way)",
        ),
        parameter(
            "diagonal_share",
            "1",
            (-0.25, 0.0, 0.25),
            0.01,
            "share of the weight that wheel 1 carries more, its contact being below the others’ plane",
            least_wheels=4,
        ),
    )
    variants = (
        Variant(free=("shift_x_m", "shift_y_m", "diagonal_share"), fixed={"com_share": 1.0}),
        Variant(
            free=("shift_x_m", "shift_y_m", "diagonal_share"), label="with the centre of mass where stated"
        ),
    )
    source = "moment balance about the floor (docs/theory.md, section 3); positive along the body's x, y"
    confirm = "weigh the wheels: put each on a scale, the others level"

    shift_x_m: float
    shift_y_m: float
    com_share: float = 0.0
    diagonal_share: float = 0.0

    def rewrite(self, part: Loads, nominal: Model) -> Loads:
        """Loads with the shifted resultant."""
        position_m = nominal.geometry.position_m
        moved = sharing_matrix(position_m) @ np.array([0.0, self.shift_x_m, self.shift_y_m])
        moved += self.diagonal_share * out_of_plane(position_m)
        return replace(
            part,
            rest_N=part.rest_N + nominal.inertia.weight_N * moved,
            rule=tagged(part.rule, "shifted"),
            centred=max(part.centred, self.com_share),
        )

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """Each wheel's share of the weight at rest, which a scale under the wheel shows."""
        share = model.loads.rest_N / model.loads.rest_N.sum()
        return tuple(
            Quantity(name=f"load_fraction_{wheel}", value=float(value), unit="1")
            for wheel, value in zip(model.geometry.names, share, strict=True)
        )
