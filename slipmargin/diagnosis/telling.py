"""Which trials a search looks at: few, spread over all, most of them such as what is missing touches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Index
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS


def enough(seen: Index, knots: float, tells: NDArray[np.bool_] | None = None) -> Index:
    """Trials to search with, spread over ``seen``: the fewer the more samples of the wheels each has.

    Those that what is missing does not touch say little: where ``tells`` marks others, a fold of them is
    enough.
    """
    many = int(np.clip(SETTINGS.most_samples / knots, SETTINGS.folds, SETTINGS.most_searched))
    some = _spread(seen, many)
    if tells is None or len(some) == len(seen):
        return some
    loud, still = seen[tells], seen[~tells]
    most = min(len(loud), max(many - many // SETTINGS.folds, many - len(still)))
    if np.count_nonzero(np.isin(some, loud)) >= most:
        return some
    return np.sort(np.concatenate([_spread(loud, most), _spread(still, many - most)]))


def _spread(some: Index, many: int) -> Index:
    return np.asarray(some[np.unique(np.linspace(0, len(some) - 1, many).round().astype(int))])


def telling(problem: Problem, trials: Index) -> NDArray[np.bool_]:
    """Which trials the model as it is misses by more than noise."""
    return np.asarray(problem.misses((), trials) > SETTINGS.noise_chi)
