"""``slipmargin.import_logs``: raw logs into a data set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from slipmargin.api.log_formats import importer_of, known_options
from slipmargin.api.result import Result
from slipmargin.api.robots import RobotLike, read_robot
from slipmargin.errors import InputError

if TYPE_CHECKING:
    from slipmargin.data.calibration import Calibration
    from slipmargin.data.data_set import DataSet
    from slipmargin.data.record import Record
    from slipmargin.io.importers.plug import Summary


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ImportResult(Result):
    """A data set made of logs, and what was read, dropped and why."""

    data_set: DataSet
    read: Summary
    calibration: Calibration | None
    calibration_given: bool
    delay_s: float | None  #: camera later than encoders [s]; None where no run starts from rest
    warnings: tuple[str, ...]

    def summary(self) -> str:
        """Runs and where they are from."""
        return f"data set {self.data_set.name}: {len(self.data_set.trials)} {self.read.format} runs"

    def lines(self) -> list[str]:
        """What was read and dropped, the calibration, and a few figures."""
        held = self.calibration
        lines = [f"calibration: {line}" for line in (() if held is None else held.lines())]
        facts = [f"{name.replace('_', ' ')}: {value:.5g}" for name, value in self.read.facts().items()]
        if self.delay_s is not None:
            apart = (
                " (spinning up with slip looks like delay; the calibration's is held)"
                if self.calibration_given
                else ""
            )
            facts.append(f"camera later than encoders by {1e3 * self.delay_s:.0f} ms on this floor{apart}")
        return [*self.read.lines(), *lines, *facts]

    def to_dict(self) -> dict[str, Any]:
        """What ``import.json`` holds."""
        held = self.calibration
        return {
            "schema": 1,
            **self.read.as_json(),
            "delay_s": self.delay_s,
            "calibration": None
            if held is None
            else {
                "scale": held.scale,
                "rotation_rad": held.rotation_rad,
                "delay_s": held.delay_s,
                "tilt_per_m": held.tilt_per_m.tolist(),
            },
            "checks": list(self.warnings),
        }

    def write_folder(self, folder: Path | str, *, force: bool = False) -> None:
        """Write the data set with ``import.json`` and, where there is one, ``calibration.toml``.

        A data set that stands there already is replaced only with ``force``.

        Raises
        ------
        InputError
            Where the folder cannot be written, or holds something else.
        """
        from slipmargin.io.calibration_file import calibration_text
        from slipmargin.io.data_set_write import check_new, write_data_set

        if not force:
            check_new(Path(folder))
        extra = {"import.json": self.to_json()}
        if self.calibration is not None:
            extra["calibration.toml"] = calibration_text(self.calibration)
        comment = f"imported from {len(self.data_set.trials)} {self.read.format} logs"
        write_data_set(Path(folder), self.data_set, extra, comment=comment)


def import_logs(
    files: Sequence[Path | str],
    format: str,
    robot: RobotLike,
    surface: str | None = None,
    *,
    calibrate: bool = False,
    calibration: Path | str | None = None,
    commanded: bool = False,
    segment_s: float | None = None,
    name: str = "imported",
    **options: Any,
) -> ImportResult:
    """A data set made of raw logs, one run each, with what was read and what was dropped.

    Parameters
    ----------
    files : list of str or Path
        The logs.
    format : str
        ``robotino``, ``csv``, ``ros``, ``robojackets``, ``wpilog``, ``advantagescope``, ``roadrunner`` or
        ``lerobot``.
    robot : str, Path, Recipe or Robot
        The robot that is believed.
    surface : str, optional
        Its surface; by default the file's first.
    calibrate : bool
        Estimate scale, rotation, delay and tilt of the camera from these runs.
    calibration : str or Path, optional
        A ``calibration.toml`` of another floor, to be held fixed.
    commanded : bool
        The wheel speeds are commanded, not measured.
    segment_s : float, optional
        Cut each log, a long recording, into runs of so many seconds [s] with a start pose each.
    name : str
        Name of the data set.
    options
        Those of the format, described at its function in :mod:`slipmargin.api.log_formats`.

    Returns
    -------
    ImportResult
        ``data_set``, and ``write(folder)``.

    Raises
    ------
    InputError
        For a fault in a log, or arguments that exclude each other.

    Examples
    --------
    >>> import slipmargin as sm
    >>> runs = sm.import_logs(["run1.txt"], "robotino", "robotino", calibrate=True)  # doctest: +SKIP
    >>> runs.write_folder("measured-runs")  # doctest: +SKIP
    """
    from slipmargin.data.calibration import calibrate as calibrated
    from slipmargin.data.checks import check_data_set
    from slipmargin.data.clean_up import repaired
    from slipmargin.data.data_set import DataSet, WheelSignal
    from slipmargin.data.segments import segments
    from slipmargin.io.calibration_file import read_calibration
    from slipmargin.io.importers.plug import import_files

    if calibrate and calibration is not None:
        raise InputError("calibrate", "is given together with a calibration", "give one of the two")
    known_options(format, options)
    recipe = read_robot(robot)
    importer = importer_of(format, options, recipe.robot, [Path(file) for file in files])
    floor = recipe.robot.surfaces[0].name if surface is None else recipe.robot.surface(surface).name
    held = None if calibration is None else read_calibration(Path(calibration))
    read = import_files(importer, [Path(file) for file in files])
    records = tuple(_with_signal(record, commanded) for record in read.records)
    if segment_s is not None:
        cut = [segments(record, segment_s) for record in records]
        records = tuple(run for runs, _ in cut for run in runs)
        if not records:
            raise InputError(
                "segment_s", f"is {segment_s:g}: no run is so long and moves", "give a shorter time"
            )
        read = read.noted([notes for _, notes in cut])
    if calibrate:
        held = calibrated(records, recipe.build(floor).geometry)
    if held is not None:
        records = tuple(held.rectified(record) for record in records)
        recipe = replace(recipe, effects=(*recipe.effects, *held.effects()))
    signal = WheelSignal.COMMANDED if commanded else WheelSignal.MEASURED
    data_set = DataSet(
        name=name,
        recipe=recipe,
        surface=floor,
        wheel_signal=signal,
        trials=records,
        nominal_rate_Hz=getattr(importer, "rate_Hz", None),
    )
    return ImportResult(
        data_set=data_set,
        read=read,
        calibration=held,
        calibration_given=calibration is not None,
        delay_s=_delay(data_set),
        warnings=tuple(str(finding) for finding in check_data_set(repaired(data_set).data_set)),
    )


def _with_signal(record: Record, commanded: bool) -> Record:
    """The record in which the only wheel speeds of a log are what they are said to be."""
    if commanded and record.omega_cmd is None:
        if record.omega is None:
            said = f"is given, and {record.name} holds no wheel speeds"
            raise InputError("commanded", said, "leave it out")
        return replace(record, omega=None, omega_cmd=record.omega)
    if not commanded and record.omega is None and record.theta is None and record.omega_cmd is not None:
        said = f"is not given, and {record.name} holds commanded speeds alone"
        raise InputError("commanded", said, "give it")
    return record


def _delay(data_set: DataSet) -> float | None:
    from slipmargin.data.delay import estimate_delay

    try:
        geometry = data_set.recipe.build(data_set.surface).geometry
        return estimate_delay(data_set.trials, geometry).value_s
    except InputError:  # no run starts from rest: nothing tells a delay, and nothing needs to
        return None
