"""Accelerating shifts weight from the leading to the trailing wheels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.loads import tagged
from slipmargin.physics.loads import Loads, transfer


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class LoadTransfer(Effect):
    """Σ N_i (p_i − com) = −m h a: N_i ← N_i − m h (S [0, a_x, a_y])_i, a the body-frame acceleration."""

    name: ClassVar[str] = "load_transfer"
    traced_to: ClassVar[Trace] = Trace.ACCELERATION
    part: ClassVar[Part] = Part.LOADS
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="com_height_m",
            unit="m",
            low=-0.5,
            high=1.0,
            null=0.0,
            scale=0.02,
            meaning="height of the centre of mass above the floor, on top of the file’s",
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
        "moment balance about the floor (docs/theory.md, section 3); positive = the wheels behind carry more"
    )
    confirm: ClassVar[str] = (
        "measure the height of the centre of mass: tip the robot on two wheels and balance it"
    )

    com_height_m: float
    com_share: float = 0.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

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
