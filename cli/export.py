"""``slipmargin export``: a robot for other programs, a limiter in C or a simulator's model file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from . import complete
from .export_c import export_c
from .options import JsonOpt, RobotArg, check_new_file, check_outputs, deliver
from .render import at_options

_ENDINGS = {"sdf": ".sdf", "urdf": ".urdf", "mjcf": ".xml"}
_HELP = {
    "sdf": "Write Gazebo's model: mu, mu2, fdir1 and slip compliances of each wheel.",
    "urdf": "Write a URDF with Gazebo's friction of each wheel.",
    "mjcf": "Write MuJoCo's model: wheels with rollers as bodies of their own.",
}

app = typer.Typer(help="Write a robot for other programs.", rich_markup_mode=None)
app.command("c")(export_c)


@app.callback()
def _group() -> None:
    """Write a robot for other programs: a limiter in C, or a simulator's model.

    The simulator's model is in the axes of REP 103, the limiter in those of the robot file.
    """


def _simulator(form: str) -> Callable[..., None]:
    def export(
        robot: RobotArg,
        surface: Annotated[
            str | None,
            typer.Option(
                "--surface",
                metavar="S",
                help="Surface (default: the file's first).",
                autocompletion=complete.surfaces,
            ),
        ] = None,
        out: Annotated[
            Path | None, typer.Option("--out", metavar="FILE", help="File to write (default: ROBOT.FORMAT).")
        ] = None,
        json: JsonOpt = None,
    ) -> None:
        import slipmargin as sm

        with at_options(surface="--surface"):
            found = sm.export_simulator(robot, form, surface)
        file = out or Path(f"{Path(found.robot.name).name}{_ENDINGS[form]}")  # a name is no way to a folder
        check_outputs(file, json=json, reads=(robot,))
        if out is None:
            check_new_file(file, "name it with --out to replace it, or give another name")
        deliver(found, texts={file: found.text}, json=json)

    return export


for _form, _said in _HELP.items():
    app.command(_form, help=_said)(_simulator(_form))
