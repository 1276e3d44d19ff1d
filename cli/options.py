"""Arguments and options that commands share, so that each means the same everywhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os.path import realpath
from pathlib import Path
from typing import Annotated, Any

import typer

from . import complete

RobotArg = Annotated[
    str,
    typer.Argument(metavar="ROBOT", help="Robot file or built-in name.", autocompletion=complete.robots),
]
SurfaceOpt = Annotated[
    str,
    typer.Option(
        "--surface", metavar="S", help="Surface of the robot file.", autocompletion=complete.surfaces
    ),
]
OutOpt = Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Write the table as CSV.")]
PlotOpt = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Draw it; .png, .svg or .pdf by ending.")
]
JsonOpt = Annotated[
    str | None, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for stdout.")
]
ReportOpt = Annotated[
    Path | None,
    typer.Option("--report", metavar="FILE", help="Write a page to read and to print: one .html file."),
]
SeedOpt = Annotated[int, typer.Option("--seed", metavar="N", help="Seed of everything random.")]
ChanceOpt = Annotated[
    float | None,
    typer.Option(
        "--chance",
        metavar="P",
        help="Chance of slip for which a number is wanted; the robot file must give spreads.",
    ),
]
MarginOpt = Annotated[
    float,
    typer.Option(
        "--margin", metavar="M", min=0.0, max=0.99, help="Share of the grip kept in reserve, 0 to 0.99."
    ),
]
GripOpt = Annotated[
    str | None,
    typer.Option("--grip", metavar="SET", help="box, disc-strip or ellipse instead of the file's."),
]
DeltaOpt = Annotated[
    float | None, typer.Option("--delta-deg", metavar="D", help="Wheel angle δ of a three-wheel robot [deg].")
]

TrajectoryOpt = Annotated[
    tuple[str, Path] | None,
    typer.Option(
        "--export",
        metavar="TOOL FILE",
        help="Write the motion for choreo, pathplanner, roadrunner or ros-path (a bag).",
    ),
]

PoseOpt = Annotated[
    str | None,
    typer.Option(
        "--pose",
        metavar="NAME",
        help="Pose2d or Pose3d (default: by type); NAME:deg or NAME:rad for x, y and heading as an array.",
    ),
]
WheelOpt = Annotated[
    list[str] | None,
    typer.Option(
        "--wheel",
        metavar="NAME[:UNIT]",
        help="A mecanum drive's wheels (default: by type), or a number for each wheel in the robot file's "
        "order, with its unit (rad/s, rpm, rad, turn …); -NAME where it turns the other way.",
    ),
]


def check_outputs(
    *others: Path | str | None,
    out: Path | None = None,
    plot: Path | None = None,
    json: str | None = None,
    report: Path | None = None,
    folder: Path | None = None,
    data_set: Path | None = None,
    replace: bool = False,
    reads: Sequence[Path | str | None] = (),
) -> None:
    """Refuse an output that cannot be written, or whose name ends as another kind's, before any work is done.

    So is one that stands among what the command ``reads``, or is named twice.  The files are those of
    :func:`deliver`, and ``others``, which may end in anything.

    A data set that stands there already is refused unless it may be replaced.

    Raises
    ------
    InputError
        Placed at the file.
    """
    from slipmargin.errors import InputError
    from slipmargin.io.writes import check_format, check_writable

    kinds = {"CSV table": out, "picture": plot, "JSON text": None if json == "-" else json, "page": report}
    files = (*others, *kinds.values())
    if folder is not None:
        from slipmargin.io.folder import check_folder

        check_folder(folder)
        place = Path(folder).resolve()
        above = (place, *place.parents)
        same = next((f for f in files if f is not None and Path(f).resolve() in above), None)
        if same is not None:
            raise InputError("", "is asked for as a file and as a folder", "give them two names", str(same))
    if data_set is not None:
        from slipmargin.io.data_set_write import check_data_set_place, check_new

        place = Path(data_set).resolve()
        inside = next((f for f in files if f is not None and place in Path(f).resolve().parents), None)
        if inside is not None:
            raise InputError("", "lies in the data set that is written", "give another folder", str(inside))
        runs = place / "trials"  # realpath: a link that leads to itself is refused where it is read
        lost = next((f for f in reads if f is not None and runs in Path(realpath(f)).parents), None)
        if lost is not None:
            problem = "is read, and lies in the data set that is replaced"
            raise InputError("", problem, "give --out another folder", str(lost))
        (check_data_set_place if replace else check_new)(data_set)
    _check_apart(files, folder, reads)
    check_writable(*files)
    for kind, file in kinds.items():
        if file is not None:
            check_format(file, kind)


def _check_apart(
    files: Sequence[Path | str | None], folder: Path | None, reads: Sequence[Path | str | None]
) -> None:
    """Refuse an output that would be written twice, or that is read as well: one of the two would be lost.

    A folder among ``reads`` stands for every file in it.
    """
    from slipmargin.errors import InputError

    read = [Path(f) for f in reads if f is not None and Path(f).is_file()]
    folders = [Path(f).resolve() for f in reads if f is not None and Path(f).is_dir()]
    if folder is not None:
        target = Path(folder).resolve()
        runs = [p for p in (target, *target.parents) if p.name == "trials"]  # runs that are read stand there
        if target in folders or any(f in p.parents for p in runs for f in folders):
            raise InputError("", "is read as well as written", "give the output another name", str(folder))
    seen: set[Path] = set()
    for file in files:
        if file is None:
            continue
        if str(file) == "-":
            raise InputError("", "stdout takes JSON text alone", "name a file, or use --json -", "-")
        place = Path(file).resolve()
        if place.exists() and not place.is_file():
            continue  # a device takes everything
        if place.exists() and (
            any(place.samefile(f) for f in read) or any(folder in place.parents for folder in folders)
        ):
            raise InputError("", "is read as well as written", "give the output another name", str(file))
        if place in seen:
            raise InputError("", "is asked for twice", "give the outputs two names", str(file))
        seen.add(place)


def check_new_file(file: Path, cure: str) -> None:
    """Refuse a file that is there already, where nobody has said that it may be replaced.

    Raises
    ------
    InputError
        Placed at the file.
    """
    from slipmargin.errors import InputError

    if file.exists():
        raise InputError("", "is there already", cure, str(file))


def deliver(
    found: Any,
    *,
    out: Path | None = None,
    plot: Path | None = None,
    json: str | None = None,
    report: Path | None = None,
    texts: Mapping[Path | str, str | bytes] | None = None,
    export: tuple[str, Path] | None = None,
    written: Sequence[Path | str] = (),
) -> None:
    """Write a result's files, all or none, then print what the command says and name ``written`` too.

    ``export`` is a motion's file for another tool; a bag is a folder, and is written before the files.
    """
    import slipmargin as sm

    from .render import at_options, made, say, warn

    texts = dict(texts or {})
    if export is not None:
        tool, file = export
        with at_options(tool="--export"):
            if tool == "ros-path":
                sm.export_trajectory(found, tool, file)
                written = [*written, file]
            else:
                texts[file] = sm.trajectory_text(found, tool, file.name)
    if report is not None:
        texts[report] = found.page_text(made())
    found.write_files(table=out, plot=plot, json=None if json == "-" else json, texts=texts)
    warn(*getattr(found, "warnings", ()))
    if json == "-":
        say(found.to_json().rstrip("\n"))
        return
    table = found.table_lines() if out is None else []
    named = [path for path in (out, plot, *texts, *written) if path]
    say(*found.lines(), *(["", *table] if table else []), *(f"written: {path}" for path in named))
