"""The effect ``heading_gain``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class HeadingGain(Effect):
    """φ_meas ← φ_0 + g (φ − φ_0), φ_0 the heading at which a run begins, as a gyroscope adds it up."""

    name = "heading_gain"
    summary = "The heading sensor’s scale is off."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (parameter("gain", "1", (0.5, 1.0, 2.0), 0.01, "measured over true heading change"),)
    source = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm = "turn the robot by one full turn by hand and read the heading"

    gain: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, heading_gain=part.heading_gain * self.gain)
