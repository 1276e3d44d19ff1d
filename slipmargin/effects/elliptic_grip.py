"""A wheel cannot use both grips at the same time: the law of a wheel that slides as a whole."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.coupling import check_uncoupled
from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import Grip
from slipmargin.robot import GripShape


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class EllipticGrip(Effect):
    """Force set (1 − s)·box ⊕ s·{(f_W/μ_W)² + (f_T/μ_T)² ≤ N²}."""

    name: ClassVar[str] = "elliptic_grip"
    traced_to: ClassVar[Trace] = Trace.SLIP_COUPLING
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="strength",
            unit="1",
            low=0.0,
            high=1.0,
            null=0.0,
            scale=0.2,
            meaning="share of the coupled law",
            starts=(1.0,),
        ),
    )
    source: ClassVar[str] = "theory, three grip sets (friction ellipse); 1 = elliptic"
    confirm: ClassVar[str] = (
        "drag the robot with one wheel locked at 45 degrees to its drive direction and compare the force"
        " with the straight pulls"
    )

    strength: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip with coupled directions; as it was at strength 0."""
        if self.strength == 0.0:
            return part
        check_uncoupled(part, nominal, GripShape.ELLIPSE, "elliptic_grip", "roller_coupling")
        return replace(part, shape=GripShape.ELLIPSE, coupling=self.strength)
