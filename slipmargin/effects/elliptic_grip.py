"""A wheel cannot use both grips at the same time: the law of a wheel that slides as a whole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, final

from slipmargin.effects.coupling import CONFIRM, STRENGTH, coupled
from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.physics.grips import GripShape


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class EllipticGrip(Effect):
    """Force set (1 − s)·box ⊕ s·{(f_W/μ_W)² + (f_T/μ_T)² ≤ N²}."""

    name: ClassVar[str] = "elliptic_grip"
    traced_to: ClassVar[Trace] = Trace.SLIP_COUPLING
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (STRENGTH,)
    source: ClassVar[str] = "docs/theory.md, section 2, three grip sets (friction ellipse); 1 = elliptic"
    confirm: ClassVar[str] = CONFIRM

    strength: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with coupled directions; as it was at strength 0."""
        return coupled(part, nominal, GripShape.ELLIPSE, self.strength, (self.name, "roller_coupling"))
