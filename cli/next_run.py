"""``slipmargin next-run``: which runs to drive next, and what they would tell."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, MarginOpt, PlotOpt, ReportOpt, SeedOpt, check_outputs, deliver
from .render import at_options, refuse, stages, warn

_Folder = typer.Argument(
    metavar="DATASET", help="Folder with dataset.toml, the robot file and trials/ (or pulls.csv alone)."
)
_Space = typer.Option(
    "--space",
    metavar="XxY",
    help="Floor to drive on, its sides along x and y [m], about the middle of the runs: 3x2. "
    "By default what the runs have covered.",
)
_Runs = typer.Option("--runs", metavar="N", help="How many runs to propose.")
_Longest = typer.Option(
    "--longest", metavar="S", help="Longest run [s] (default: as the longest one so far)."
)
_MaxSpeed = typer.Option("--max-speed", metavar="V", help="Speed cap [m/s].")
_MaxYaw = typer.Option("--max-yaw-rate", metavar="W", help="Yaw rate cap [rad/s].")
_Budget = typer.Option(
    "--budget", metavar="SECONDS", help="Stop the search for explanations after this time."
)
_Out = typer.Option("--out", metavar="DIR", help="Folder for the runs as CSV; made if it is not there.")


def next_run(
    dataset: Annotated[Path, _Folder],
    space: Annotated[str | None, _Space] = None,
    runs: Annotated[int, _Runs] = 3,
    margin: MarginOpt = 0.1,
    longest: Annotated[float | None, _Longest] = None,
    max_speed: Annotated[float | None, _MaxSpeed] = None,
    max_yaw_rate: Annotated[float | None, _MaxYaw] = None,
    out: Annotated[Path | None, _Out] = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
    seed: SeedOpt = 0,
    budget: Annotated[float | None, _Budget] = None,
) -> None:
    """Diagnose a data set, then propose the runs that tell most of what it leaves open.

    Each run goes into --out as a table of pose and wheel speeds over time (run-1.csv, as plan writes it) and
    as the waypoints of its legs (run-1-path-1.csv, as plan reads them).  It begins and ends at rest inside
    the space and keeps the margin for every explanation that is left.
    """
    import slipmargin as sm

    check_outputs(json=json, report=report, plot=plot, folder=out, reads=(dataset,))
    with (
        stages() as progress,
        at_options(
            space="--space",
            runs="--runs",
            margin="--margin",
            longest_s="--longest",
            max_speed_m_s="--max-speed",
            max_yaw_rate_rad_s="--max-yaw-rate",
            seed="--seed",
            budget_s="--budget",
            picture="--plot",
        ),
    ):
        found = sm.next_run(
            dataset,
            space_m=None if space is None else _sides(space),
            runs=runs,
            margin=margin,
            longest_s=longest,
            max_speed_m_s=max_speed,
            max_yaw_rate_rad_s=max_yaw_rate,
            seed=seed,
            progress=progress,
            budget_s=budget,
            picture=plot is not None,
        )
    written = [] if out is None else found.write_folder(out)
    if out is not None and not written:
        warn("--out has no effect: the data set holds pulls and no runs")
    deliver(found, plot=plot, json=json, report=report, written=[(out or Path()) / name for name in written])


def _sides(text: str) -> tuple[float, float]:
    """``3x2`` as two sides [m]."""
    parts = text.lower().replace("×", "x").split("x")
    try:
        a, b = (float(part) for part in parts)
    except ValueError:
        refuse("--space", f"is {text!r}", "give two sides in metres, 3x2")
    return a, b
