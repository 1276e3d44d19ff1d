"""The floor grips differently along and against its nap."""

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
class FloorNap(Effect):
    """μ ← μ [1 + nap_x cos β + nap_y sin β], β the floor-frame direction in which the contact slides."""

    name: ClassVar[str] = "floor_nap"
    traced_to: ClassVar[Trace] = Trace.HEADING
    part: ClassVar[Part] = Part.GRIP
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="nap_x",
            unit="1",
            low=-0.9,
            high=0.9,
            null=0.0,
            scale=0.05,
            meaning="relative change of friction when sliding towards +x",
        ),
        Parameter(
            name="nap_y",
            unit="1",
            low=-0.9,
            high=0.9,
            null=0.0,
            scale=0.05,
            meaning="relative change of friction when sliding towards +y",
        ),
    )
    source: ClassVar[str] = (
        "directional friction of pile fabrics; positive = more friction sliding towards +x, +y"
    )
    confirm: ClassVar[str] = "drag a locked wheel over the floor in four directions and read the force"

    nap_x: float
    nap_y: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: Grip, nominal: Model) -> Grip:
        """Grip that depends on the sliding direction over the floor."""
        nap = Multiplier(
            variable=Variable.SLIP_HEADING,
            basis=Basis.FOURIER,
            target=Target.BOTH,
            coefficients=np.array([self.nap_x, self.nap_y]),
            shape=np.array([2.0 * np.pi, 0.0]),
            wheels=self.mask(nominal),
        )
        return replace(part, multipliers=(*part.multipliers, nap))
