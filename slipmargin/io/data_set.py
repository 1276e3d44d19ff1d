"""Reading a data set: the folder that holds what somebody believes of a robot and what it really did.

``robot.toml``, ``dataset.toml``, ``trials/*.csv`` and, optionally, ``pulls.csv``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from slipmargin.checks import Array, real
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import Table, parse_toml
from slipmargin.io.trial_file import read_pulls, read_trial


def read_data_set(folder: Path | str) -> DataSet:
    """Read a data set strictly: unknown keys and columns are errors.

    Raises
    ------
    InputError
        With file, key or line:column, what is wrong and what to do.
    """
    folder = Path(folder)
    path = folder / "dataset.toml"
    if not path.is_file():
        raise InputError(
            "dataset.toml",
            "is not there" if folder.is_dir() else "there is no such folder",
            "give a data set: a folder with robot.toml, dataset.toml and trials/",
            str(folder),
        )
    try:
        robot, surface, signal, sigma = _head(Table("", parse_toml(read_text(path))))
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None
    recipe = read_recipe(folder / robot)
    count = len(recipe.robot.wheels)
    trials = tuple(read_trial(file, count) for file in sorted((folder / "trials").glob("*.csv")))
    pulls = folder / "pulls.csv"
    try:
        return DataSet(
            name=folder.resolve().name,
            recipe=recipe,
            surface=surface,
            wheel_signal=signal,
            trials=trials,
            sigma=sigma,
            pulls=read_pulls(pulls, count) if pulls.exists() else None,
        )
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None


def _head(table: Table) -> tuple[str, str, WheelSignal, Array | None]:
    if table.whole("schema") != 1:
        raise InputError("schema", "is another version", "this program reads schema = 1")
    robot, surface = table.text("robot"), table.text("surface")
    signal = WheelSignal(table.word("wheel_signal", [s.value for s in WheelSignal]))
    sigma = None
    if table.has("sigma"):
        inner = table.table("sigma", "give x_m, y_m and phi_rad")
        units = {"x_m": "m", "y_m": "m", "phi_rad": "rad"}
        sigma = np.array(
            [
                real(inner.at(key), inner.number(key, unit), above=0.0, cure="noise is positive")
                for key, unit in units.items()
            ]
        )
        inner.done()
    table.done()
    return robot, surface, signal, sigma
