"""The effect ``camera_lens``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.effect import Effect, Part, Scope, Trace, parameter
from slipmargin.effects.places import place
from slipmargin.model import Model
from slipmargin.model.parts import Lens, MeasurementModel


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class CameraLens(Effect):
    """p_meas ← p + bend |p − c|² (p − c), c the point of the floor that the camera looks at.

    The radial distortion of a lens to its first order (D. C. Brown, Photogrammetric Engineering 37(8), 855,
    1971).  A heading is measured as it is.
    """

    name = "camera_lens"
    summary = "The camera’s lens bends the picture: distances grow or shrink towards its edge."
    traced_to = Trace.MEASUREMENT
    part = Part.SENSING
    scope = Scope.INSTRUMENT
    parameters = (
        parameter(
            "bend_per_m2",
            "1/m²",
            (-1.0, 0.0, 1.0),
            0.01,
            "what the scale changes by at 1 m from the centre; below 0 a barrel, above 0 a cushion",
        ),
        *place(
            "centre", "point of the floor that the camera looks at", 0.1, ((0.0,), (0.0,)), along="position"
        ),
    )
    source = "calibration of the pose measurement; see MeasurementModel for signs"
    confirm = "push the robot along a long ruler, once through the middle of the picture and once at its edge"

    bend_per_m2: float
    centre_x_m: float = 0.0
    centre_y_m: float = 0.0

    def rewrite(self, part: MeasurementModel, nominal: Model) -> MeasurementModel:
        """MeasurementModel with this fault."""
        del nominal
        lens = Lens(bend_per_m2=self.bend_per_m2, centre_m=(self.centre_x_m, self.centre_y_m))
        return replace(part, lenses=(*part.lenses, lens))
