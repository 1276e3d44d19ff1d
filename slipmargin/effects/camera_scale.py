"""The effect ``camera_scale``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraScale(Effect):
    """p_meas ← diag(x, y) p."""

    name = "camera_scale"
    summary = "The camera’s scale is off."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (
        parameter("scale_x", "1", (0.5, 1.0, 2.0), 0.01, "measured over true distance along x"),
        parameter("scale_y", "1", (0.5, 1.0, 2.0), 0.01, "measured over true distance along y"),
    )
    source = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm = "push the robot along a ruler and compare"

    scale_x: float
    scale_y: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, scale=part.scale * np.array([self.scale_x, self.scale_y]))
