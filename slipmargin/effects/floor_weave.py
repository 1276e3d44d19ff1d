"""The effect ``floor_weave``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.effects.effect import Scope
from slipmargin.effects.sliding_direction import SlidingDirection


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorWeave(SlidingDirection):
    """μ ← μ [1 + cosine · cos 4β + sine · sin 4β], β the floor direction of the whole slip."""

    name = "floor_weave"
    summary = "The floor grips differently along its threads or joints and between them (carpet, tiles)."
    scope = Scope.FLOOR
    repeats = 4
