"""Every named effect, one line each; an effect defined elsewhere is registered."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import final, overload

from slipmargin.effects.camera_delay import CameraDelay
from slipmargin.effects.camera_lens import CameraLens
from slipmargin.effects.camera_rotation import CameraRotation
from slipmargin.effects.camera_scale import CameraScale
from slipmargin.effects.clock_rate import ClockRate
from slipmargin.effects.command_dead_band import CommandDeadBand
from slipmargin.effects.command_ramp import CommandRamp
from slipmargin.effects.command_saturation import CommandSaturation
from slipmargin.effects.dragging_point import DraggingPoint
from slipmargin.effects.effect import Effect
from slipmargin.effects.elliptic_grip import EllipticGrip
from slipmargin.effects.floor_border import FloorBorder
from slipmargin.effects.floor_bump import FloorBump
from slipmargin.effects.floor_grain import FloorGrain
from slipmargin.effects.floor_nap import FloorNap
from slipmargin.effects.floor_patch import FloorPatch
from slipmargin.effects.floor_ramp import FloorRamp
from slipmargin.effects.floor_seam import FloorSeam
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.floor_weave import FloorWeave
from slipmargin.effects.friction_coefficients import FrictionCoefficients
from slipmargin.effects.general import PREFIX
from slipmargin.effects.heading_gain import HeadingGain
from slipmargin.effects.load_transfer import LoadTransfer
from slipmargin.effects.marker_offset import MarkerOffset
from slipmargin.effects.motor_lag import MotorLag
from slipmargin.effects.motor_torque import MotorTorque
from slipmargin.effects.push import Push
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.effects.roller_coupling import RollerCoupling
from slipmargin.effects.rolling_resistance import RollingResistance
from slipmargin.effects.slip_ratio_friction import SlipRatioFriction
from slipmargin.effects.speed_droop import SpeedDroop
from slipmargin.effects.stiff_roller import StiffRoller
from slipmargin.effects.stribeck import Stribeck
from slipmargin.effects.tether import Tether
from slipmargin.effects.trailing_load import TrailingLoad
from slipmargin.effects.wheel_loads import WheelLoads
from slipmargin.effects.wheel_play import WheelPlay
from slipmargin.effects.wheel_radius import WheelRadius
from slipmargin.effects.wheel_runout import WheelRunout
from slipmargin.effects.wheel_toe import WheelToe
from slipmargin.effects.wheel_wobble import WheelWobble
from slipmargin.effects.yaw_inertia import YawInertia
from slipmargin.errors import InputError


@final
class Catalogue(Sequence[type[Effect]]):
    """The effects that robot files may name and a diagnosis tries, in this order; no two of one name."""

    def __init__(self, effects: Iterable[type[Effect]]) -> None:
        self._effects: list[type[Effect]] = []
        for effect in effects:
            self.register(effect)

    @overload
    def __getitem__(self, index: int) -> type[Effect]: ...
    @overload
    def __getitem__(self, index: slice) -> list[type[Effect]]: ...
    def __getitem__(self, index: int | slice) -> type[Effect] | list[type[Effect]]:
        return self._effects[index]

    def __len__(self) -> int:
        return len(self._effects)

    def register(self, effect: type[Effect]) -> None:
        """Add an effect at the end.

        Raises
        ------
        InputError
            Where an effect of that name is there already, or the name is one of general forms.
        """
        if effect.name.startswith(PREFIX):
            raise InputError("effect", f"{effect.name!r} begins with {PREFIX}", "choose another name")
        if any(known.name == effect.name for known in self._effects):
            raise InputError("effect", f"{effect.name!r} is in the catalogue already", "choose another name")
        self._effects.append(effect)

    def remove(self, effect: type[Effect]) -> None:
        """Take an effect out again; ``ValueError`` where it is not in the catalogue."""
        self._effects.remove(effect)

    @contextmanager
    def registered(self, effect: type[Effect]) -> Iterator[None]:
        """The catalogue with one more effect, for as long as the context lasts."""
        self.register(effect)
        try:
            yield
        finally:
            self.remove(effect)


CATALOGUE = Catalogue(
    (
        FrictionCoefficients,
        RigidSector,
        StiffRoller,
        WheelLoads,
        LoadTransfer,
        TrailingLoad,
        YawInertia,
        Stribeck,
        SlipRatioFriction,
        RollerCoupling,
        EllipticGrip,
        RollingResistance,
        DraggingPoint,
        FloorTilt,
        FloorNap,
        FloorGrain,
        FloorWeave,
        FloorPatch,
        FloorBorder,
        FloorRamp,
        FloorSeam,
        FloorBump,
        Push,
        Tether,
        WheelRadius,
        WheelRunout,
        WheelToe,
        WheelWobble,
        MotorLag,
        CommandRamp,
        CommandDeadBand,
        CommandSaturation,
        MotorTorque,
        SpeedDroop,
        WheelPlay,
        CameraScale,
        CameraLens,
        CameraRotation,
        CameraDelay,
        ClockRate,
        MarkerOffset,
        HeadingGain,
    )
)


def effect_class(name: str) -> type[Effect] | None:
    """The effect called ``name``, or None."""
    return next((effect for effect in CATALOGUE if effect.name == name), None)
