"""Examples at the end of every ``--help``: command → lines that can be typed as they stand."""

from __future__ import annotations

#: Files that the examples name: waypoints, wheel speeds, pulls, a data set are the reader's own.
EXAMPLES: dict[str, tuple[str, ...]] = {
    "sweep": (
        "slipmargin sweep ohio-kiwi --surface paper",
        "slipmargin sweep mybot.toml --surface floor --measured pulls.csv --report pulls.html",
    ),
    "polytope": ("slipmargin polytope mecanum4 --surface floor --plot forces.png",),
    "bounds": (
        "slipmargin bounds mecanum4 --surface floor --report limits.html",
        "slipmargin bounds mybot.toml --surface floor --margin 0.2 --export nav2 limits.yaml",
    ),
    "explore": ("slipmargin explore mecanum4", "slipmargin explore mybot.toml --surface floor --no-browser"),
    "plan": (
        "slipmargin plan mecanum4 way.csv --surface floor --out plan.csv --report plan.html",
        "slipmargin plan mecanum4 way.csv --surface floor --max-speed 1 --export choreo plan.traj",
    ),
    "check": (
        "slipmargin check mecanum4 plan.csv --surface floor --report check.html",
        "slipmargin check mecanum4 plan.csv --surface floor --margin 0.1 --strict",
    ),
    "simulate": ("slipmargin simulate mecanum4 speeds.csv --surface floor --out run.csv --report run.html",),
    "stop": ("slipmargin stop mecanum4 --surface floor --speed 1",),
    "monitor": ("slipmargin monitor mybot.toml log.csv --surface floor --out slip.csv",),
    "design": (
        "slipmargin design mecanum4 omni4 robotino --surface floor --report ideas.html",
        "slipmargin design ohio-kiwi --surface paper --vary delta_deg=0:60:5",
        "slipmargin design omni4 --surface floor --vary front_angle_deg=30:60:10 "
        "--vary rear_angle_deg=30:60:10",
    ),
    "diagnose": ("slipmargin diagnose runs --out report",),
    "next-run": (
        "slipmargin next-run runs --space 3x2 --out next",
        "slipmargin next-run runs --space 3x2 --runs 2 --margin 0.3 --max-speed 0.5 --report next.html",
    ),
    "import ros": ("slipmargin import ros run1.bag run2.bag --robot mybot.toml --out runs",),
    "import csv": (
        "slipmargin import csv run1.csv --robot mybot.toml --out runs --time t:ms --x x:mm --y y:mm "
        "--heading yaw:deg --wheel fl:rpm --wheel fr:rpm --wheel rl:rpm --wheel rr:rpm",
    ),
    "import robotino": ("slipmargin import robotino *.csv --surface gray --out runs",),
    "import wpilog": ("slipmargin import wpilog match1.wpilog --robot mybot.toml --out runs",),
    "import advantagescope": ("slipmargin import advantagescope match1.csv --robot mybot.toml --out runs",),
    "import roadrunner": ("slipmargin import roadrunner run1.json --robot mybot.toml --out runs",),
    "import robojackets": ("slipmargin import robojackets run1.csv --out runs",),
    "import lerobot": (
        "slipmargin import lerobot episode.parquet --tracker tracker.csv --robot lekiwi.toml --out runs",
    ),
    "export c": ("slipmargin export c mybot.toml --surface floor --out limiter.h",),
    "export sdf": ("slipmargin export sdf mybot.toml --surface floor --out mybot.sdf",),
    "export urdf": ("slipmargin export urdf mybot.toml --surface floor --out mybot.urdf",),
    "export mjcf": ("slipmargin export mjcf mybot.toml --surface floor --out mybot.xml",),
    "reproduce": ("slipmargin reproduce --out paper",),
    "robots list": ("slipmargin robots list",),
    "robots show": ("slipmargin robots show mecanum4",),
    "robots check": ("slipmargin robots check mybot.toml",),
    "robots new": ("slipmargin robots new mybot --type mecanum",),
    "robots from-urdf": ("slipmargin robots from-urdf mybot.urdf.xacro",),
    "surfaces list": ("slipmargin surfaces list",),
    "surfaces show": ("slipmargin surfaces show carpet-omni-williams2002",),
    "measure": ("slipmargin measure pulls.csv mybot.toml --surface floor",),
    "effects list": ("slipmargin effects list",),
    "effects show": ("slipmargin effects show rigid_sector",),
}


def add_examples(command: object, name: str = "") -> None:
    """Put the examples below the help of a command and of the commands under it, and lists' lines in full."""
    text = " ".join((getattr(command, "help", None) or "").partition("\n\n")[0].split())
    if name and text:  # else what does not fit into one line of a list is cut
        command.short_help = text  # type: ignore[attr-defined]
    lines = EXAMPLES.get(name)
    if lines is not None:
        plural = "s" if len(lines) > 1 else ""
        command.epilog = "\n".join(["\b", f"Example{plural}:", *(f"  {line}" for line in lines)])  # type: ignore[attr-defined]
    for word, one in getattr(command, "commands", {}).items():
        add_examples(one, f"{name} {word}".strip())
