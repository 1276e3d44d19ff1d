"""``slipmargin reproduce``: every published number of the paper beside ours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, SeedOpt, put_json
from .render import progress, say

Folder = Annotated[
    Path, typer.Option("--out", metavar="DIR", help="Folder for reproduce.json and the figures.")
]
Search = Annotated[bool, typer.Option("--calibrate", help="Search again for what the paper does not print.")]


def reproduce(out: Folder, calibrate: Search = False, seed: SeedOpt = 0, json: JsonOpt = None) -> None:
    """Every number and figure (6 to 10) of the paper's simulations, published beside recomputed.

    Constants that the paper does not print come from a documented search and are labelled so.
    """
    from slipmargin.io.writes import check_writable

    from .reproduce_run import run_reproduction

    if out.exists() and not out.is_dir():
        from .render import refuse

        refuse("--out", f"{out} is a file", "name a folder")
    check_writable(None if json == "-" else json)
    with progress("reproduce", 4) as advance:
        report, lines = run_reproduction(out, seed, calibrate, advance)
    if not put_json(json, report):
        say(*lines)
