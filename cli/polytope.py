"""``slipmargin polytope``: every force and moment the wheels can put on the body without slipping."""

from __future__ import annotations

from typing import Annotated

import typer

from .options import DeltaOpt, GripOpt, JsonOpt, PlotOpt, RobotArg, SurfaceOpt, check_outputs, deliver
from .render import at_options


def polytope(
    robot: RobotArg,
    surface: SurfaceOpt,
    delta_deg: DeltaOpt = None,
    grip: GripOpt = None,
    rigid: Annotated[bool, typer.Option("--rigid", help="All wheels on rigid material.")] = False,
    json: JsonOpt = None,
    plot: PlotOpt = None,
) -> None:
    """The wrenches (Fx, Fy, Mz) about the centre of mass, body frame: vertices, facets, volume.

    Of the robot's own grip, or of --grip.  A coupled grip has a curved surface: points of it are given.
    """
    import slipmargin as sm

    check_outputs(json=json, plot=plot, reads=(robot,))
    with at_options(surface="--surface", grip="--grip", wheel_angle_deg="--delta-deg"):
        found = sm.polytope(sm.read_robot(robot, wheel_angle_deg=delta_deg, grip=grip), surface, rigid=rigid)
    deliver(found, plot=plot, json=json)
