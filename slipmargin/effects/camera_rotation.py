"""The camera’s axes are turned against the robot’s start heading."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, final

from slipmargin.effects.effect import Effect, Parameter, Part, Trace
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraRotation(Effect):
    """p_meas ← R(angle) p while φ_meas stays."""

    name: ClassVar[str] = "camera_rotation"
    traced_to: ClassVar[Trace] = Trace.MEASUREMENT
    part: ClassVar[Part] = Part.SENSING
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="rotation_rad",
            unit="rad",
            low=-0.5,
            high=0.5,
            null=0.0,
            scale=0.01,
            meaning="angle of the measured track against the measured heading",
        ),
    )
    source: ClassVar[str] = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm: ClassVar[str] = "drive straight without slip and compare the track’s direction with the heading"

    rotation_rad: float
    wheels: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        self._check()

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, rotation_rad=part.rotation_rad + self.rotation_rad)
