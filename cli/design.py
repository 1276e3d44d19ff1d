"""``slipmargin design``: which machine to build, every limit over varied dimensions."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import complete
from .options import JsonOpt, OutOpt, PlotOpt, RobotArg, SurfaceOpt, check_outputs, deliver
from .render import at_options, stages

VaryOpt = Annotated[
    list[str],
    typer.Option(
        "--vary",
        metavar="KEY=FROM:TO:STEP",
        help="Vary a quantity; or KEY=a,b,c.  Again for a product.",
        autocompletion=complete.quantities,
    ),
]
GoalOpt = Annotated[str, typer.Option("--objective", metavar="NAME", help="What makes a design the best.")]
FrontOpt = Annotated[str, typer.Option("--front", metavar="A,B", help="Objectives of the Pareto front.")]
UnsureOpt = Annotated[
    list[str] | None,
    typer.Option(
        "--uncertain",
        metavar="KEY=LOW:HIGH",
        help="Only known within an interval: be robust.",
        autocompletion=complete.quantities,
    ),
]
StaticOpt = Annotated[bool, typer.Option("--static", help="Static limits only: quicker.")]
LapsOpt = Annotated[bool, typer.Option("--laps", help="Also plan benchmark paths: slower.")]
JobsOpt = Annotated[int | None, typer.Option(metavar="N", help="Processes; -1: every core.")]
DaskOpt = Annotated[str | None, typer.Option(metavar="tcp://…", help="A Dask scheduler to work on.")]
PageOpt = Annotated[
    Path | None, typer.Option("--report", "--html", metavar="FILE", help="Write a page that sums up.")
]


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
    import slipmargin as sm

    check_outputs(out, html, json, plot=plot)
    resume = None if out is None else out.with_name(out.name + ".work")
    with (
        stages("designs") as report,
        at_options(
            surface="--surface",
            vary="--vary",
            objective="--objective",
            front="--front",
            uncertain="--uncertain",
            jobs="--jobs",
            scheduler="--scheduler",
        ),
    ):
        found = sm.design(
            robot,
            surface,
            vary,
            objective=objective,
            front=front,
            uncertain=uncertain or (),
            static=static,
            laps=laps,
            jobs=jobs,
            scheduler=scheduler,
            resume=resume,
            progress=report,
        )
    deliver(found, out=out, plot=plot, json=json, report=html)
    found.forget_work()
