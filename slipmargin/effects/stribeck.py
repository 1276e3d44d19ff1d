"""Sliding friction is lower than sticking friction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(Effect):
    """μ(v) ← μ(v) [r + (1 − r) exp(−(|v|/v_s)²)], v the slip speed, along the drive direction.

    Across it a roller turns in its bearing; its drag has a ratio of its own, 1 unless stated.
    """

    name: ClassVar[str] = "stribeck"
    traced_to: ClassVar[Trace] = Trace.SLIP_SPEED
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="dynamic_ratio",
            unit="1",
            low=0.05,
            high=3.0,
            null=1.0,
            scale=0.1,
            meaning="dynamic over static coefficient",
            starts=(0.8,),
        ),
        Parameter(
            name="stribeck_speed_m_s",
            unit="m/s",
            low=0.002,
            high=1.0,
            null=0.05,
            scale=0.01,
            meaning="slip speed at which most of the drop has happened",
            starts=(0.03, 0.1),
        ),
        Parameter(
            name="transverse_ratio",
            unit="1",
            low=0.05,
            high=3.0,
            null=1.0,
            scale=0.1,
            meaning="dynamic over static transverse coefficient (1: bearing drag, which does not drop)",
        ),
    )
    source: ClassVar[str] = (
        "Armstrong-Hélouvry, Control of Machines with Friction, 1991, eq. (2.7); below 1 = friction drops"
    )
    confirm: ClassVar[str] = "drag the robot with locked wheels at several steady speeds and read the force"

    dynamic_ratio: float
    stribeck_speed_m_s: float
    transverse_ratio: float = 1.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip whose coefficients fall with slip speed."""
        drops = tuple(
            Multiplier(
                variable=Variable.SLIP_SPEED,
                basis=Basis.DECAY,
                target=target,
                coefficients=np.array([1.0 - ratio]),
                shape=np.array([self.stribeck_speed_m_s, 2.0]),
                wheels=self.mask(nominal),
            )
            for target, ratio in (
                (Target.DRIVE, self.dynamic_ratio),
                (Target.TRANSVERSE, self.transverse_ratio),
            )
            if ratio != 1.0
        )
        return replace(part, multipliers=(*part.multipliers, *drops))
