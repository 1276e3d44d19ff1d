"""``slipmargin export``: a robot for other programs."""

from __future__ import annotations

import typer

from .export_c import export_c

app = typer.Typer(help="Write a robot for other programs.", rich_markup_mode=None)
app.command("c")(export_c)


@app.callback()
def _group() -> None:
    """Write a robot for other programs: a limiter in C."""
