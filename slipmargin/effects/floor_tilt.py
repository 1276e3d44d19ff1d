"""The floor is not level."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import ExternalWrench
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Basis, Frame, Variable


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorTilt(Effect):
    """Gravity along the floor: F = m g (tilt_x, tilt_y) in the floor frame, small angles."""

    name: ClassVar[str] = "floor_tilt"
    traced_to: ClassVar[Trace] = Trace.CONSTANT_FORCE
    part: ClassVar[Part] = Part.LOSSES
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="tilt_x_rad",
            unit="rad",
            low=-0.3,
            high=0.3,
            null=0.0,
            scale=0.003,
            meaning="slope down towards +x",
        ),
        Parameter(
            name="tilt_y_rad",
            unit="rad",
            low=-0.3,
            high=0.3,
            null=0.0,
            scale=0.003,
            meaning="slope down towards +y",
        ),
    )
    source: ClassVar[str] = (
        "weight on an inclined plane; positive = downhill towards +x, +y of the floor frame"
    )
    confirm: ClassVar[str] = "a spirit level on the floor, or run the same trial turned by 180 degrees"

    tilt_x_rad: float
    tilt_y_rad: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: ExternalWrench, nominal: Model) -> ExternalWrench:
        """ExternalWrench with the slope's pull."""
        pull = nominal.inertia.weight_N * np.array([[self.tilt_x_rad], [self.tilt_y_rad], [0.0]])
        term = ForceTerm(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            coefficients=pull,
            shape=np.ones(2),
            frame=Frame.FLOOR,
        )
        return replace(part, terms=(*part.terms, term))
