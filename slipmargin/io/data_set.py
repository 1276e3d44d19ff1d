"""Reading a data set: the folder that holds what somebody believes of a robot and what it really did.

``robot.toml``, ``dataset.toml``, and ``trials/*.csv``, ``pulls.csv`` or both.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.data.data_set import LEAST_NOISE, MOST_NOISE, NOISE_CURE, DataSet, WheelSignal
from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.source import read_text
from slipmargin.io.table import OTHER_MARKS, header_names
from slipmargin.io.toml_table import Table, document
from slipmargin.io.trial_file import read_pulls, read_trial

#: The file of a data set in its folder.
FILE = "dataset.toml"
#: Endings of files that a run may have been written to, and columns of which it has one in its first line.
_LIKE_RUNS, _COLUMNS = (".txt", ".tsv", ".dat"), ("t_s", "x_m", "phi_rad", "omega1_rad_s", "theta1_rad")


def read_data_set(folder: Path | str) -> DataSet:
    """Read a data set, by its folder or its ``dataset.toml``, strictly: unknown keys and columns are errors.

    Raises
    ------
    InputError
        With file, key or line:column, what is wrong and what to do.
    """
    folder = Path(folder)
    folder = folder.parent if folder.name == FILE and folder.is_file() else folder
    path = folder / FILE
    if not path.is_file():
        raise InputError(
            FILE,
            "is not there" if folder.is_dir() else "there is no such folder",
            "give a data set: a folder with robot.toml, dataset.toml and trials/",
            str(folder),
        )
    try:
        robot, surface, signal, sigma, sigma_N, rate = _head(
            document(read_text(path), "write schema, robot and surface (docs/reference/data-set.md)")
        )
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None
    recipe = read_recipe(folder / robot)
    count = len(recipe.robot.wheels)
    trials = tuple(read_trial(file, count, rate) for file in _runs(folder / "trials"))
    file = folder / "pulls.csv"
    pulls = replace(read_pulls(file, count), sigma_N=sigma_N) if file.exists() else None
    try:
        if signal is None and trials:
            raise InputError("wheel_signal", "is missing", 'write wheel_signal = "measured" or "commanded"')
        if pulls is None and sigma_N is not None:
            raise InputError("sigma.force_N", "is given without pulls.csv", "remove it or add pulls.csv")
        of_runs = {"wheel_signal": signal, "nominal_rate_Hz": rate, "[sigma] of the pose": sigma}
        return DataSet(
            name=folder.resolve().name,
            recipe=recipe,
            surface=surface,
            wheel_signal=signal or WheelSignal.MEASURED,  # without runs nothing depends on it
            trials=trials,
            sigma=sigma,
            pulls=pulls,
            nominal_rate_Hz=rate,
            folder=str(folder),
            unused=() if trials else tuple(key for key, said in of_runs.items() if said is not None),
        )
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None


def _runs(folder: Path) -> list[Path]:
    """The CSV files of a folder of runs, in the order of their names; hidden ones are none.

    Raises
    ------
    InputError
        At what looks like a run and is not read.
    """
    found = []
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.name.startswith("."):
            continue
        if path.is_file() and path.suffix.lower() == ".csv":
            found.append(path)
        elif _is_like_run(path) or (path.is_dir() and any(_runs(path))):
            cure = "move runs into trials/ itself as .csv files, and other files out of it"
            raise InputError("", "would not be read as a run", cure, str(path))
    return found


def _is_like_run(path: Path) -> bool:
    """Whether the first line of a file of another ending names columns of a run."""
    if path.suffix.lower() not in _LIKE_RUNS or not path.is_file():
        return False
    with path.open("rb") as file:
        line = file.readline(4096).decode("utf-8", "replace")
    for mark in OTHER_MARKS:
        line = line.replace(mark, ",")
    return any(name in _COLUMNS for name in header_names(line))


def _head(table: Table) -> tuple[str, str, WheelSignal | None, Array | None, float | None, float | None]:
    """Robot file, surface, wheel columns, noise of the pose (3,) and of pulls [N], nominal rate [Hz]."""
    robot, surface = table.text("robot"), table.text("surface")
    signal = None
    if table.has("wheel_signal"):
        signal = WheelSignal(table.word("wheel_signal", [s.value for s in WheelSignal]))
    sigma, sigma_N, rate = None, None, None
    if table.has("nominal_rate_Hz"):
        cure = "give the rows a second of a log without time stamps"
        rate = real("nominal_rate_Hz", table.number("nominal_rate_Hz", "Hz"), above=0.0, cure=cure)
    if table.has("sigma"):
        inner = table.table("sigma", "give x_m, y_m and phi_rad")
        units = {"x_m": "m", "y_m": "m", "phi_rad": "rad", "force_N": "N"}

        def noise(key: str) -> float:
            said = inner.number(key, units[key])
            return real(inner.at(key), said, low=LEAST_NOISE, high=MOST_NOISE, cure=NOISE_CURE)

        if inner.has("force_N"):
            sigma_N = noise("force_N")
        if sigma_N is None or any(inner.has(key) for key in ("x_m", "y_m", "phi_rad")):
            sigma = np.array([noise(key) for key in ("x_m", "y_m", "phi_rad")])
        inner.done()
    table.done()
    return robot, surface, signal, sigma, sigma_N, rate
