"""The effect ``roller_coupling``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.effects.coupling import CONFIRM, STRENGTH, coupled
from slipmargin.effects.effect import Effect, Part, Scope, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.grips import GripShape


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class RollerCoupling(Effect):
    """Force set (1 − s)·box ⊕ s·{|f| ≤ μ_W N, |f_T| ≤ μ_T N}."""

    name = "roller_coupling"
    summary = "A wheel cannot use its drive grip and its roller drag at the same time: the free roller’s law."
    traced_to = Trace.SLIP_COUPLING
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (STRENGTH,)
    source = (
        "docs/theory.md, section 2, three grip sets (disc cut by the strip); 1 = a free roller on the floor"
    )
    confirm = CONFIRM

    strength: float

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with coupled directions; as it was at strength 0."""
        return coupled(part, nominal, GripShape.DISC_STRIP, self.strength, (self.name, "elliptic_grip"))
