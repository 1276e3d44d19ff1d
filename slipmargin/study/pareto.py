"""Designs that no other design beats in everything at once (Pareto, Manuale di economia politica, 1906)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array

#: Values that differ by less than this share of the largest are equal: the rest is rounding [1].
TIE = 1e-9


def front(values: Array) -> NDArray[np.bool_]:
    """Which rows are not dominated.

    Parameters
    ----------
    values : (D, K)
        More is better in every column; rows with a NaN are on no front.

    Returns
    -------
    (D,) bool
        A row is dominated where another is at least as good in all columns and better in one; what differs
        by rounding is equal.
    """
    values = np.stack([_ranks(column) for column in np.asarray(values, dtype=float).T], axis=1)
    whole = np.flatnonzero(~np.any(np.isnan(values), axis=1))
    out = np.zeros(len(values), dtype=bool)
    # From best to worst by the first column, then the next: a row can only be dominated by an earlier one.
    order = whole[np.lexsort(-values[whole][:, ::-1].T)]
    kept: list[Array] = []
    for row in order:
        v = values[row]
        table = np.array(kept) if kept else np.empty((0, values.shape[1]))
        beaten = np.all(table >= v, axis=1) & np.any(table > v, axis=1)
        if not np.any(beaten):
            out[row] = True
            kept.append(v)
    return out


def tolerance(top: float) -> float:
    """By how much values may fall short of the largest and still equal it."""
    return TIE * max(1.0, abs(top))


def _ranks(column: Array) -> Array:
    """Values (D,) as whole numbers in the same order, one number for those that are equal; NaN stays."""
    order = np.argsort(column)
    least = tolerance(float(np.max(np.abs(column[np.isfinite(column)]), initial=0.0)))
    ranks = np.zeros_like(column)
    with np.errstate(invalid="ignore"):  # infinite values equal each other
        ranks[order[1:]] = np.cumsum(np.diff(column[order]) > least)
    return np.where(np.isnan(column), np.nan, ranks)
