"""The effect ``stribeck``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, Variant, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Stribeck(WheelEffect):
    """μ(v) ← μ(v) [r + (1 − r) exp(−(|v|/v_s)²)], v the slip speed, along the drive direction.

    Across it a roller turns in its bearing; its drag has a ratio of its own, 1 unless stated.
    """

    name = "stribeck"
    summary = "Sliding friction is lower than sticking friction."
    traced_to = Trace.SLIP_SPEED
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "dynamic_ratio",
            "1",
            (0.05, 1.0, 3.0),
            0.1,
            "dynamic over static coefficient",
            starts=(0.8,),
            meant=-1,
        ),
        parameter(
            "stribeck_speed_m_s",
            "m/s",
            (0.002, 0.05, 1.0),
            0.01,
            "slip speed at which most of the drop has happened",
            starts=(0.03, 0.1),
            idle=True,
        ),
        parameter(
            "transverse_ratio",
            "1",
            (0.05, 1.0, 3.0),
            0.1,
            "dynamic over static transverse coefficient (1: bearing drag, which does not drop)",
            meant=-1,
        ),
    )
    variants = (
        Variant(free=("dynamic_ratio", "stribeck_speed_m_s")),
        Variant(free=("dynamic_ratio", "stribeck_speed_m_s", "transverse_ratio"), label="in both directions"),
    )
    source = (
        "Armstrong-Hélouvry, Control of Machines with Friction, 1991, eq. (2.7); below 1 = friction drops"
    )
    confirm = "drag the robot with locked wheels at several steady speeds and read the force"

    dynamic_ratio: float
    stribeck_speed_m_s: float
    transverse_ratio: float = 1.0

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
