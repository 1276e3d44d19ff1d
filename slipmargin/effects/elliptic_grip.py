"""The effect ``elliptic_grip``."""

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
class EllipticGrip(Effect):
    """Force set (1 − s)·box ⊕ s·{(f_W/μ_W)² + (f_T/μ_T)² ≤ N²}."""

    name = "elliptic_grip"
    summary = "A wheel cannot use both grips at the same time: the law of a wheel that slides as a whole."
    traced_to = Trace.SLIP_COUPLING
    part = Part.GRIP
    scope = Scope.FLOOR
    parameters = (STRENGTH,)
    source = "docs/theory.md, section 2, three grip sets (friction ellipse); 1 = elliptic"
    confirm = CONFIRM

    strength: float

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with coupled directions; as it was at strength 0."""
        return coupled(part, nominal, GripShape.ELLIPSE, self.strength, (self.name, "roller_coupling"))
