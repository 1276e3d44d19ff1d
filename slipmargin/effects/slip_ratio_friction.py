"""The effect ``slip_ratio_friction``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, Variant, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Target, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SlipRatioFriction(WheelEffect):
    """k ← (1 − s) k + s κ / (v + v_0): eq. (11) in the slip ratio u / v.

    v = |v_hub − w u_W ĝ| is the rolling speed.  The floor passes the contact at v_hub, the tread at
    v_hub − u_W ĝ: a roller turns with the floor.  With ``tread_share`` w = 0 it is the floor's speed alone,
    with w = ½ the mean of both, as in Kalker's creepage: they differ where much of the way is lost.
    Far below ``crawl_m_s`` v_0 the law is one of speed again.  Along f̂ (over free rollers) κ is
    ``transverse_factor`` times what it is along ĝ.
    A law has constants of its own: its μ_T is ``transverse_coefficient_factor`` times what was stated for
    eq. (11), its μ_W ``drive_coefficient_factor`` times, which only accelerating shows.
    """

    name = "slip_ratio_friction"
    summary = "Creep: the force depends on slip relative to rolling, not on slip alone."
    traced_to = Trace.SLIP_RATIO
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (
        parameter(
            "share", "1", (0.0, 0.0, 1.0), 0.2, "share of the law that depends on the ratio", starts=(1.0,)
        ),
        parameter(
            "steepness",
            "1",
            (0.5, 20.0, 500.0),
            2.0,
            "steepness κ of the friction law in the slip ratio, along the drive direction",
            starts=(4.0, 10.0, 50.0),
            idle=True,
        ),
        parameter(
            "transverse_factor",
            "1",
            (0.5, 1.0, 20.0),
            0.5,
            "steepness across over steepness along the drive direction",
            needs_own_law_across=True,
        ),
        parameter(
            "crawl_m_s",
            "m/s",
            (1e-4, 1e-3, 0.5),
            5e-3,
            "speed v_0 of the floor under a wheel above which the ratio decides",
            starts=(0.01,),
        ),
        parameter(
            "transverse_coefficient_factor",
            "1",
            (0.0, 1.0, 10.0),
            0.1,
            "transverse coefficient of this law over the stated one",
        ),
        parameter(
            "drive_coefficient_factor",
            "1",
            (0.1, 1.0, 10.0),
            0.1,
            "drive coefficient of this law over the stated one",
        ),
        parameter(
            "tread_share",
            "1",
            (0.0, 0.0, 1.0),
            0.1,
            "share w of the tread's speed in the rolling speed; the rest is the floor's under the wheel",
            starts=(0.5,),
            idle=True,
        ),
    )
    variants = (
        Variant(free=("steepness",), fixed={"share": 1.0}),
        Variant(
            free=("steepness", "transverse_factor", "transverse_coefficient_factor"),
            fixed={"share": 1.0},
            label="with its own constants across",
        ),
        Variant(
            free=(
                "steepness",
                "transverse_factor",
                "transverse_coefficient_factor",
                "drive_coefficient_factor",
            ),
            fixed={"share": 1.0},
            label="with its own constants along and across",
        ),
        Variant(free=("steepness", "crawl_m_s"), fixed={"share": 1.0}, label="from a crawl on"),
    )
    definitions: ClassVar[Mapping[str, tuple[float, ...]]] = {"tread_share": (0.5,)}
    source = (
        "Kalker, Rolling Contact Phenomena (creepage = slip over rolling speed, the mean of both surfaces' "
        "speeds; tread_share 0 takes the floor's alone); positive share = creepage"
    )
    confirm = "drive the same path at two speeds: the lost share of the distance is the same"

    share: float
    steepness: float
    transverse_factor: float = 1.0
    crawl_m_s: float = 1e-3
    transverse_coefficient_factor: float = 1.0
    drive_coefficient_factor: float = 1.0
    tread_share: float = 0.0

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip whose steepness goes with the inverse of the rolling speed."""
        weights = self.mask(nominal) * self.share
        along, across = self.steepness, self.steepness * self.transverse_factor

        def creep(kappa: float, target: Target) -> Multiplier:
            return Multiplier(
                variable=Variable.PASSING_SPEED if self.tread_share else Variable.HUB_SPEED,
                basis=Basis.RECIPROCAL,
                target=target,
                shape=np.array([kappa / nominal.grip.k_s_per_m, self.crawl_m_s]),
                coefficients=np.array([1.0]),
                wheels=weights,
                place=np.array([self.tread_share, 0.0, 0.0]),
            )

        if across == along:
            terms: tuple[Multiplier, ...] = (creep(along, Target.STIFFNESS),)
        else:
            terms = (creep(along, Target.STIFFNESS_DRIVE), creep(across, Target.STIFFNESS_TRANSVERSE))
        coefficients = part.roller.copy()
        factors = np.array([self.drive_coefficient_factor, self.transverse_coefficient_factor])
        coefficients *= 1.0 + weights[:, None] * (factors - 1.0)
        return replace(part, roller=coefficients, multipliers=(*part.multipliers, *terms))
