"""Physics that may be missing: one file an effect, a catalogue, and the recipe that applies them."""

from slipmargin.effects.effect import (
    Effect as Effect,
    Parameter as Parameter,
    Part as Part,
    Quantity as Quantity,
    Scope as Scope,
    Trace as Trace,
    Variant as Variant,
    WheelEffect as WheelEffect,
    parameter as parameter,
)
from slipmargin.effects.general import GeneralEffect as GeneralEffect
from slipmargin.effects.recipe import AnyEffect as AnyEffect, Recipe as Recipe
