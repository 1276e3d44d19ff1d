"""The ``[[effect]]`` tables of a robot file, read strictly."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any

from slipmargin.effects import AnyEffect, Effect, WheelEffect, general
from slipmargin.effects.catalogue import CATALOGUE, effect_class
from slipmargin.errors import InputError
from slipmargin.io.toml_table import Table, nearest


def read_effect(table: Table, wheels: tuple[str, ...]) -> AnyEffect:
    """The effect that a table describes, of a robot with these wheels.

    Raises
    ------
    InputError
        With the key, what is wrong and what to do.
    """
    name = table.text("name")
    if name.startswith(general.PREFIX):
        try:
            effect = general.from_table({"name": name} | table.raw())
            effect.check_wheels(len(wheels))
            return effect
        except InputError as fault:
            raise fault.within(table.place) from None
    kind = effect_class(name)
    if kind is None:
        raise unknown_effect(table.at("name"), name, f"; {general.PREFIX}<variable> are general forms")
    return _named(kind, table, wheels)


def unknown_effect(place: str, name: str, more: str = "") -> InputError:
    """The fault that no effect is called ``name``: with the nearest one, and how all are listed."""
    guess = nearest(name, [e.name for e in CATALOGUE])
    hint = f"did you mean {guess!r}? " if guess else ""
    return InputError(
        place, f"{name!r} is not a known effect", f"{hint}`slipmargin effects list` shows all{more}"
    )


def _named(kind: type[Effect], table: Table, names: tuple[str, ...]) -> Effect:
    optional = {f.name: f.default for f in fields(kind) if f.default is not MISSING}  # type: ignore[arg-type]
    values: dict[str, Any] = {
        p.name: table.number(p.name, p.unit, optional.get(p.name)) for p in kind.parameters
    }
    if table.has("wheels"):
        if not issubclass(kind, WheelEffect):
            raise InputError(
                table.at("wheels"),
                f"is not a known key of {kind.name}",
                "remove it: this effect acts on the whole robot",
            )
        chosen = table.take("wheels", "")
        if not isinstance(chosen, list) or not chosen or any(c not in names for c in chosen):
            raise InputError(
                table.at("wheels"),
                f"is {chosen!r}",
                f"list the names of wheels it acts on: {', '.join(names)}",
            )
        values["wheels"] = tuple(chosen)
    table.done()
    try:
        effect = kind(**values)
        effect.check_wheels(len(names))
        return effect
    except InputError as fault:
        raise fault.within(table.place) from None
