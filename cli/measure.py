"""``slipmargin measure``: friction coefficients from pulls with a scale."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import GripOpt, JsonOpt, RobotArg, SeedOpt, SurfaceOpt, check_outputs, deliver
from .render import at_options


def measure(
    pulls: Annotated[Path, typer.Argument(metavar="PULLS.csv", help="Pulls: phi_rad,force_N.")],
    robot: RobotArg,
    surface: SurfaceOpt,
    grip: GripOpt = None,
    seed: SeedOpt = 0,
    json: JsonOpt = None,
) -> None:
    """Friction coefficients of each type of wheel, with intervals, from pulls with a luggage scale.

    The same file serves ``sweep --measured``.  docs/how-to/measure-friction.md says how to pull.
    """
    import slipmargin as sm

    check_outputs(json=json, reads=(pulls, robot))
    with at_options(surface="--surface", grip="--grip", seed="--seed"):
        found = sm.measure(pulls, sm.read_robot(robot, grip=grip), surface, seed=seed)
    deliver(found, json=json)
