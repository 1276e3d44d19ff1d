"""The effect ``camera_delay``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraDelay(Effect):
    """pose_meas(t) ← pose(t − delay)."""

    name = "camera_delay"
    summary = "The pose is read late."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (parameter("delay_s", "s", (-0.5, 0.0, 0.5), 0.01, "how late the pose is read"),)
    source = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm = "tap the robot and compare the time stamps of camera and encoders"

    delay_s: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, delay_s=part.delay_s + self.delay_s)
