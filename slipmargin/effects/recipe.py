"""A recipe: a robot, a surface and the effects on top.  Building it again is how the loop closes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

from slipmargin.effects.confined import Confined
from slipmargin.effects.effect import Effect
from slipmargin.effects.general import GeneralEffect
from slipmargin.model import Model, nominal_model
from slipmargin.model.loads import centred
from slipmargin.robot import Robot

#: A named effect, one traced to a variable without a name, or either in some data sets of a campaign.
AnyEffect = Effect | GeneralEffect | Confined


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recipe:
    """A robot with the effects that its file lists or that a diagnosis found."""

    robot: Robot
    effects: tuple[AnyEffect, ...] = ()

    def with_effects(self, *effects: AnyEffect) -> Recipe:
        """The same recipe with more effects."""
        return replace(self, effects=(*self.effects, *effects))

    def build(self, surface: str) -> Model:
        """The model of this machine on ``surface``: nominal, then each effect in turn."""
        nominal = nominal_model(self.robot, surface)
        return with_effects(nominal, self.effects)


def with_effects(nominal: Model, effects: tuple[AnyEffect, ...]) -> Model:
    """``nominal`` with each effect's part rewritten, in the order given (effects commute)."""
    model = nominal
    for effect in effects:
        field = effect.part.field
        model = replace(model, **{field: effect.rewrite(getattr(model, field), nominal)})
    return replace(model, inertia=centred(model.inertia, model.loads, model.geometry.position_m))
