"""``slipmargin reproduce``: every published number and claim of the paper beside ours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, SeedOpt, put_json
from .render import columns, progress, refuse, say

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
    from slipmargin.io.json_text import json_text
    from slipmargin.io.work_folder import make_folder
    from slipmargin.io.writes import check_writable, write_together
    from slipmargin.paper.reproduction import reproduce_paper, steps
    from slipmargin.plots.reproduction import paper_figures
    from slipmargin.plots.style import picture
    from slipmargin.report.reproduction import (
        claim_table,
        closing_lines,
        fig8_table,
        number_table,
        reproduction_report,
        row_notes,
    )

    if out.exists() and not out.is_dir():
        refuse("--out", f"{out} is a file", "name a folder")
    check_writable(None if json == "-" else json)
    with progress("reproduce", 1 + steps(search=calibrate, study=identifiability)) as advance:
        done = reproduce_paper(seed=seed, search=calibrate, study=identifiability, advance=advance)
        figures = paper_figures(done)
        advance()
    report = reproduction_report(done, sorted(figures))
    files: dict[Path | str, str | bytes] = {out / name: picture(f, "png") for name, f in figures.items()}
    files[out / "reproduce.json"] = json_text(report)
    make_folder(out)
    write_together(files)
    if not put_json(json, report):
        say(*columns(*number_table(done)), *row_notes(done.numbers), "")
        say(*columns(*claim_table(done)), *row_notes(done.claims), "")
        say(*columns(*fig8_table(done.fig8)), "", *closing_lines(done))
        say(f"written: {out / 'reproduce.json'} and figures")
