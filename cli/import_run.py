"""What every ``slipmargin import`` does after the format has been chosen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.diagnose.calibration import Calibration, calibrate
from slipmargin.effects import Recipe
from slipmargin.io.calibration_file import calibration_text, read_calibration
from slipmargin.io.data_checks import check_data_set
from slipmargin.io.data_set_write import check_data_set_place, write_data_set
from slipmargin.io.importers.plug import Importer, Summary, import_files
from slipmargin.io.json_text import json_text
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.writes import check_writable

from .options import put_json
from .render import refuse, say, warn


def run_import(
    importer: Importer,
    files: list[Path],
    out: Path,
    robot: str,
    surface: str | None,
    wanted: bool,
    given: Path | None,
    json: str | None,
    commanded: bool = False,
) -> None:
    """Read the logs, calibrate or apply a calibration, check the result, write the data set, tell."""
    if wanted and given is not None:
        refuse("--calibrate", "is given together with --calibration", "give one of the two")
    check_data_set_place(out)
    check_writable(json)
    recipe = read_recipe(robot)
    floor = recipe.robot.surfaces[0].name if surface is None else recipe.robot.surface(surface).name
    held = None if given is None else read_calibration(given)
    summary = import_files(importer, files)
    records = summary.records
    if wanted:
        held = calibrate(records, recipe.build(floor).geometry)
    if held is not None:
        records = tuple(held.rectified(record) for record in records)
        recipe = replace(recipe, effects=(*recipe.effects, *held.effects()))
    signal = WheelSignal.COMMANDED if commanded else WheelSignal.MEASURED
    data_set = DataSet(name=out.name, recipe=recipe, surface=floor, wheel_signal=signal, trials=records)
    told = _told(summary, held, data_set, recipe, floor)
    extra = {"import.json": json_text(told)}
    if held is not None:
        extra["calibration.toml"] = calibration_text(held)
    write_data_set(out, data_set, extra, comment=f"imported from {len(records)} {summary.format} logs")
    for finding in told["checks"]:
        warn(finding)
    if not put_json(json, told):
        lines = [f"calibration: {line}" for line in (() if held is None else held.lines())]
        facts = [f"{name.replace('_', ' ')}: {value:.5g}" for name, value in summary.facts().items()]
        if told["delay_s"] is not None:
            apart = " (spinning up with slip looks like delay; the calibration's is held)" if given else ""
            facts.append(f"camera later than encoders by {1e3 * told['delay_s']:.0f} ms on this floor{apart}")
        say(*summary.lines(), *lines, *facts, f"written: {out}")


def _told(
    summary: Summary, held: Calibration | None, data_set: DataSet, recipe: Recipe, floor: str
) -> dict[str, Any]:
    from slipmargin.diagnose.delay import estimate_delay
    from slipmargin.errors import InputError

    try:
        delay: float | None = estimate_delay(data_set.trials, recipe.build(floor).geometry).value_s
    except InputError:  # no run starts from rest: nothing tells a delay, and nothing needs to
        delay = None
    calibration = (
        None
        if held is None
        else {
            "scale": held.scale,
            "rotation_rad": held.rotation_rad,
            "delay_s": held.delay_s,
            "tilt_per_m": held.tilt_per_m.tolist(),
        }
    )
    return {
        "schema": 1,
        **summary.as_json(),
        "delay_s": delay,
        "calibration": calibration,
        "checks": [str(finding) for finding in check_data_set(data_set)],
    }
