"""What the base model shows of the data before any effect is searched: clocks, noise, runs of another floor.

Faults that the data tell of themselves are mended first (:mod:`slipmargin.data.clean_up`).  The base model
then predicts every run once.  Whether camera and wheels keep the same time, how large the noise is and how
long it lasts, and whether some runs took place on another floor is read from what it misses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Index
from slipmargin.data.campaign import each
from slipmargin.data.clean_up import repaired
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.odometry_match import Arrangement
from slipmargin.data.record import Record
from slipmargin.data.repair import Repair
from slipmargin.data.run_arrangement import alike, arranged
from slipmargin.diagnosis.camera_clock import one_clock
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.held_out import held_out_runs, searched_runs
from slipmargin.diagnosis.noise_reading import measured_noise, without_outliers
from slipmargin.diagnosis.other_floor import one_floor
from slipmargin.diagnosis.settings import SETTINGS


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ready:
    """A data set to search in, with its noise, and everything that was mended or left out on the way.

    ``held`` are the numbers of the runs to hold out of the search.
    """

    data_set: DataSet
    noise_estimated: bool
    repairs: tuple[Repair, ...]
    held: Index

    def with_white_noise(self) -> Ready:
        """The same data set with the white part of its noise alone."""
        data_set, lasting = self.data_set, self.data_set.lasting
        if lasting is None or data_set.sigma is None:
            return self
        return replace(
            self,
            data_set=replace(data_set, sigma=data_set.sigma * np.sqrt(1.0 - lasting.share), lasting=None),
            repairs=tuple(r for r in self.repairs if r.kind != "lasting_noise"),
        )


def ready(
    data_set: DataSet,
    repairs: tuple[Repair, ...] | None = None,
    seed: int = 0,
    held: Index | None = None,
) -> Ready:
    """The data set mended, with the noise that it has, and without runs from another floor.

    Parameters
    ----------
    data_set : DataSet
        As it was read; with ``repairs`` as :func:`slipmargin.data.clean_up.repaired` returned it.
    repairs : tuple of Repair, optional
        What was mended already; by default it is done here.
    seed : int
        That of the diagnosis: the noise is measured on the runs that it does not hold out.
    held : array of int, optional
        The runs to hold out of those that are left; by default they are drawn.
    """
    if repairs is None:
        data_set, repairs = each(data_set, lambda d: ((fixed := repaired(d)).data_set, fixed.repairs))
    done = [*repairs]
    data_set, more = each(data_set, _alike)
    done += more
    stated = data_set.sigma
    held = held_runs_of(data_set, seed) if held is None else held
    data_set, more = measured_noise(data_set, searched_runs(len(data_set.trials), held))
    assert data_set.sigma is not None
    estimated = stated is None or not np.array_equal(data_set.sigma, stated)
    return Ready(
        data_set=data_set,
        noise_estimated=estimated,
        repairs=(*done, *more),
        held=held,
    )


def held_runs_of(data_set: DataSet, seed: int) -> Index:
    """Numbers of the runs of a data set to hold out, drawn by what the model as it is misses each by.

    A run of which nothing but noise is left without its outliers is a quiet one, however many it has.
    """
    everyone = np.arange(len(data_set.trials), dtype=np.int64)
    kept, _, said = without_outliers(data_set, everyone)
    misses = problem_of(data_set).misses((), everyone)
    if said:
        left = problem_of(kept).misses((), everyone)
        misses = np.where(left <= SETTINGS.noise_chi, left, misses)
    return held_out_runs(misses, seed)


def _alike(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """With the wheel columns, the commands, the clock and the floor that most of the runs have."""
    data_set, columns = alike(data_set, lambda stated, other: _misses_less(data_set, (other,), (stated,)))
    data_set, done = _commands(data_set)
    data_set, clock = one_clock(data_set, problem_of(data_set))
    if clock:  # how the wheels move from row to row shows once the camera keeps their time
        data_set, held = _commands(data_set)
        clock = (*clock, *held)
    data_set, floor = one_floor(data_set)
    return data_set, (*columns, *done, *clock, *floor)


def spins(data_set: DataSet, arrangement: Arrangement) -> bool:
    """Whether wheels that slip, and not another arrangement of the columns, are why they match so badly."""
    stated = tuple(trial.first() for trial in data_set.trials)
    return not _misses_less(data_set, tuple(arranged(r, arrangement) for r in stated), stated)


def _misses_less(data_set: DataSet, some: tuple[Record, ...], others: tuple[Record, ...]) -> bool:
    """Whether the model, which slips, misses some records by less than it misses the same runs' others."""
    count = len(some)
    problem = problem_of(data_set, (*some, *others), (*range(count), *range(count)))
    missed = np.log(np.maximum(problem.misses((), np.arange(2 * count)), 1e-12))
    return bool(missed[:count].sum() < missed[count:].sum())


def _commands(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """With commands held from row to row where the base model predicts that better than straight lines.

    It must be much better, for a lag looks like that too, or better than chance makes it and near the noise.
    """
    if data_set.wheel_signal is not WheelSignal.COMMANDED or data_set.trials[0].commands_held:
        return data_set, ()
    holding = replace(data_set, trials=tuple(replace(t, commands_held=True) for t in data_set.trials))
    everyone = np.arange(len(data_set.trials), dtype=np.int64)
    either = [problem_of(d) for d in (data_set, holding)]
    straight, held = (float(np.sum(p.residuals([()], [everyone])[0] ** 2)) for p in either)
    near = held <= SETTINGS.noise_chi**2 * either[1].samples(everyone)
    if held > SETTINGS.held_leaves * straight and not (near and straight - held >= SETTINGS.held_gains):
        return data_set, ()
    return holding, (
        Repair(
            kind="held_commands",
            runs=tuple(t.name for t in data_set.trials),
            size=float(np.sqrt(held / straight)),
            unit="1",
            sentence="Each commanded speed holds until the next row: the model's error is then "
            f"{np.sqrt(held / straight):.2f} times that with commands that run straight from row to row.",
        ),
    )
