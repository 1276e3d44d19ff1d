"""``slipmargin design``: which robot to build: dimensions varied, or several ideas side by side."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from . import complete
from .options import JsonOpt, OutOpt, PlotOpt, SurfaceOpt, check_outputs, deliver
from .render import at_options, refuse, say_at_once, stages

GOAL, FRONT = "f_worst", "f_worst,start_worst_m_s2"
RobotsArg = Annotated[
    list[str],
    typer.Argument(
        metavar="ROBOT...",
        help="Robot file or built-in name; several are compared as they are.",
        autocompletion=complete.robots,
    ),
]
VaryOpt = Annotated[
    list[str] | None,
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
    robots: RobotsArg,
    surface: SurfaceOpt,
    vary: VaryOpt = None,
    objective: GoalOpt = GOAL,
    front: FrontOpt = FRONT,
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
    """Which robot to build: the best over varied quantities and why, or several ideas side by side.

    Several ROBOTs are compared: which is best at starting, driving, braking, cornering, turning, pushing,
    and where each one's battery belongs.  Those that chance may have made differ are alike.
    One ROBOT with --vary: every limit over grids of its quantities.
    Quantities: delta_deg, wheels, circle_radius_m, com_y_m, coefficient_ratio … (a wrong one lists all).
    With --out, work that takes long is kept in pieces in FILE.work: killed and run again, it goes on.
    """
    import slipmargin as sm

    check_outputs(out=out, json=json, report=html, plot=plot, reads=robots)
    if len(robots) > 1:
        _only_for_one(
            {
                "--vary": vary is not None,
                "--objective": objective != GOAL,
                "--front": front != FRONT,
                "--uncertain": uncertain is not None,
                "--static": static,
                "--laps": laps,
                "--jobs": jobs is not None,
                "--scheduler": scheduler is not None,
            }
        )
        with at_options(surface="--surface", robots="ROBOT"):
            compared = sm.compare(robots, surface)
        return deliver(compared, out=out, plot=plot, json=json, report=html)
    if vary is None:
        refuse("--vary", "is missing", "name a quantity to vary, or several robots to compare")
    resume = None if out is None else out.with_name(out.name + ".work")
    with (
        _kept_in(resume),
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
            robots[0],
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


@contextmanager
def _kept_in(resume: Path | None) -> Iterator[None]:
    """Whoever interrupts long work is told where its finished pieces are."""
    try:
        yield
    except KeyboardInterrupt:
        if resume is not None and any(resume.glob("piece-*.json")):
            say_at_once(f"finished pieces are kept in {resume}: the same command goes on from there")
        raise


def _only_for_one(given: dict[str, bool]) -> None:
    """Refuse an option that has no meaning where robots are compared as they are."""
    for name, there in given.items():
        if there:
            refuse(name, "has no effect on several robots", "leave it out, or give one robot")
