"""A data set: the folder that holds what somebody believes of a robot and what it really did.

``robot.toml``, ``dataset.toml``, ``trials/*.csv`` and, optionally, ``pulls.csv``.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, final

import numpy as np

from slipmargin.checks import Array, frozen, real
from slipmargin.effects.recipe import Recipe
from slipmargin.errors import InputError
from slipmargin.io.trial_file import Pulls, read_pulls, read_trial
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
    """Read a data set strictly: unknown keys, columns and files without meaning are errors.

    Raises
    ------
    InputError
        With file, key or line:column, what is wrong and what to do.
    """
    from slipmargin.io.robot_file import read_recipe

    folder = Path(folder)
    path = folder / "dataset.toml"
    table = _toml(folder, path)
    try:
        robot, surface, signal, sigma = _head(table)
    except InputError as fault:
        raise fault.in_file(str(path)) from None
    recipe = read_recipe(folder / robot)
    count = len(recipe.robot.wheels)
    files = sorted((folder / "trials").glob("*.csv"))
    trials = tuple(read_trial(file, count) for file in files)
    pulls = folder / "pulls.csv"
    try:
        return DataSet(name=folder.resolve().name, recipe=recipe, surface=surface, wheel_signal=signal,
                       trials=trials, sigma=sigma, pulls=read_pulls(pulls, count) if pulls.exists() else None)
    except InputError as fault:
        raise fault.in_file(str(path)) from None


def _toml(folder: Path, path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise InputError("dataset.toml", "is not there" if folder.is_dir() else "there is no such folder",
                         "give a data set: a folder with robot.toml, dataset.toml and trials/", str(folder))
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as fault:
        raise InputError("", f"is not TOML: {fault}", "correct it", str(path)) from None
    except UnicodeDecodeError as fault:
        raise InputError("", f"is not UTF-8 text ({fault.reason})", "save it as UTF-8", str(path)) from None


def _head(table: dict[str, Any]) -> tuple[str, str, WheelSignal, Array | None]:
    _known("", table, ("schema", "robot", "surface", "wheel_signal", "sigma"))
    if table.get("schema") != 1 or isinstance(table.get("schema"), bool):
        raise InputError("schema", f"is {table.get('schema')!r}", "this program reads schema = 1")
    robot = _text(table, "robot", "robot.toml")
    surface = _text(table, "surface", None)
    word = _text(table, "wheel_signal", None)
    signals = {s.value: s for s in WheelSignal}
    if word not in signals:
        raise InputError("wheel_signal", f"is {word!r}", f"give one of: {', '.join(signals)}")
    return robot, surface, signals[word], _sigma(table.get("sigma"))


def _known(place: str, table: dict[str, Any], keys: tuple[str, ...]) -> None:
    for key in table:
        if key not in keys:
            raise InputError(f"{place}{key}", "is not a known key", f"use one of: {', '.join(keys)}")


def _text(table: dict[str, Any], key: str, default: str | None) -> str:
    value = table.get(key, default)
    if not isinstance(value, str) or not value.strip():
        raise InputError(key, "is missing" if value is None else f"is {value!r}, not a name",
                         f'write {key} = "…"')
    return value


def _sigma(table: Any) -> Array | None:
    if table is None:
        return None
    keys = ("x_m", "y_m", "phi_rad")
    if not isinstance(table, dict):
        raise InputError("sigma", f"is {table!r}", f"give a table with {', '.join(keys)}")
    _known("sigma.", table, keys)
    for key in keys:
        if key not in table:
            raise InputError(f"sigma.{key}", "is missing", "give all three, or leave [sigma] out")
    return np.array([real(f"sigma.{key}", table[key], above=0.0, cure="noise is positive") for key in keys])
