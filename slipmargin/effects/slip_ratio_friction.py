"""Creep: the force depends on slip relative to rolling, not on slip alone."""

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
class SlipRatioFriction(Effect):
    """k ← (1 − s) k + s κ / (v_hub + v_0): eq. (11) in the slip ratio u / v_hub.

    v_hub is the speed at which the floor passes under the wheel; far below ``crawl_m_s`` v_0 the law is
    one of speed again.  Along f̂ (over free rollers) κ is ``transverse_factor`` times what it is along ĝ.
    A law has constants of its own: its μ_T is ``transverse_coefficient_factor`` times what was stated for
    eq. (11); that of μ_W steady motion does not show.
    """

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
            scale=2.0,
            meaning="steepness κ of the friction law in the slip ratio, along the drive direction",
            starts=(4.0, 10.0, 50.0),
        ),
        Parameter(
            name="transverse_factor",
            unit="1",
            low=0.5,
            high=20.0,
            null=1.0,
            scale=0.5,
            meaning="steepness across over steepness along the drive direction",
        ),
        Parameter(
            name="crawl_m_s",
            unit="m/s",
            low=1e-4,
            high=0.5,
            null=1e-3,
            scale=5e-3,
            meaning="speed v_0 of the floor under a wheel above which the ratio decides",
            starts=(0.01,),
        ),
        Parameter(
            name="transverse_coefficient_factor",
            unit="1",
            low=0.0,
            high=10.0,
            null=1.0,
            scale=0.1,
            meaning="transverse coefficient of this law over the stated one",
        ),
    )
    source: ClassVar[str] = (
        "Kalker, Rolling Contact Phenomena (creepage = slip over rolling speed); positive share = creepage"
    )
    confirm: ClassVar[str] = "drive the same path at two speeds: the lost share of the distance is the same"

    share: float
    steepness: float
    transverse_factor: float = 1.0
    crawl_m_s: float = 1e-3
    transverse_coefficient_factor: float = 1.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip whose steepness goes with the inverse of the hub's speed."""
        weights = self.mask(nominal) * self.share
        along, across = self.steepness, self.steepness * self.transverse_factor

        def creep(kappa: float, target: Target) -> Multiplier:
            return Multiplier(
                variable=Variable.HUB_SPEED,
                basis=Basis.RECIPROCAL,
                target=target,
                shape=np.array([kappa / nominal.grip.k_s_per_m, self.crawl_m_s]),
                coefficients=np.array([1.0]),
                wheels=weights,
            )

        if across == along:
            terms: tuple[Multiplier, ...] = (creep(along, Target.STIFFNESS),)
        else:
            terms = (creep(along, Target.STIFFNESS_DRIVE), creep(across, Target.STIFFNESS_TRANSVERSE))
        coefficients = part.roller.copy()
        coefficients[:, 1] *= 1.0 + weights * (self.transverse_coefficient_factor - 1.0)
        return replace(part, roller=coefficients, multipliers=(*part.multipliers, *terms))
