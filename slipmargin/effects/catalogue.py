"""Every named effect, one line each."""

from __future__ import annotations

from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.camera_rotation import CameraRotation
from slipmargin.effects.camera_scale import CameraScale
from slipmargin.effects.effect import Effect
from slipmargin.effects.elliptic_grip import EllipticGrip
from slipmargin.effects.floor_nap import FloorNap
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.heading_gain import HeadingGain
from slipmargin.effects.load_transfer import LoadTransfer
from slipmargin.effects.marker_offset import MarkerOffset
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.effects.roller_coupling import RollerCoupling
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.speed_droop import SpeedDroop
from slipmargin.effects.stribeck import Stribeck
from slipmargin.effects.tether import Tether
from slipmargin.effects.trailing_load import TrailingLoad
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.effects.wheel_radius import WheelRadius
from slipmargin.effects.wheel_toe import WheelToe

CATALOGUE: tuple[type[Effect], ...] = (
    FrictionCoefficients,
    RigidSector,
    WheelLoads,
    LoadTransfer,
    TrailingLoad,
    Stribeck,
    SlipRatioFriction,
    RollerCoupling,
    EllipticGrip,
    RollingResistance,
    FloorTilt,
    FloorNap,
    Tether,
    WheelRadius,
    WheelToe,
    MotorLag,
    SpeedDroop,
    CameraScale,
    CameraRotation,
    CameraDelay,
    MarkerOffset,
    HeadingGain,
)


def effect_class(name: str) -> type[Effect] | None:
    """The effect called ``name``, or None."""
    return next((effect for effect in CATALOGUE if effect.name == name), None)
