"""Runs whose wheel columns are arranged otherwise than in the other runs: a sign, a swapped pair.

A fault of all runs is one of the data set and is refused (:mod:`~slipmargin.data.checks`).  A fault of some
runs is mended by what the others show to be right.

Wheels that spin on the spot move the robot as other columns would: of a run that seems to be arranged
otherwise, a model that slips must say so too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from slipmargin.data.data_set import DataSet
from slipmargin.data.odometry_match import VIEWS, Arrangement, all_pieces, arrangements, joined, mismatch
from slipmargin.data.record import WHEEL_SIGNALS, Record
from slipmargin.data.repair import Repair, in_runs
from slipmargin.data.settings import SETTINGS


def alike(data_set: DataSet, better: Callable[[Record, Record], bool]) -> tuple[DataSet, tuple[Repair, ...]]:
    """The data set with the wheel columns of every run as in most runs.

    ``better`` (run as it stands, run rearranged) says whether a model that slips misses the second by less.
    """
    if len(data_set.trials) < 3:
        return data_set, ()
    pieces = all_pieces(data_set)
    geometry = data_set.recipe.build(data_set.surface).geometry
    known = [p for p in pieces if p is not None]
    if len(known) < 3:
        return data_set, ()
    possible = [a for a in arrangements(geometry.names) if a.view == 0 and a.parts == 1]
    taken: dict[str, tuple[Arrangement, list[str]]] = {}
    trials = list(data_set.trials)
    for i, part in enumerate(pieces):
        if part is None or part.count < SETTINGS.least_pieces:
            continue
        stated = mismatch(part, None, geometry)
        if not stated > SETTINGS.run_misses:
            continue
        best = min(possible, key=lambda a: np.nan_to_num(mismatch(part, a, geometry), nan=np.inf))
        if mismatch(part, best, geometry) < min(SETTINGS.run_matches, SETTINGS.run_clearly_better * stated):
            other = arranged(trials[i], best)
            if better(trials[i], other):
                taken.setdefault(best.words, (best, []))[1].append(trials[i].name)
                trials[i] = other
    wrong = {name for _, names in taken.values() for name in names}
    right = [p for t, p in zip(data_set.trials, pieces, strict=True) if p is not None and t.name not in wrong]
    if not taken or 2 * len(wrong) >= len(known):  # no majority says what is right
        return data_set, ()
    whole = joined(right)
    stated = mismatch(whole, None, geometry)
    if not all(stated < SETTINGS.clearly_better * mismatch(whole, a, geometry) for a, _ in taken.values()):
        return data_set, ()
    repairs = tuple(
        Repair(
            kind="wheel_columns",
            runs=tuple(names),
            size=float(len(names)),
            unit="1",
            sentence=f"{words[0].upper()}{words[1:]}, but only {in_runs(tuple(names), len(trials))}: "
            f"turned as in the other "
            "runs.",
        )
        for words, (_, names) in taken.items()
    )
    return replace(data_set, trials=tuple(trials)), repairs


def arranged(record: Record, arrangement: Arrangement) -> Record:
    """A run with its encoders and its pose read as an arrangement says."""
    factors, quarters, _ = VIEWS[arrangement.view]
    pose = record.pose * np.array(factors) + np.array([0.0, 0.0, quarters * np.pi / 2.0])
    signals: dict[str, Any] = {}
    for field in WHEEL_SIGNALS:
        value = getattr(record, field)
        if value is not None and field in ("omega", "theta"):
            signals[field] = arrangement.wheels(value)
    return replace(record, pose=pose, **signals)
