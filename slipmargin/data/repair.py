"""A repair: a fault of measured data that was mended, with its size and a sentence that says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

from slipmargin.data.data_set import DataSet
from slipmargin.data.record import Record


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Repair:
    """One fault of the data and what was done about it.

    Parameters
    ----------
    kind : str
        One word a kind of fault, e.g. ``wrapped_heading``.
    runs : tuple of str
        The runs it was found in.
    size : float
        How large it is, in ``unit``.
    unit : str
        ``"1"`` for a count or a ratio.
    sentence : str
        What was found and what was done, for the report.
    """

    kind: str
    runs: tuple[str, ...]
    size: float
    unit: str
    sentence: str


#: A stage of the repairs: the data set after it, and what it did.
Stage = Callable[[DataSet], tuple[DataSet, tuple[Repair, ...]]]


def in_runs(runs: tuple[str, ...], of: int) -> str:
    """``in every run``, ``in trial03 and trial07`` or ``in 5 of 10 runs``."""
    if len(runs) == of:
        return "in every run" if of > 1 else f"in {runs[0]}"
    if len(runs) <= 3:
        return "in " + " and ".join(runs)
    return f"in {len(runs)} of {of} runs"


def run_by_run(
    data_set: DataSet,
    mend: Callable[[Record], tuple[Record, float]],
    kind: str,
    unit: str,
    words: Callable[[float, str], str],
    total: Callable[[list[float]], float] = sum,
) -> tuple[DataSet, tuple[Repair, ...]]:
    """Every run mended for itself, with one repair for all of them.

    Parameters
    ----------
    mend : callable
        Returns the run and the size of its fault, 0 where there is none.
    words : callable (size, runs in words)
        The sentence.
    total : callable
        The size for all runs from those of the runs that have the fault.
    """
    mended = [mend(trial) for trial in data_set.trials]
    sizes = [size for _, size in mended if size]
    if not sizes:
        return data_set, ()
    runs = tuple(trial.name for trial, size in mended if size)
    size = float(total(sizes))
    repair = Repair(
        kind=kind,
        runs=runs,
        size=size,
        unit=unit,
        sentence=words(size, in_runs(runs, len(mended))),
    )
    return replace(data_set, trials=tuple(trial for trial, _ in mended)), (repair,)
