"""A data set: what somebody believes of a robot and what it really did on one floor."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.data.noise import LastingNoise
from slipmargin.data.pulls import Pulls
from slipmargin.data.record import Record
from slipmargin.effects.recipe import Recipe
from slipmargin.errors import InputError

#: Standard deviations that a camera, or a scale, may be said to have [m, rad, N].
LEAST_NOISE, MOST_NOISE = 1e-9, 1e3
NOISE_CURE = f"noise is positive: give it, from {LEAST_NOISE:g} to {MOST_NOISE:g}"


class WheelSignal(Enum):
    """What the wheel columns of a data set are."""

    MEASURED = "measured"  #: omega and theta are encoder values
    COMMANDED = "commanded"  #: only the commanded speeds are known


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Member:
    """One data set of a campaign: its robot and surface, and what it shares with others of the same word.

    ``folder`` is where it was read; ``noise_stated`` says whether its file states the noise of the pose;
    ``nominal_rate_Hz`` is that of rows without time stamps.
    """

    name: str
    recipe: Recipe
    surface: str
    floor: str
    loading: str
    instrument: str
    folder: str = ""
    pulls: Pulls | None = None
    noise_stated: bool = True
    nominal_rate_Hz: float | None = None


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DataSet:
    """A robot as its user believes it to be, and its measured runs, pulls or both on one floor.

    Parameters
    ----------
    name : str
        The folder's name.
    folder : str
        Where it was read; empty where it was not.
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
    lasting : LastingNoise or None
        The part of the noise that lasts from sample to sample; None where it is white.
    nominal_rate_Hz : float or None
        Rows a second [Hz] of a log without time stamps; None where every row has its time.
    members : tuple of Member
        The data sets of a campaign whose runs these are; empty where they are of one data set.
    member_of : tuple of int
        The number of each trial's member.
    unused : tuple of str
        What its file states and nothing that it holds has a use for.
    """

    name: str
    recipe: Recipe
    surface: str
    wheel_signal: WheelSignal
    trials: tuple[Record, ...]
    sigma: Array | None = None
    pulls: Pulls | None = None
    lasting: LastingNoise | None = None
    nominal_rate_Hz: float | None = None
    members: tuple[Member, ...] = ()
    member_of: tuple[int, ...] = ()
    folder: str = ""
    unused: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.members:
            assert len(self.member_of) == len(self.trials), "every trial of a campaign has its member"
        self.recipe.robot.surface(self.surface)
        if not self.trials and self.pulls is None:
            raise InputError(
                "trials",
                "there is no trial and no pulls.csv",
                "put one CSV a run into the folder trials, or add pulls.csv",
            )
        if self.sigma is not None:
            sigma = frozen("sigma", self.sigma, (3,))
            if not LEAST_NOISE <= sigma.min() <= sigma.max() <= MOST_NOISE:
                raise InputError("sigma", f"is {sigma.tolist()}", NOISE_CURE)
            object.__setattr__(self, "sigma", sigma)
        for trial in self.trials:
            self._check_wheels(trial)

    def _check_wheels(self, trial: Record) -> None:
        count = len(self.recipe.robot.wheels)
        if trial.wheels not in (0, count):
            raise InputError(
                trial.name,
                f"has {trial.wheels} wheels, the robot has {count}",
                "give the columns of every wheel",
            )
        if self.wheel_signal is WheelSignal.COMMANDED:
            known, wanted = [trial.omega_cmd], "omega{i}_cmd_rad_s"
        else:
            known, wanted = [trial.omega, trial.theta], "omega{i}_rad_s or theta{i}_rad"
        has = [np.isfinite(signal).any(axis=0) for signal in known if signal is not None]
        if any(each.all() for each in has):
            return
        some = np.any([np.zeros(count, dtype=bool), *has], axis=0)
        if some.all():
            raise InputError(
                trial.name,
                "has angles of some wheels and speeds of others",
                "give angles or speeds of every wheel",
            )
        lacks = int(np.argmin(some)) + 1
        raise InputError(
            trial.name,
            f"wheel {lacks} has no {wanted.format(i=lacks)}",
            f'add it, or change wheel_signal = "{self.wheel_signal.value}"',
        )
