"""``slipmargin diagnose``: what physics the model lacks, judged by measured runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, SeedOpt, check_outputs, deliver
from .render import at_options, stages

_Folder = typer.Argument(
    metavar="DATASET",
    help="Folder with dataset.toml, the robot file and trials/; or a campaign (TOML) that names several.",
)
_Budget = typer.Option(
    "--budget", metavar="SECONDS", help="Stop the search after this time and report the best answer so far."
)
_Out = typer.Option("--out", metavar="DIR", help="Folder for the report; made if it is not there.")


def diagnose(
    dataset: Annotated[Path, _Folder],
    out: Annotated[Path, _Out],
    seed: SeedOpt = 0,
    budget: Annotated[float | None, _Budget] = None,
    json: JsonOpt = None,
) -> None:
    """Find what the model lacks, prove it on runs no fit has seen, hand back a corrected robot file.

    Writes report.html (the page to read), report.json, the figures and corrected.toml, all together or
    none.  The same data and seed give the same report.
    """
    import slipmargin as sm

    check_outputs(json=json, folder=out, reads=(dataset,))
    with stages() as progress, at_options(seed="--seed", budget_s="--budget"):
        found = sm.diagnose(dataset, seed=seed, progress=progress, budget_s=budget)
        progress("drawing", 0.5)
        written = found.write_folder(out)
    deliver(found, json=json, written=[out / name for name in written])
