"""The effect ``load_transfer``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, Variant, parameter
from slipmargin.model import Model
from slipmargin.model.loads import tagged
from slipmargin.physics.loads import Loads, transfer


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class LoadTransfer(Effect):
    """Σ N_i (p_i − com) = −m h a: N_i ← N_i − m h (S [0, a_x, a_y])_i, a the body-frame acceleration."""

    name = "load_transfer"
    summary = "Accelerating shifts weight from the leading to the trailing wheels."
    traced_to = Trace.ACCELERATION
    part = Part.LOADS
    scope = Scope.LOADING
    other_half = "wheel_loads"
    parameters = (
        parameter(
            "com_height_m",
            "m",
            (-0.5, 0.0, 1.0),
            0.02,
            "height of the centre of mass above the floor, on top of the file’s",
            starts=(0.02, 0.05, 0.15),
        ),
        parameter(
            "com_share",
            "1",
            (0.0, 0.0, 1.0),
            0.2,
            "how far the centre of mass follows the loads’ centre (1: all the way)",
        ),
    )
    variants = (
        Variant(free=("com_height_m",), fixed={"com_share": 1.0}),
        Variant(free=("com_height_m",), label="with the centre of mass where stated"),
    )
    source = (
        "moment balance about the floor (docs/theory.md, section 3); positive = the wheels behind carry more"
    )
    confirm = "measure the height of the centre of mass: tip the robot on two wheels and balance it"

    com_height_m: float
    com_share: float = 0.0

    def rewrite(self, part: Loads, nominal: Model) -> Loads:
        """Loads that follow the acceleration."""
        shift = transfer(nominal.geometry.position_m, nominal.inertia.mass_kg, self.com_height_m)
        return replace(
            part,
            per_acceleration_kg=part.per_acceleration_kg + shift,
            rule=tagged(part.rule, "plus load transfer"),
            centred=max(part.centred, self.com_share),
            raised_m=part.raised_m + self.com_height_m,
        )
