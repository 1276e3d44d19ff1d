"""Rigid material between the rollers touches the floor (the paper's own missing effect)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RigidSector(Effect):
    """Angle θ_i stands on rigid material where θ_i mod 2π/n ≥ (1 − c)·2π/n.

    There both coefficients are the rigid ones; ``rigid_coefficient`` 0 keeps those of the surface.
    """

    name: ClassVar[str] = "rigid_sector"
    traced_to: ClassVar[Trace] = Trace.WHEEL_ANGLE
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="rigid_fraction",
            unit="1",
            low=0.0,
            high=0.6,
            null=0.0,
            scale=0.02,
            meaning="share of the circumference that is rigid",
            starts=(0.05, 0.15),
        ),
        Parameter(
            name="rigid_coefficient",
            unit="1",
            low=0.0,
            high=3.0,
            null=0.0,
            scale=0.1,
            meaning="friction coefficient of the rigid material (0: as the surface says)",
            starts=(0.5,),
        ),
        Parameter(
            name="sectors_per_turn",
            unit="1",
            low=0.0,
            high=64.0,
            null=0.0,
            scale=1.0,
            meaning="how often rigid material comes round in a turn (0: once a roller)",
        ),
    )
    source: ClassVar[str] = "Williams et al. 2002, section IV.A and Table I; positive = more rigid"
    confirm: ClassVar[str] = "film a roller changeover, or turn each wheel by hand and mark the gaps"

    rigid_fraction: float
    rigid_coefficient: float = 0.0
    sectors_per_turn: float = 0.0
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with the rigid sectors."""
        mask = self.mask(nominal)
        wider = np.maximum(part.rigid_fraction, self.rigid_fraction)
        fraction = np.where(mask > 0, wider, part.rigid_fraction)
        rigid = part.rigid
        if self.rigid_coefficient > 0.0:
            rigid = np.where(mask[:, None] > 0, self.rigid_coefficient, rigid)
        rollers = part.rollers
        if self.sectors_per_turn > 0.0:
            rollers = np.where(mask > 0, self.sectors_per_turn, rollers)
        return replace(part, rigid_fraction=fraction, rigid=rigid, rollers=rollers)
