"""Physics that may be missing: one file an effect, a catalogue, and the recipe that applies them."""

from slipmargin.effects.effect import Effect as Effect, Parameter as Parameter, Part as Part, Trace as Trace
from slipmargin.effects.general import GeneralEffect as GeneralEffect
from slipmargin.effects.recipe import AnyEffect as AnyEffect, Recipe as Recipe
