"""The effect ``yaw_inertia``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Quantity, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import Inertia


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class YawInertia(Effect):
    """I ← f I, I the moment of inertia about the vertical through the centre of mass."""

    name = "yaw_inertia"
    summary = "The robot is harder or easier to turn than its file says: its yaw inertia differs."
    traced_to = Trace.ACCELERATION
    part = Part.INERTIA
    scope = Scope.LOADING
    parameters = (
        parameter(
            "inertia_factor",
            "1",
            (0.2, 1.0, 5.0),
            0.1,
            "yaw inertia about the centre of mass over that of the robot file",
            starts=(0.8, 1.3, 2.0),
        ),
    )
    source = "Williams et al. 2002, eq. (9), I φ̈ = Σ moments; above 1 = harder to turn"
    confirm = (
        "hang it by two strings, l long and 2 a apart, and time how it turns to and fro: "
        "I = m g a² T² / (4 π² l)"
    )

    inertia_factor: float

    def rewrite(self, part: Inertia, nominal: Model) -> Inertia:
        """The same mass, harder or easier to turn."""
        del nominal
        return replace(part, inertia_kg_m2=self.inertia_factor * part.inertia_kg_m2)

    def derived(self, model: Model) -> tuple[Quantity, ...]:
        """The yaw inertia itself."""
        inertia = model.inertia.inertia_kg_m2
        return (Quantity(name="inertia_kg_m2", value=inertia, unit="kg m²"),)
