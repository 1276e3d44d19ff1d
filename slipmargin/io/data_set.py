"""A data set: the folder that holds what somebody believes of a robot and what it really did.

``robot.toml``, ``dataset.toml``, ``trials/*.csv`` and, optionally, ``pulls.csv``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.effects.recipe import Recipe
from slipmargin.errors import InputError
from slipmargin.io.robot_file import read_recipe
from slipmargin.io.source import read_text
from slipmargin.io.toml_table import Table, parse_toml
from slipmargin.io.trial_file import read_pulls, read_trial
from slipmargin.motions.pulls import Pulls
from slipmargin.motions.record import Record


class WheelSignal(Enum):
    """What the wheel columns of a data set are."""

    MEASURED = "measured"  #: omega and theta are encoder values
    COMMANDED = "commanded"  #: only the commanded speeds are known


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DataSet:
    """A robot as its user believes it to be, and its measured runs on one floor.

    Parameters
    ----------
    name : str
        The folder's name.
    recipe : Recipe
        Robot with the effects its file lists.
    surface : str
        The surface of the robot file on which the runs took place.
    wheel_signal : WheelSignal
        Whether wheel speeds and angles are measured or only commanded.
    trials : tuple of Record
        One a run, in the order of their names.
    sigma : array (3,) or None
        Measurement noise (one standard deviation) of x [m], y [m], φ [rad], where stated.
    pulls : Pulls or None
        Measured breakaway pulls.
    """

    name: str
    recipe: Recipe
    surface: str
    wheel_signal: WheelSignal
    trials: tuple[Record, ...]
    sigma: Array | None = None
    pulls: Pulls | None = None

    def __post_init__(self) -> None:
        self.recipe.robot.surface(self.surface)
        if not self.trials:
            raise InputError("trials", "there is no trial", "put one CSV a run into the folder trials")
        if self.sigma is not None:
            sigma = frozen("sigma", self.sigma, (3,))
            if sigma.min() <= 0.0:
                raise InputError("sigma", f"is {sigma.tolist()}", "noise is positive")
            object.__setattr__(self, "sigma", sigma)
        for trial in self.trials:
            self._check_wheels(trial)

    def _check_wheels(self, trial: Record) -> None:
        count = len(self.recipe.robot.wheels)
        if trial.wheels not in (0, count):
            raise InputError(trial.name, f"has {trial.wheels} wheels, the robot has {count}",
                             "give the columns of every wheel")
        if self.wheel_signal is WheelSignal.COMMANDED:
            known, wanted = [trial.omega_cmd], "omega{i}_cmd_rad_s"
        else:
            known, wanted = [trial.omega, trial.theta], "omega{i}_rad_s or theta{i}_rad"
        has = np.zeros(count, dtype=bool)
        for signal in known:
            if signal is not None:
                has |= np.isfinite(signal).any(axis=0)
        if not has.all():
            lacks = int(np.argmin(has)) + 1
            raise InputError(trial.name, f"wheel {lacks} has no {wanted.format(i=lacks)}",
                             f"add it, or change wheel_signal = \"{self.wheel_signal.value}\"")


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
        raise InputError("dataset.toml", "is not there" if folder.is_dir() else "there is no such folder",
                         "give a data set: a folder with robot.toml, dataset.toml and trials/", str(folder))
    try:
        robot, surface, signal, sigma = _head(Table("", parse_toml(read_text(path))))
    except InputError as fault:
        raise fault if fault.source else fault.in_file(str(path)) from None
    recipe = read_recipe(folder / robot)
    count = len(recipe.robot.wheels)
    trials = tuple(read_trial(file, count) for file in sorted((folder / "trials").glob("*.csv")))
    pulls = folder / "pulls.csv"
    try:
        return DataSet(name=folder.resolve().name, recipe=recipe, surface=surface, wheel_signal=signal,
                       trials=trials, sigma=sigma, pulls=read_pulls(pulls, count) if pulls.exists() else None)
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
        sigma = np.array([real(inner.at(key), inner.number(key, unit), above=0.0, cure="noise is positive")
                          for key, unit in units.items()])
        inner.done()
    table.done()
    return robot, surface, signal, sigma
