"""The tracked marker is not above the origin of the body frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

import numpy as np

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MarkerOffset(Effect):
    """p_meas ← p + R(φ) (x, y)."""

    name: ClassVar[str] = "marker_offset"
    traced_to: ClassVar[Trace] = Trace.MEASUREMENT
    part: ClassVar[Part] = Part.SENSING
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="marker_x_m",
            unit="m",
            low=-1.0,
            high=1.0,
            null=0.0,
            scale=0.005,
            meaning="marker to the right of the origin",
        ),
        Parameter(
            name="marker_y_m",
            unit="m",
            low=-1.0,
            high=1.0,
            null=0.0,
            scale=0.005,
            meaning="marker ahead of the origin",
        ),
    )
    source: ClassVar[str] = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm: ClassVar[str] = "spin the robot on the spot: an offset marker draws a circle"

    marker_x_m: float
    marker_y_m: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, marker_m=part.marker_m + np.array([self.marker_x_m, self.marker_y_m]))
