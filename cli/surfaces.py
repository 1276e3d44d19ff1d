"""``slipmargin surfaces``: published friction coefficients that a robot file may name."""

from __future__ import annotations

from typing import Annotated

import typer

from . import complete
from .options import JsonOpt, check_outputs, deliver
from .render import at_options

app = typer.Typer(help="Published friction coefficients that a robot file may name.", rich_markup_mode=None)


@app.command("list")
def listing(json: JsonOpt = None) -> None:
    """Name every published surface with its coefficients, its wheel and its floor."""
    import slipmargin as sm

    check_outputs(json=json)
    deliver(sm.known_surfaces(), json=json)


@app.command()
def show(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME", help="Name of a surface of the list.", autocompletion=complete.published_surfaces
        ),
    ],
    json: JsonOpt = None,
) -> None:
    """Print how a surface was measured, where it was published, and the table for a robot file."""
    import slipmargin as sm

    check_outputs(json=json)
    with at_options(name="NAME"):
        found = sm.describe_surface(name)
    deliver(found, json=json)
