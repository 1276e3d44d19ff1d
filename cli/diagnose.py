"""``slipmargin diagnose``: what physics the model lacks, judged by measured runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, SeedOpt, put_json
from .render import say

_Folder = typer.Argument(metavar="DATASET", help="Folder with dataset.toml, the robot file and trials/.")
_Out = typer.Option("--out", metavar="DIR", help="Folder for the report; made if it is not there.")


def diagnose(
    dataset: Annotated[Path, _Folder], out: Annotated[Path, _Out], seed: SeedOpt = 0, json: JsonOpt = None
) -> None:
    """Find what the model lacks, prove it on runs no fit has seen, hand back a corrected robot file.

    Writes report.html (the page to read), report.json, the figures and corrected.toml, all together or
    none.  The same data and seed give the same report.
    """
    from .diagnose_run import results, run_diagnose, summary

    found = run_diagnose(dataset, out, seed, json)
    results(found, out)
    if not put_json(json, found.report):
        say(*summary(found), *(f"written: {out / name}" for name in found.written))
