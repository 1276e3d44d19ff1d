"""The pose is read late."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraDelay(Effect):
    """pose_meas(t) ← pose(t − delay)."""

    name: ClassVar[str] = "camera_delay"
    traced_to: ClassVar[Trace] = Trace.MEASUREMENT
    part: ClassVar[Part] = Part.SENSING
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="delay_s",
            unit="s",
            low=-0.5,
            high=0.5,
            null=0.0,
            scale=0.01,
            meaning="how late the pose is read",
        ),
    )
    source: ClassVar[str] = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm: ClassVar[str] = "tap the robot and compare the time stamps of camera and encoders"

    delay_s: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, delay_s=part.delay_s + self.delay_s)
