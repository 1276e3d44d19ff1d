"""``slipmargin explore``: a local page with sliders for a robot's numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import RobotArg
from .render import at_options, say, say_at_once

FloorOpt = Annotated[
    str | None, typer.Option("--surface", metavar="S", help="Surface of the robot file; else its first.")
]
PortOpt = Annotated[int, typer.Option("--port", metavar="N", min=0, max=65535, help="Port; 0: a free one.")]
BrowserOpt = Annotated[bool, typer.Option("--no-browser", help="Only print the address.")]
ReportOpt = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="A report.html to show on its own tab.")
]


def explore(
    robot: RobotArg,
    surface: FloorOpt = None,
    report: ReportOpt = None,
    port: PortOpt = 0,
    no_browser: BrowserOpt = False,
) -> None:
    """Open a page with sliders for friction, centre of mass, wheel angle and margin; limits follow at once.

    The page is served to this machine only (127.0.0.1) and asks no other host for anything.  Ctrl-C ends it,
    with exit status 130.
    """
    from webbrowser import open_new_tab

    import slipmargin as sm

    with at_options(surface="--surface", port="--port"):
        page = sm.explore(robot, surface, report=report)
        server = page.serve(port)
    try:
        say(f"{page.design.robot.name} on {page.design.surface}: {server.address}", "Ctrl-C ends it.")
        say_at_once(*(f"warning: {line}" for line in page.warnings))
        if not no_browser:
            open_new_tab(server.address)
        server.serve_forever()
    except KeyboardInterrupt:
        say_at_once(f"stopped: {server.address} is closed")
        raise
    finally:
        server.server_close()
