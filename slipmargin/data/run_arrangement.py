"""Runs whose wheel columns are arranged otherwise than in the other runs: a sign, a swapped pair.

A fault of all runs is one of the data set and is refused (:mod:`~slipmargin.data.checks`).  A fault of some
runs is mended by what the others show to be right.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from slipmargin.data.checks import CLEARLY
from slipmargin.data.data_set import DataSet
from slipmargin.data.odometry_match import Arrangement, all_pieces, arrangements, joined, mismatch
from slipmargin.data.record import WHEEL_SIGNALS, Record
from slipmargin.data.repair import Repair, in_runs

#: A run is mended where its columns as they stand miss more than this share of the motion …
_MISSES = 0.45
#: … and the other arrangement less than this, and less than this share of the former.
_MATCHES, _CLEARLY = 0.2, 0.35
#: A run says something of its columns if it has so many pieces.
_LEAST_PIECES = 6


def alike(data_set: DataSet) -> tuple[DataSet, tuple[Repair, ...]]:
    """The data set with the wheel columns of every run as in most runs."""
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
        if part is None or part.count < _LEAST_PIECES:
            continue
        stated = mismatch(part, None, geometry)
        if not stated > _MISSES:
            continue
        best = min(possible, key=lambda a: np.nan_to_num(mismatch(part, a, geometry), nan=np.inf))
        if mismatch(part, best, geometry) < min(_MATCHES, _CLEARLY * stated):
            taken.setdefault(best.words, (best, []))[1].append(trials[i].name)
            trials[i] = _arranged(trials[i], best)
    wrong = {name for _, names in taken.values() for name in names}
    right = [p for t, p in zip(data_set.trials, pieces, strict=True) if p is not None and t.name not in wrong]
    if not taken or 2 * len(wrong) >= len(known):  # no majority says what is right
        return data_set, ()
    whole = joined(right)
    stated = mismatch(whole, None, geometry)
    if not all(stated < CLEARLY * mismatch(whole, a, geometry) for a, _ in taken.values()):
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


def _arranged(record: Record, arrangement: Arrangement) -> Record:
    signals: dict[str, Any] = {}
    for field in WHEEL_SIGNALS:
        value = getattr(record, field)
        if value is not None and field in ("omega", "theta"):
            signals[field] = arrangement.wheels(value)
    return replace(record, **signals)
