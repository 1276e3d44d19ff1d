"""Old runs and proposed ones together: how well a rival can still explain them once it is fitted again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnosis.fit import Fit, Residuals, fit
from slipmargin.diagnosis.near import Way
from slipmargin.diagnosis.problem import Problem
from slipmargin.effects import AnyEffect

#: Gauss–Newton steps of a rival's refit.
_STEPS = 6


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Joint:
    """The residuals of two problems as those of one: trials of ``old`` first, then those of ``new``."""

    old: Residuals
    new: Residuals
    count: int

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """As :meth:`slipmargin.diagnosis.problem.Problem.residuals`; the shorter rows end in zeros."""
        first = self.old.residuals(effects, [t[t < self.count] for t in trials])
        second = self.new.residuals(effects, [t[t >= self.count] - self.count for t in trials])
        return [_stacked(a, b) for a, b in zip(first, second, strict=True)]

    def near(self, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index) -> list[Array]:
        """As :meth:`slipmargin.diagnosis.problem.Problem.near`; the shorter rows end in zeros."""
        first = self.old.near(effects, ways, trials[trials < self.count])
        second = self.new.near(effects, ways, trials[trials >= self.count] - self.count)
        return [_stacked(a, b) for a, b in zip(first, second, strict=True)]

    def rough(self) -> Joint:
        """The same for differences."""
        return replace(self, old=self.old.rough(), new=self.new.rough())


def _stacked(one: Array, two: Array) -> Array:
    longest = max(one.shape[1], two.shape[1])
    return np.concatenate([np.pad(a, ((0, 0), (0, longest - a.shape[1]))) for a in (one, two)])


def expected_rise(old: Problem, new: Problem, right: Fit, rival: Fit, misfit: float) -> float:
    """By how much the rival's χ² will exceed the right one's on old and new runs together.

    The new runs are those that ``right`` predicts, without noise; the rival is fitted again to all.

    Parameters
    ----------
    old, new : Problem
        The runs that there are, and the proposed ones.
    right, rival : Fit
        On the runs that there are.
    misfit : float
        What the noise is multiplied by.
    """
    everyone = np.arange(len(new.trials), dtype=np.int64)
    pose = new.predict([right.effects], [everyone])[0]
    measured = np.where(new.seen, pose, new.measured)
    joint = Joint(old=old, new=replace(new, measured=measured), count=len(old.trials))
    trials = np.arange(len(old.trials) + len(new.trials), dtype=np.int64)
    again = fit(joint, rival.structure, rival.x, trials, iterations=_STEPS)
    return (again.cost - right.cost) / misfit**2
