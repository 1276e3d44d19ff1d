"""Every named effect, one line each."""

from __future__ import annotations

from slipmargin.effects.effect import Effect
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.rigid_sector import RigidSector
from slipmargin.effects.wheel_loads import WheelLoads

CATALOGUE: tuple[type[Effect], ...] = (
    RigidSector,
    WheelLoads,
    FloorTilt,
)


def effect_class(name: str) -> type[Effect] | None:
    """The effect called ``name``, or None."""
    return next((effect for effect in CATALOGUE if effect.name == name), None)
