"""The camera’s scale is off."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraScale(Effect):
    """p_meas ← diag(x, y) p."""

    name: ClassVar[str] = "camera_scale"
    traced_to: ClassVar[Trace] = Trace.MEASUREMENT
    part: ClassVar[Part] = Part.SENSING
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="scale_x",
            unit="1",
            low=0.5,
            high=2.0,
            null=1.0,
            scale=0.01,
            meaning="measured over true distance along x",
        ),
        Parameter(
            name="scale_y",
            unit="1",
            low=0.5,
            high=2.0,
            null=1.0,
            scale=0.01,
            meaning="measured over true distance along y",
        ),
    )
    source: ClassVar[str] = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm: ClassVar[str] = "push the robot along a ruler and compare"

    scale_x: float
    scale_y: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, scale=part.scale * np.array([self.scale_x, self.scale_y]))
