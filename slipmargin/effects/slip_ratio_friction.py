"""Creep: the force depends on slip relative to rolling, not on slip alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.model.terms import Modulation
from slipmargin.model.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SlipRatioFriction(Effect):
    """k ← (1 − s) k + s κ / (v_roll + v_0): eq. (11) in the slip ratio u / v_roll, v_0 = 5 mm/s."""

    name: ClassVar[str] = "slip_ratio_friction"
    traced_to: ClassVar[Trace] = Trace.SLIP_RATIO
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="share",
            unit="1",
            low=0.0,
            high=1.0,
            null=0.0,
            scale=0.2,
            meaning="share of the law that depends on the ratio",
            starts=(1.0,),
        ),
        Parameter(
            name="steepness",
            unit="1",
            low=0.5,
            high=500.0,
            null=20.0,
            scale=5.0,
            meaning="steepness κ of the friction law in the slip ratio",
            starts=(10.0, 50.0),
        ),
    )
    source: ClassVar[str] = (
        "Kalker, Rolling Contact Phenomena (creepage = slip over rolling speed); positive share = creepage"
    )
    confirm: ClassVar[str] = "drive the same path at two speeds: the lost share of the distance is the same"

    share: float
    steepness: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip whose steepness goes with the inverse rolling speed."""
        creep = Modulation(
            variable=Variable.ROLLING_SPEED,
            basis=Basis.RECIPROCAL,
            target=Target.STIFFNESS,
            shape=np.array([self.steepness / nominal.grip.k_s_per_m, 0.005]),
            coefficients=np.array([1.0]),
            wheels=self.mask(nominal) * self.share,
        )
        return replace(part, modulations=(*part.modulations, creep))
