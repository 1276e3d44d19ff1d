"""What the shell offers for an argument: robots, surfaces, effects, quantities, each with what it is.

Shells ask by running the program with ``_SLIPMARGIN_COMPLETE`` set; ``slipmargin --install-completion`` sets
them up.  Whatever fails here offers nothing: a shell is no place for an error.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import typer

from slipmargin.errors import SlipmarginError

Offers = Iterator[tuple[str, str]]


def robots(incomplete: str) -> Offers:
    """Built-in robots; a shell offers files by itself where none fits."""
    import slipmargin as sm

    yield from _fitting(sm.built_in_robots().items(), incomplete)


def surfaces(context: typer.Context, incomplete: str) -> Offers:
    """The surfaces of the robot that the line names already, else those of the built-in robots."""
    import slipmargin as sm

    # The value of the option is not there yet, so the parser has stopped: the line's words are all there is.
    line = [word for word in (context.parent.args if context.parent else []) if not word.startswith("-")]
    found: dict[str, str] = {}
    for names in (line, sm.built_in_robots()):
        for name in names:
            try:
                robot = sm.read_robot(name).robot
            except SlipmarginError:
                continue
            for surface in robot.surfaces:
                found.setdefault(surface.name, f"of {robot.name}")
        if found:
            break
    yield from _fitting(found.items(), incomplete)


def published_surfaces(incomplete: str) -> Offers:
    """The surfaces of the friction library."""
    import slipmargin as sm

    yield from _fitting(((name, "") for name in sm.known_surfaces().names), incomplete)


def effects(incomplete: str) -> Offers:
    """The effects of the catalogue."""
    import slipmargin as sm

    yield from _fitting(((effect.name, effect.summary) for effect in sm.known_effects().effects), incomplete)


def quantities(incomplete: str) -> Offers:
    """What ``--vary`` takes, up to the sign before the values."""
    import slipmargin as sm

    offers = ((f"{key}=", meaning) for key, meaning in sm.known_quantities().items())
    yield from _fitting(offers, incomplete)


def _fitting(offers: Iterable[tuple[str, str]], incomplete: str) -> Offers:
    for name, meaning in offers:
        if name.startswith(incomplete):
            yield name, meaning
