"""A measured camera calibration, written as the effects that robot files hold."""

from __future__ import annotations

from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.camera_rotation import CameraRotation
from slipmargin.effects.camera_scale import CameraScale
from slipmargin.effects.effect import Effect


def camera_effects(scale: float, rotation_rad: float, delay_s: float) -> tuple[Effect, ...]:
    """The effects of a camera with this scale [1] in x and y, this rotation [rad] and this delay [s]."""
    return (
        CameraScale(scale_x=scale, scale_y=scale),
        CameraRotation(rotation_rad=rotation_rad),
        CameraDelay(delay_s=delay_s),
    )
