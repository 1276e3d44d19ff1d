"""A data set as a problem to fit: its runs cleaned, its models, its noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.noise import white_noise
from slipmargin.data.record import Record
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.model import nominal_model


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
