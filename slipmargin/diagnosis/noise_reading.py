"""What the base model's residual says of the noise: its size and tails, how long it lasts, outliers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import DataSet
from slipmargin.data.noise import LastingNoise, lasting_noise, white_noise
from slipmargin.data.repair import Repair, in_runs
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.settings import SETTINGS

_Residual = tuple[Array, Array]


def tails(residuals: list[_Residual], sigma: Array) -> Array:
    """What the noise's root mean square is over its size by the middle half (3,): 1 but for heavy tails."""
    out = np.ones(3)
    for axis in range(3):
        jumps = []
        for _, residual in residuals:
            known = residual[np.isfinite(residual[:, axis]), axis]
            jumps.append((known[2:] - 2.0 * known[1:-1] + known[:-2]) / np.sqrt(6.0) / sigma[axis])
        values = np.concatenate(jumps)
        values = values[np.abs(values) < SETTINGS.outlier_sigma]
        if len(values) > 100:
            # The middle half of the same values: what is not noise in them is in both.
            middle = 1.4826 * float(np.median(np.abs(values)))
            ratio = float(np.sqrt(np.mean(values**2))) / max(middle, 1e-12)
            out[axis] = ratio if ratio > SETTINGS.heavy_tails and 0.7 < middle < 1.4 else 1.0
    return out


_CHANNELS = (("x", 1e3, "mm"), ("y", 1e3, "mm"), ("heading", 1e3, "mrad"))


def stated_wrong(stated: Array, found: Array, worst: int, every: tuple[str, ...]) -> Repair:
    """That the stated noise is not the one the data have, most so in channel ``worst``."""
    name, factor, unit = _CHANNELS[worst]
    return Repair(
        kind="stated_noise",
        runs=every,
        size=float(found[worst] / stated[worst]),
        unit="1",
        sentence=f"The noise is stated as {factor * stated[worst]:.2g} {unit} in {name}, the data have "
        f"{factor * found[worst]:.2g} {unit}: that was used.",
    )


def lasts(lasting: LastingNoise, every: tuple[str, ...]) -> Repair:
    """That part of the noise lasts, and how long."""
    worst = int(np.argmax(lasting.share))
    return Repair(
        kind="lasting_noise",
        runs=every,
        size=float(lasting.time_s[worst]),
        unit="s",
        sentence=f"The noise is not white: {100.0 * lasting.share[worst]:.0f} % of its variance in "
        f"{_CHANNELS[worst][0]} lasts "
        f"{lasting.time_s[worst]:.2g} s. Residuals were whitened by that.",
    )


def without_outliers(data_set: DataSet, runs: Index) -> tuple[DataSet, list[_Residual], list[Repair]]:
    """Without poses far from what the model as it is misses around them, by the noise of these runs.

    Also each run's times (T,) and what the model as it is misses it by (T, 3), NaN where nothing is known.
    """
    white = white_noise(tuple(data_set.trials[i] for i in runs))
    problem = problem_of(data_set if data_set.sigma is not None else replace(data_set, sigma=white))
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    predicted = problem.predict([()], [everyone])[0]
    residuals = [(t.t_s, t.pose - p[: len(t.t_s)]) for t, p in zip(problem.trials, predicted, strict=True)]
    data_set, said = _without_lone(data_set, residuals, white)
    return data_set, residuals, said


def measured_noise(data_set: DataSet, runs: Index) -> tuple[DataSet, tuple[Repair, ...]]:
    """With the noise of these runs: its size where none or a wrong one is stated, and the part that lasts."""
    data_set, residuals, said = without_outliers(data_set, runs)
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
    data_set: DataSet, residuals: list[_Residual], sigma: Array
) -> tuple[DataSet, list[Repair]]:
    """Without poses far from the residuals around them; these are also taken out of ``residuals``.

    What is far off in one number is taken as missing altogether: a camera that errs in one has erred.
    """
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
        far = np.asarray(lone.any(axis=1))
        pose = np.where(far[:, None], np.nan, trial.pose)
        if far.any() and np.isfinite(pose).all(axis=1).any():
            count += int(far.sum())
            names.append(trial.name)
            residual[far] = np.nan
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
            f"{in_runs(tuple(names), len(trials))}: they were taken as missing.",
        )
    ]
