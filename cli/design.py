"""``slipmargin design``: which machine to build, every limit over varied dimensions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import say

VaryOpt = Annotated[
    list[str],
    typer.Option(
        "--vary", metavar="KEY=FROM:TO:STEP", help="Vary a quantity; or KEY=a,b,c.  Again for a product."
    ),
]
GoalOpt = Annotated[str, typer.Option("--objective", metavar="NAME", help="What makes a design the best.")]
FrontOpt = Annotated[str, typer.Option("--front", metavar="A,B", help="Objectives of the Pareto front.")]
UnsureOpt = Annotated[
    list[str] | None,
    typer.Option("--uncertain", metavar="KEY=LOW:HIGH", help="Only known within an interval: be robust."),
]
StaticOpt = Annotated[bool, typer.Option("--static", help="Static limits only: quicker.")]
LapsOpt = Annotated[bool, typer.Option("--laps", help="Also plan benchmark paths: slower.")]
JobsOpt = Annotated[int | None, typer.Option(metavar="N", help="Processes; -1: every core.")]
DaskOpt = Annotated[str | None, typer.Option(metavar="tcp://…", help="A Dask scheduler to work on.")]
PageOpt = Annotated[Path | None, typer.Option("--html", metavar="FILE", help="Write a page that sums up.")]


def design(
    robot: RobotArg,
    surface: SurfaceOpt,
    vary: VaryOpt,
    objective: GoalOpt = "f_worst",
    front: FrontOpt = "f_worst,start_worst_m_s2",
    uncertain: UnsureOpt = None,
    static: StaticOpt = False,
    laps: LapsOpt = False,
    jobs: JobsOpt = None,
    scheduler: DaskOpt = None,
    out: OutOpt = None,
    plot: PlotOpt = None,
    html: PageOpt = None,
    json: JsonOpt = None,
) -> None:
    """Every limit of every design over grids of the robot file's quantities; the best one and why.

    Quantities: delta_deg, wheels, circle_radius_m, com_y_m, coefficient_ratio … (a wrong one lists all).
    With --out, work that takes long is kept in pieces in FILE.work: killed and run again, it goes on.
    """
    from .design_report import report
    from .design_run import Asked, run_design

    found = run_design(
        Asked(
            robot=robot,
            surface=surface,
            vary=tuple(vary),
            objective=objective,
            front=front,
            uncertain=tuple(uncertain or ()),
            static=static,
            laps=laps,
            jobs=jobs,
            scheduler=scheduler,
            out=out,
            plot=plot,
            html=html,
            json=json,
        )
    )
    if not put_json(json, found.as_json()):
        say(*report(found, table=out is None), *(f"written: {path}" for path in (out, plot, html) if path))
