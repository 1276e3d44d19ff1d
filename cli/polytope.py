"""``slipmargin polytope``: every force and moment the wheels can put on the body without slipping."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import DeltaOpt, JsonOpt, PlotOpt, RobotArg, SurfaceOpt, put_json
from .render import say, warn


def polytope(
    robot: RobotArg,
    surface: SurfaceOpt,
    delta_deg: DeltaOpt = None,
    rigid: Annotated[bool, typer.Option("--rigid", help="All wheels on rigid material.")] = False,
    json: JsonOpt = None,
    plot: PlotOpt = None,
) -> None:
    """The wrenches (Fx, Fy, Mz) about the centre of mass, body frame: vertices, facets, volume.

    Always of the box grip (eq. 17): a coupled grip has no facets, and lies inside.
    """
    from .machine import machine
    from .polytope_run import describe, draw, summary

    model, warning = machine(robot, surface, delta_deg, "box")
    if warning:
        warn(warning)
    wrenches, found = describe(model, rigid, (plot, json))
    if plot is not None:
        draw(wrenches, model, plot)
    if not put_json(json, found):
        say(*summary(found), *([f"written: {plot}"] if plot else []))
