"""The effects that a robot file may hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

from slipmargin.api.result import Result
from slipmargin.effects import Effect


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EffectDescription(Result):
    """One effect: its law, source, parameters and the table to put into a robot file."""

    effect: type[Effect]

    def summary(self) -> str:
        """Name, traced variable and parameters."""
        e = self.effect
        return f"effect {e.name}, traced to {e.traced_to.value}: {', '.join(p.name for p in e.parameters)}"

    def lines(self) -> list[str]:
        """The law in words, its parameters with units and bounds, and the table for a robot file."""
        from slipmargin.io.robot_text import effect_text
        from slipmargin.report.effects import effect_lines

        return [*effect_lines(self.effect), effect_text(self.effect.null())]

    def to_dict(self) -> dict[str, Any]:
        """Name, source and parameters as plain data."""
        e = self.effect
        return {
            "name": e.name,
            "source": e.source,
            "traced_to": e.traced_to.value,
            "rewrites": e.part.value,
            "parameters": {
                p.name: {"unit": p.unit, "low": p.low, "null": p.null, "high": p.high, "meaning": p.meaning}
                for p in e.parameters
            },
        }


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class EffectCatalogue(Result):
    """All effects that have a name."""

    effects: tuple[type[Effect], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(effect.name for effect in self.effects)

    def summary(self) -> str:
        """How many there are."""
        return f"{len(self.effects)} effects: {', '.join(self.names)}"

    def lines(self) -> list[str]:
        """A line an effect: its name, the variable it is traced to, what it says."""
        from slipmargin.report.effects import one_line

        return [one_line(effect) for effect in self.effects]

    def markdown(self) -> list[str]:
        """The catalogue as the page ``docs/effects.md`` holds it."""
        from slipmargin.report.effects import page_lines

        return page_lines(self.effects)

    def to_dict(self) -> dict[str, Any]:
        """Every effect as plain data."""
        return {e.name: EffectDescription(effect=e).to_dict() for e in self.effects}


def known_effects() -> EffectCatalogue:
    """The effects that a robot file may hold and that :func:`slipmargin.diagnose` looks for.

    Examples
    --------
    >>> import slipmargin as sm
    >>> "rigid_sector" in sm.known_effects().names
    True
    """
    from slipmargin.effects.catalogue import CATALOGUE

    return EffectCatalogue(effects=tuple(CATALOGUE))


def describe_effect(name: str) -> EffectDescription:
    """One effect: its law, source, parameters with units and bounds.

    Raises
    ------
    InputError
        If no effect has this name.

    Examples
    --------
    >>> import slipmargin as sm
    >>> sm.describe_effect("motor_lag").to_dict()["traced_to"]
    'actuation'
    """
    from slipmargin.io.effect_table import unknown_effect

    for effect in known_effects().effects:
        if effect.name == name:
            return EffectDescription(effect=effect)
    raise unknown_effect("name", name)
