"""The effect ``camera_rotation``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.model import Model
from slipmargin.model.parts import MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraRotation(Effect):
    """p_meas ← R(angle) p while φ_meas stays."""

    name = "camera_rotation"
    summary = "The camera’s axes are turned against the robot’s start heading."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    turns_all_ways = True
    parameters = (
        parameter(
            "rotation_rad",
            "rad",
            (-0.5, 0.0, 0.5),
            0.01,
            "angle of the measured track against the measured heading",
        ),
    )
    source = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm = "drive straight without slip and compare the track’s direction with the heading"

    rotation_rad: float

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        return replace(part, rotation_rad=part.rotation_rad + self.rotation_rad)
