"""The effect ``floor_grain``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

from slipmargin.effects.effect import Scope
from slipmargin.effects.sliding_direction import SlidingDirection


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class FloorGrain(SlidingDirection):
    """μ ← μ [1 + cosine · cos 2β + sine · sin 2β], β the floor direction of the whole slip."""

    name = "floor_grain"
    summary = "The floor grips differently along and across its grain (planks, brushed or grooved boards)."
    scope = Scope.FLOOR
    repeats = 2
