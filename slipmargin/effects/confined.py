"""An effect that acts in some data sets of a campaign only: on one floor, in one loading, with one camera."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, final

from slipmargin.effects.effect import Effect, Part, Trace
from slipmargin.effects.general import GeneralEffect
from slipmargin.model import Model


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Confined:
    """One effect in each of some groups of data sets, with parameters of its own in each.

    ``effects`` (G) are of one kind and ``groups`` say where they act, in words; effect g acts in the data
    sets whose numbers are in ``members[g]``, and in a data set that is in no group nothing acts.
    """

    effects: tuple[Effect | GeneralEffect, ...]
    members: tuple[frozenset[int], ...]
    groups: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effects[0].name

    @property
    def part(self) -> Part:
        """The part of the model that it rewrites."""
        return self.effects[0].part

    @property
    def traced_to(self) -> Trace:
        """The variable it stands for."""
        return self.effects[0].traced_to

    def within(self, member: int) -> Effect | GeneralEffect | None:
        """The effect that acts in a data set, None where none does."""
        return next((e for e, own in zip(self.effects, self.members, strict=True) if member in own), None)

    def rewrite(self, part: Any, nominal: Model) -> Any:
        """The part with the first group's effect: what a model without a data set shows of it."""
        return self.effects[0].rewrite(part, nominal)

    def to_table(self) -> dict[str, Any]:
        """The first group's effect as a ``[[effect]]`` table; each data set has its own robot file."""
        return self.effects[0].to_table()


def acting(effects: Iterable[Effect | GeneralEffect | Confined], member: int) -> tuple[Any, ...]:
    """The effects that act in one data set of a campaign."""
    own = (e.within(member) if isinstance(e, Confined) else e for e in effects)
    return tuple(e for e in own if e is not None)


def bare(effect: Effect | GeneralEffect | Confined) -> Effect | GeneralEffect:
    """The effect itself, that of the first group where it is confined."""
    return effect.effects[0] if isinstance(effect, Confined) else effect
