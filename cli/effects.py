"""``slipmargin effects``: physics that a robot file may add to the paper's model."""

from __future__ import annotations

from typing import Annotated

import typer

from .render import columns, refuse, say

app = typer.Typer(help="The effects that a robot file may hold.", rich_markup_mode=None)


_Markdown = typer.Option("--markdown", help="The whole catalogue, as docs/effects.md holds it.")


@app.command("list")
def listing(markdown: Annotated[bool, _Markdown] = False) -> None:
    """Name every effect, the variable it is traced to and what it says."""
    from slipmargin.effects.catalogue import CATALOGUE

    from .effects_page import lines

    if markdown:
        return say(*lines())
    for effect in CATALOGUE:
        law = (effect.__doc__ or "").strip().splitlines()[0].rstrip(".")
        say(f"{effect.name:<23}{effect.traced_to.value:<17}{law}")


@app.command()
def show(name: Annotated[str, typer.Argument(metavar="NAME", help="Name of an effect.")]) -> None:
    """Print an effect's law, source and parameters, and the table to put into a robot file."""
    from slipmargin.effects.catalogue import CATALOGUE, effect_class
    from slipmargin.io.robot_text import effect_text

    effect = effect_class(name)
    if effect is None:
        known = ", ".join(e.name for e in CATALOGUE)
        refuse("NAME", f"{name!r} is not a known effect", f"use one of: {known}")
    say(
        f"{effect.name}: {' '.join((effect.__doc__ or '').split())}",
        f"source: {effect.source}",
        f"traced to: {effect.traced_to.value}; rewrites: {effect.part.value}",
        f"to confirm it: {effect.confirm}",
        "",
    )
    say(
        *columns(
            ("parameter", "unit", "low", "null", "high", "meaning"),
            [
                (p.name, p.unit, f"{p.low:g}", f"{p.null:g}", f"{p.high:g}", p.meaning)
                for p in effect.parameters
            ],
        )
    )
    say("", "In a robot file (these values do nothing):", effect_text(effect.null()))
