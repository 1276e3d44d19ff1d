"""The heading sensor’s scale is off."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class HeadingGain(Effect):
    """φ_meas ← g φ."""

    name: ClassVar[str] = "heading_gain"
    traced_to: ClassVar[Trace] = Trace.MEASUREMENT
    part: ClassVar[Part] = Part.SENSING
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="gain",
            unit="1",
            low=0.5,
            high=2.0,
            null=1.0,
            scale=0.01,
            meaning="measured over true heading change",
        ),
    )
    source: ClassVar[str] = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm: ClassVar[str] = "turn the robot by one full turn by hand and read the heading"

    gain: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, heading_gain=part.heading_gain * self.gain)
