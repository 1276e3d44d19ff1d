"""Rotor angles that no log holds: estimated for each trial, like its start pose.

Where only wheel speeds are known, a wheel's angle is known but for a constant.  It matters to what
depends on the wheel angle, and only within one roller's pitch.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.diagnose.candidate import named_candidate
from slipmargin.diagnose.fit import Fit, evaluate, fit
from slipmargin.diagnose.problem import Problem
from slipmargin.effects import AnyEffect
from slipmargin.effects.rigid_sector import RigidSector

#: Start angles tried, in pitches: all round; then, turn by turn, closer and closer to the best one.
_AROUND = np.arange(1, 20) / 20.0
_CLOSE = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
_FINER = (60.0, 60.0, 120.0, 240.0)
#: Runs are compared in pieces this long [s]: a wrong angle early on must not spoil what follows.
_PIECE_S = 0.3


def is_unknown(problem: Problem) -> bool:
    """Whether no trial's log tells where the wheels stood."""
    return all(trial.record.theta is None for trial in problem.trials)


def guessed(problem: Problem) -> Problem:
    """With the start angles that rigid material between the rollers, if there is any, would ask for."""
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    if np.any(problem.nominal.grip.rigid_fraction > 0.0):
        problem = _swept(problem, (), everyone, _AROUND)
        return _swept(problem, (), everyone, _CLOSE / _FINER[0])
    suspect = named_candidate(RigidSector, ("rigid_fraction", "rigid_coefficient"))
    found = evaluate(problem, (suspect,), suspect.starts[0], everyone)
    return refined(_swept(problem, found.effects, everyone, _AROUND), found)[0]


def refined(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Start angles and the parameters of a fit, each found in turn with the other as it stands."""
    for fineness in _FINER:
        problem = _swept(problem, found.effects, found.trials, _CLOSE / fineness)
        found = fit(problem.in_pieces(_PIECE_S), found.structure, found.x, found.trials)
    return problem, found


def _swept(problem: Problem, effects: tuple[AnyEffect, ...], trials: Index, steps: Array) -> Problem:
    """The problem with the start angles that fit each trial best, one wheel after the other, twice."""
    pitch = 2.0 * np.pi / problem.nominal.grip.rollers
    best = problem.rotor.copy()
    view = problem.in_pieces(_PIECE_S)
    cost = _costs(view, best, effects, trials)
    for wheel in (*range(best.shape[1]),) * 2:
        start = best.copy()
        for step in steps:
            tried = start.copy()
            tried[:, wheel] += step * pitch[wheel]
            found = _costs(view, tried, effects, trials)
            better = found < cost
            best[trials[better], wheel] = tried[trials[better], wheel]
            cost = np.where(better, found, cost)
    return problem.with_rotor(best % pitch)


def _costs(problem: Problem, rotor: Array, effects: tuple[AnyEffect, ...], trials: Index) -> Array:
    """Sum of squares of each trial with these start angles."""
    residual = problem.with_rotor(rotor).residuals([effects], [trials])[0]
    return np.asarray(np.sum(residual**2, axis=1))
