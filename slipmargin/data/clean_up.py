"""Measured data as people have them, made ready: every fault that can be mended is, and each is reported.

Each stage decides by one test with a stated unit, takes a data set and returns it mended.  The order
matters: times and angles first, then single frames.  What only wheels and camera together show is left to
the diagnosis, which has a model that slips (:mod:`~slipmargin.data.run_arrangement`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.data.camera_frames import without_excursions, without_repeats, without_zeros
from slipmargin.data.clocks import from_zero, regular
from slipmargin.data.data_set import DataSet
from slipmargin.data.repair import Repair, Stage, in_runs
from slipmargin.data.settings import SETTINGS
from slipmargin.data.wheel_signals import fine_angles, known_throughout, speeds_agree, unwrapped
from slipmargin.work import ROWS, allow


def seen_twice(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """Without runs of which fewer than two poses were measured: these show no more than where they began.

    Where all are such runs they stay, for :func:`~slipmargin.data.checks.check_data_set` to name.
    """
    short = tuple(t.name for t in data_set.trials if t.poses < 2)
    if not 0 < len(short) < len(data_set.trials):
        return data_set, ()
    where = in_runs(short, len(data_set.trials))
    return replace(data_set, trials=tuple(t for t in data_set.trials if t.name not in short)), (
        Repair(
            kind="single_poses",
            runs=short,
            size=float(len(short)),
            unit="1",
            sentence=f"Only one pose was measured {where}, which shows no motion: left out.",
        ),
    )


STAGES: tuple[Stage, ...] = (
    from_zero,
    without_zeros,
    unwrapped,
    regular,
    known_throughout,
    speeds_agree,
    fine_angles,
    without_repeats,
    without_excursions,
    seen_twice,
)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Repaired:
    """A data set after the repairs, and what they were."""

    data_set: DataSet
    repairs: tuple[Repair, ...]


def _refuse_ages(data_set: DataSet) -> None:
    """Refuse a run that on an even clock would be far longer than its log: one time stamp is wrong.

    Raises
    ------
    InputError
        Placed at the run's time.
    """
    for trial in data_set.trials:
        step = np.diff(trial.t_s)
        even = float(trial.duration_s / np.median(step)) if len(step) else 0.0
        if even > SETTINGS.sparse * len(trial.t_s):
            gap = int(np.argmax(step))
            cure = (
                f"correct or cut out the time at {trial.t_s[gap]:.2f} s, where it jumps by {step[gap]:.3g} s"
            )
            allow(f"{trial.name}: t_s", even, ROWS, "rows on an even clock", cure)


def repaired(data_set: DataSet) -> Repaired:
    """The data set with every fault mended that the data tell of themselves.

    Faults of all runs that the data cannot tell how to mend (units, mirrored frames, columns of wrong
    wheels) are left for :func:`~slipmargin.data.checks.check_data_set`.
    """
    _refuse_ages(data_set)
    done: list[Repair] = []
    for stage in STAGES:
        data_set, repairs = stage(data_set)
        done += repairs
    return Repaired(data_set=data_set, repairs=tuple(done))
