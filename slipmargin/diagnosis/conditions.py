"""What the base model shows of the data before any effect is searched: clocks, noise, runs of another floor.

Faults that the data tell of themselves are mended first (:mod:`slipmargin.data.clean_up`).  The base model
then predicts every run once.  Whether camera and wheels keep the same time, how large the noise is and how
long it lasts, and whether some runs took place on another floor is read from what it misses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.campaign import each
from slipmargin.data.clean_up import repaired
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.noise import lasting_noise, white_noise
from slipmargin.data.odometry_match import Arrangement
from slipmargin.data.record import Record
from slipmargin.data.repair import Repair, in_runs
from slipmargin.data.run_arrangement import alike, arranged
from slipmargin.diagnosis.camera_clock import one_clock
from slipmargin.diagnosis.held_out import held_out_runs, searched_runs
from slipmargin.diagnosis.noise_reading import lasts, stated_wrong, tails
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import GeneralEffect, Part, Trace
from slipmargin.model import nominal_model
from slipmargin.physics.terms import Multiplier
from slipmargin.physics.variables import Basis, Variable

#: Frictions that are tried for each run, as factors of the stated one.
_FRICTIONS = np.geomspace(0.45, 1.8, 8)


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
    data_set, more = _measured_noise(data_set, searched_runs(len(data_set.trials), held))
    assert data_set.sigma is not None
    estimated = stated is None or not np.array_equal(data_set.sigma, stated)
    return Ready(
        data_set=data_set,
        noise_estimated=estimated,
        repairs=(*done, *more),
        held=held,
    )


def held_runs_of(data_set: DataSet, seed: int) -> Index:
    """Numbers of the runs of a data set to hold out, drawn by what the model as it is misses each by."""
    problem = problem_of(data_set)
    return held_out_runs(problem.misses((), np.arange(len(problem.trials), dtype=np.int64)), seed)


def _alike(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """With the wheel columns, the commands, the clock and the floor that most of the runs have."""
    data_set, columns = alike(data_set, lambda stated, other: _misses_less(data_set, (other,), (stated,)))
    data_set, done = _commands(data_set)
    data_set, clock = one_clock(data_set, problem_of(data_set))
    if clock:  # how the wheels move from row to row shows once the camera keeps their time
        data_set, held = _commands(data_set)
        clock = (*clock, *held)
    data_set, floor = _one_floor(data_set)
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


def problem_of(
    data_set: DataSet, records: tuple[Record, ...] | None = None, runs: Sequence[int] | None = None
) -> Problem:
    """The trials of a data set, or others, cleaned, with its noise, or else that of these trials.

    ``runs`` is the number of the trial that each of other records is cut from.
    """
    records = data_set.trials if records is None else records
    sigma = white_noise(records) if data_set.sigma is None else data_set.sigma
    trials = tuple(clean(record, sigma) for record in records)
    commanded = data_set.wheel_signal is WheelSignal.COMMANDED
    own = np.asarray(data_set.member_of, dtype=np.int64)
    built = Problem.of(
        data_set.recipe,
        data_set.surface,
        trials,
        sigma,
        commanded,
        [(m.recipe, nominal_model(m.recipe.robot, m.surface)) for m in data_set.members],
        own if runs is None or not len(own) else own[np.asarray(runs, dtype=np.int64)],
    )
    return replace(built, lasting=data_set.lasting)


def _commands(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """With commands held from row to row where the base model predicts that better than straight lines."""
    if data_set.wheel_signal is not WheelSignal.COMMANDED or data_set.trials[0].commands_held:
        return data_set, ()
    holding = replace(data_set, trials=tuple(replace(t, commands_held=True) for t in data_set.trials))
    everyone = np.arange(len(data_set.trials), dtype=np.int64)
    straight, held = (
        float(np.mean(problem_of(d).residuals([()], [everyone])[0] ** 2)) for d in (data_set, holding)
    )
    if held > SETTINGS.held_leaves * straight:
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


def _one_floor(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Without the few runs that fit another friction than the others."""
    problem = problem_of(data_set)
    many = len(problem.trials)
    everyone = np.arange(many, dtype=np.int64)
    if many < 4 or np.sqrt(_cost(problem, (1.0,), everyone).max()) < SETTINGS.differs_chi:
        return data_set, ()
    costs = _cost(problem, tuple(_FRICTIONS), everyone)
    best = _two(costs)
    if best is None or best[2] > 2.5 * SETTINGS.two_floors_leave:
        return data_set, ()
    near = np.geomspace(0.91, 1.1, 7)
    finer = np.unique(np.concatenate([_FRICTIONS[best[0]] * near, _FRICTIONS[best[1]] * near]))
    costs = _cost(problem, tuple(finer), everyone)
    best = _two(costs)
    if best is None or best[2] > SETTINGS.two_floors_leave:
        return data_set, ()
    usual, other = float(finer[best[0]]), float(finer[best[1]])
    apart = costs[best[1]] * SETTINGS.floor_gains < costs[best[0]]
    factor = other / usual
    if not 0 < apart.sum() <= SETTINGS.other_floor_share * many or not (
        factor > SETTINGS.floors_differ or factor < 1.0 / SETTINGS.floors_differ
    ):
        return data_set, ()
    names = tuple(data_set.trials[i].name for i in np.flatnonzero(apart))
    kept = tuple(t for t, out in zip(data_set.trials, apart, strict=True) if not out)
    return replace(data_set, trials=kept), (
        Repair(
            kind="other_floor",
            runs=names,
            size=factor,
            unit="1",
            sentence=f"The wheels grip {factor:.2f} times as well {in_runs(names, many)} as in the "
            "others, as on another floor: these were left out. Diagnose them as a data set of their own.",
        ),
    )


def _cost(problem: Problem, frictions: tuple[float, ...], runs: Index) -> Array:
    """Mean squared residual (F, R) of each run with friction times each of these."""
    ones = np.ones(problem.nominal.count)

    def floor(factor: float) -> GeneralEffect:
        term = Multiplier(
            variable=Variable.UNITY,
            basis=Basis.CONSTANT,
            coefficients=np.array([factor - 1.0]),
            shape=np.zeros(2),
            wheels=ones,
        )
        return GeneralEffect(traced_to=Trace.COEFFICIENT, part=Part.GRIP, terms=(term,))

    found = problem.residuals([(floor(f),) for f in frictions], [runs] * len(frictions))
    return np.array([np.mean(r**2, axis=1) for r in found])


def _two(costs: Array) -> tuple[int, int, float] | None:
    """The frictions of most runs and of the others, and what two leave of what one leaves."""
    one = float(costs.sum(axis=1).min())
    most = costs.shape[1] * (1.0 - SETTINGS.other_floor_share)
    best: tuple[int, int, float] | None = None
    for usual in range(len(costs)):
        for other in range(len(costs)):
            left = float(np.minimum(costs[usual], costs[other]).sum()) / one
            mine = np.count_nonzero(costs[usual] <= costs[other])
            if other != usual and mine >= most and (best is None or left < best[2]):
                best = usual, other, left
    return best


def _measured_noise(data_set: DataSet, runs: Index) -> tuple[DataSet, tuple[Repair, ...]]:
    """With the noise of these runs: its size where none or a wrong one is stated, and the part that lasts."""
    white = white_noise(tuple(data_set.trials[i] for i in runs))
    problem = problem_of(data_set if data_set.sigma is not None else replace(data_set, sigma=white))
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    predicted = problem.predict([()], [everyone])[0]
    residuals = [(t.t_s, t.pose - p[: len(t.t_s)]) for t, p in zip(problem.trials, predicted, strict=True)]
    data_set, said = _without_lone(data_set, residuals, white)
    residuals = [residuals[i] for i in runs]
    whole, lasting = lasting_noise(residuals, data_set.sigma)
    white = white_noise(tuple(data_set.trials[i] for i in runs))
    # Between the frames of a slow camera the robot turns and stops, which looks like noise; not so what the
    # model leaves of it.
    left = tuple(replace(data_set.trials[i], pose=r) for i, (_, r) in zip(runs, residuals, strict=True))
    less = white_noise(left)
    white = np.where(less < SETTINGS.motion_seen_as_noise * white, less, white)
    lasts_in = np.zeros(3, dtype=bool) if lasting is None else lasting.share > 0.0
    sigma = np.where(lasts_in & (whole > 0.0), whole, white)
    sigma = sigma * np.where(lasts_in, 1.0, tails(residuals, sigma))
    every = tuple(t.name for t in data_set.trials)
    if data_set.sigma is not None:
        # Noise is called smaller than stated only where nothing else is in the residual.
        understood = np.sqrt(
            [np.nanmean(np.concatenate([r[:, i] for _, r in residuals]) ** 2) for i in range(3)]
        )
        sigma = np.where(
            (sigma < data_set.sigma) & (understood > SETTINGS.understood * data_set.sigma),
            data_set.sigma,
            sigma,
        )
        ratio = sigma / data_set.sigma
        limit = np.where(lasts_in, SETTINGS.stated_wrong_lasting, SETTINGS.stated_wrong)
        wrong = (ratio > limit) | (ratio < 1.0 / limit)
        if wrong.any():
            worst = int(np.argmax(np.abs(np.log(ratio))))
            said.append(stated_wrong(data_set.sigma, sigma, worst, every))
        sigma = np.where(wrong, sigma, data_set.sigma) if wrong.any() else data_set.sigma
    if lasting is not None:
        said.append(lasts(lasting, every))
    return replace(data_set, sigma=sigma, lasting=lasting), tuple(said)


def _without_lone(
    data_set: DataSet, residuals: list[tuple[Array, Array]], sigma: Array
) -> tuple[DataSet, list[Repair]]:
    """Without samples far from the residuals around them; these are also taken out of ``residuals``."""
    trials, names, count = [], [], 0
    for trial, (_, residual) in zip(data_set.trials, residuals, strict=True):
        lone = np.zeros(residual.shape, dtype=bool)
        for axis in range(3):
            known = np.flatnonzero(np.isfinite(residual[:, axis]))
            if len(known) <= 2 * SETTINGS.lone_around:
                continue
            values = np.pad(residual[known, axis], SETTINGS.lone_around, mode="edge")
            windows = np.lib.stride_tricks.sliding_window_view(values, 2 * SETTINGS.lone_around + 1)
            middle = np.median(windows, axis=1)
            # Where the residual runs away, its own change from sample to sample is no outlier.
            runs = np.median(np.abs(np.diff(windows, axis=1)), axis=1)
            off = np.abs(residual[known, axis] - middle)
            lone[
                known[
                    off
                    > SETTINGS.lone_deviations * sigma[axis]
                    + SETTINGS.lone_around * np.maximum(0.0, runs - 2.0 * sigma[axis])
                ],
                axis,
            ] = True
        pose = np.where(lone, np.nan, trial.pose)
        if lone.any() and np.isfinite(pose).all(axis=1).any():
            count += int(lone.any(axis=1).sum())
            names.append(trial.name)
            residual[lone] = np.nan
            trial = replace(trial, pose=pose)
        trials.append(trial)
    if not count:
        return data_set, []
    return replace(data_set, trials=tuple(trials)), [
        Repair(
            kind="lone_outliers",
            runs=tuple(names),
            size=float(count),
            unit="1",
            sentence=f"{count} {'pose is' if count == 1 else 'poses are'} more than "
            f"{SETTINGS.lone_deviations:g} times the noise from those around them, "
            f"{in_runs(tuple(names), len(trials))}: what was off in them was taken as missing.",
        )
    ]
