"""The effect ``rigid_sector``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Part, Scope, Trace, Variant, WheelEffect, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Grip


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RigidSector(WheelEffect):
    """Angle θ_i stands on rigid material where θ_i mod 2π/n ≥ (1 − c)·2π/n.

    There both coefficients are the rigid ones; ``rigid_coefficient`` 0 keeps those of the surface.
    """

    name = "rigid_sector"
    summary = "Rigid material between the rollers touches the floor (the paper's own missing effect)."
    traced_to = Trace.WHEEL_ANGLE
    part = Part.GRIP
    scope = Scope.MACHINE
    parameters = (
        parameter(
            "rigid_fraction",
            "1",
            (0.0, 0.0, 0.6),
            0.02,
            "share of the circumference that is rigid",
            starts=(0.05, 0.15),
        ),
        parameter(
            "rigid_coefficient",
            "1",
            (0.0, 0.0, 3.0),
            0.1,
            "friction coefficient of the rigid material (0: as the surface says)",
            starts=(0.5,),
            idle=True,
        ),
        parameter(
            "sectors_per_turn",
            "1",
            (0.0, 0.0, 64.0),
            1.0,
            "how often rigid material comes round in a turn (0: once a roller)",
        ),
    )
    variants = (
        Variant(free=("rigid_fraction",)),
        Variant(free=("rigid_fraction", "rigid_coefficient"), label="with its coefficient"),
    )
    needs_wheel_phase = True
    scanned: ClassVar[Mapping[str, tuple[float, ...]]] = {
        "sectors_per_turn": tuple(float(n) for n in range(2, 17))
    }
    source = "Williams et al. 2002, section IV.A and Table I; positive = more rigid"
    confirm = "film a roller changeover, or turn each wheel by hand and mark the gaps"

    rigid_fraction: float
    rigid_coefficient: float = 0.0
    sectors_per_turn: float = 0.0

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
