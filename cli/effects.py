"""``slipmargin effects``: physics that a robot file may add to the paper's model."""

from __future__ import annotations

from typing import Annotated

import typer

from . import complete
from .render import at_options, say

app = typer.Typer(help="The effects that a robot file may hold.", rich_markup_mode=None)


_Markdown = typer.Option("--markdown", help="The whole catalogue, as docs/effects.md holds it.")


@app.command("list")
def listing(markdown: Annotated[bool, _Markdown] = False) -> None:
    """Name every effect, the variable it is traced to and what it says."""
    import slipmargin as sm

    known = sm.known_effects()
    say(*(known.markdown() if markdown else known.lines()))


@app.command()
def show(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="Name of an effect.", autocompletion=complete.effects)
    ],
) -> None:
    """Print an effect's law, source and parameters, and the table to put into a robot file."""
    import slipmargin as sm

    with at_options(name="NAME"):
        found = sm.describe_effect(name)
    say(*found.lines())
