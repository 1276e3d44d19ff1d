"""``slipmargin export c``: the limiter of a robot as one C header."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import JsonOpt, MarginOpt, RobotArg, SurfaceOpt, check_outputs, deliver
from .render import at_options


def export_c(
    robot: RobotArg,
    surface: SurfaceOpt,
    out: Annotated[Path, typer.Option("--out", metavar="FILE.h", help="The header to write.")],
    margin: MarginOpt = 0.1,
    json: JsonOpt = None,
) -> None:
    """Write one C99 and C++17 header that keeps velocity commands within the grip, direction kept.

    sm_limit_twist gives the next velocity command, sm_limit_acceleration cuts an acceleration back,
    sm_margin says which share of the grip is in use.  No allocation, no library but the square root.
    """
    import slipmargin as sm

    check_outputs(out, json=json, reads=(robot,))
    with at_options(surface="--surface", margin="--margin"):
        limiter = sm.Limiter(robot, surface, margin=margin)
    deliver(limiter, json=json, texts={out: limiter.c_header()})
