"""The effect ``marker_offset``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class MarkerOffset(Effect):
    """p_meas ← p + R(φ) (x, y)."""

    name = "marker_offset"
    summary = "The tracked marker is not above the origin of the body frame."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (
        parameter("marker_x_m", "m", (-1.0, 0.0, 1.0), 0.005, "marker from the origin along the body's x"),
        parameter("marker_y_m", "m", (-1.0, 0.0, 1.0), 0.005, "marker from the origin along the body's y"),
    )
    source = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm = "spin the robot on the spot: an offset marker draws a circle"

    marker_x_m: float
    marker_y_m: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, marker_m=part.marker_m + np.array([self.marker_x_m, self.marker_y_m]))
