"""``slipmargin reproduce``: every published number and claim of the paper beside ours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, SeedOpt, check_outputs, deliver
from .render import at_options, stages

Folder = Annotated[
    Path, typer.Option("--out", metavar="DIR", help="Folder for reproduce.json and the figures.")
]
Search = Annotated[bool, typer.Option("--calibrate", help="Search again for what the paper does not print.")]
Study = Annotated[
    bool,
    typer.Option(
        "--identifiability",
        help="Also study what the printed results leave open: radius and inertia, the sign of φ on carpet.",
    ),
]


def reproduce(
    out: Folder,
    calibrate: Search = False,
    identifiability: Study = False,
    seed: SeedOpt = 0,
    json: JsonOpt = None,
) -> None:
    """Every number, claim and figure (6 to 10) of the paper, published beside recomputed, with a verdict.

    Constants that the paper does not print come from a documented search and are labelled so.
    """
    import slipmargin as sm

    check_outputs(json=json, folder=out)
    with stages() as progress, at_options(seed="--seed"):
        found = sm.reproduce(seed=seed, search=calibrate, identifiability=identifiability, progress=progress)
        names = found.write_folder(out)
    deliver(found, json=json, written=[out / name for name in names])
