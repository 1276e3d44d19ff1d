"""``slipmargin bounds``: accelerations and cornering speeds that do not slip."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import (
    ChanceOpt,
    DeltaOpt,
    GripOpt,
    JsonOpt,
    MarginOpt,
    OutOpt,
    PlotOpt,
    ReportOpt,
    RobotArg,
    SeedOpt,
    SurfaceOpt,
    check_outputs,
    deliver,
)
from .render import at_options


def bounds(
    robot: RobotArg,
    surface: SurfaceOpt,
    margin: MarginOpt = 0.1,
    delta_deg: DeltaOpt = None,
    grip: GripOpt = None,
    step: Annotated[float, typer.Option(metavar="DEG", help="Step of the directions [deg].")] = 1.0,
    robust: Annotated[
        bool,
        typer.Option("--robust", help=("Whichever wheels stand on rigid sectors (default: all on rollers).")),
    ] = False,
    yaw: Annotated[
        float | None,
        typer.Option(
            metavar="RAD/S²",
            help="Yaw acceleration that the exported sets keep in reserve (default: a tenth of spinning).",
        ),
    ] = None,
    export: Annotated[
        tuple[str, Path] | None,
        typer.Option(
            metavar="TOOL FILE", help=("Write the limits as nav2, roadrunner, pathplanner, choreo or json.")
        ),
    ] = None,
    chance: ChanceOpt = None,
    seed: SeedOpt = 0,
    out: OutOpt = None,
    plot: PlotOpt = None,
    json: JsonOpt = None,
    report: ReportOpt = None,
) -> None:
    """Acceleration limits in motion by direction: speeding up, turning, braking, cornering, spinning.

    In motion the rollers turn and their friction is drag, so the pull limit divided by the mass is not an
    acceleration limit.  Directions are counted from the body's +x (convention "paper": 0° to the right, 90°
    forward; "ros": 0° forward, 90° to the left).
    Where the robot file gives numbers with a spread ("12 ± 0.5"), the chance of slip is printed too.
    """
    import slipmargin as sm

    tool, file = (None, None) if export is None else export
    check_outputs(file, out=out, json=json, report=report, plot=plot, reads=(robot,))
    with at_options(
        surface="--surface",
        grip="--grip",
        wheel_angle_deg="--delta-deg",
        step_deg="--step",
        yaw_rad_s2="--yaw",
        chance="--chance",
        seed="--seed",
        margin="--margin",
        export="--export",
    ):
        found = sm.bounds(
            sm.read_robot(robot, wheel_angle_deg=delta_deg, grip=grip),
            surface,
            margin=margin,
            step_deg=step,
            robust=robust,
            export=tool,
            yaw_rad_s2=yaw,
            chance=chance,
            seed=seed,
        )
    texts: dict[Path | str, str | bytes] = {}
    if tool is not None and file is not None:
        texts[file] = found.export_text(tool)
    deliver(found, out=out, plot=plot, json=json, report=report, texts=texts)
