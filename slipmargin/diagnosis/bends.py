"""Whether predicted runs are so far off that whole ones do not change in proportion to parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Index
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect


def bends(problem: Problem, trials: Index, effects: Sequence[AnyEffect]) -> bool:
    """Whether these trials, predicted with these effects, are off by much of their way or of their heading.

    A wrong heading early in a run turns everything after it, so that errors of far predictions are no sums
    of what single parameters do.
    """
    seen = problem.seen[trials]
    off = np.where(seen, problem.measured[trials] - problem.predict([tuple(effects)], [trials])[0], 0.0)
    off = np.where(np.isfinite(off), off, np.inf)
    place, turn = (
        np.sqrt(np.sum(off[..., axes] ** 2) / max(1, np.count_nonzero(seen[..., axes]) / len(axes)))
        for axes in ([0, 1], [2])
    )
    way = np.where(seen[..., :2], problem.measured[trials][..., :2], np.nan)
    reach = np.median(np.nanmax(way, axis=1) - np.nanmin(way, axis=1), axis=0).max()
    return bool(place > SETTINGS.far_share * reach or turn > SETTINGS.far_rad)
