"""Which pulls to make next: where explanations that are left differ most, or the interval shrinks most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import Fit, build, limits_of, steps_inside
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.pull_settings import setting_limits
from slipmargin.physics.frames import wrapped

#: Orientations and directions of the pull that are compared [rad].
_ORIENTATIONS = np.deg2rad(np.arange(0.0, 360.0, 5.0))
_DIRECTIONS = np.deg2rad([0.0, 90.0, 180.0, 270.0])
#: Proposals, and how far apart they are in orientation [rad].
_MANY, _APART_RAD = 3, np.deg2rad(20.0)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class NextPull:
    """A pull worth making: orientation and direction of the pull in the floor frame [rad], and its worth.

    ``separates``: the two explanations whose forces differ most there, by ``apart_N``; empty where the pull
    is to narrow ``narrows``, a parameter, whose standard deviation it multiplies by ``factor``.
    """

    phi_rad: float
    direction_rad: float
    separates: tuple[str, ...] = ()
    apart_N: float = 0.0
    narrows: str = ""
    factor: float = 1.0


def next_pulls(problem: PullProblem, standing: Fit, others: Sequence[Fit]) -> tuple[NextPull, ...]:
    """The pulls that separate ``standing`` from ``others`` best, or narrow its widest interval."""
    grid = np.array(
        [[phi, direction, np.nan, np.nan, 0.0] for direction in _DIRECTIONS for phi in _ORIENTATIONS]
    )
    fits = [standing, *others]
    try:
        forces = np.stack([setting_limits(problem.model(f.effects), grid) for f in fits])
    except (InputError, NoSolution):
        return ()
    if len(fits) > 1:
        apart = np.abs(forces[:, None] - forces[None, :]).reshape(len(fits) ** 2, -1)
        # A pull that separates one pair well is worth more than one that separates all a little.
        if float(apart.max()) > problem.sigma_N:
            pair, worth = np.argmax(apart, axis=0), apart.max(axis=0)
            return tuple(
                NextPull(
                    phi_rad=float(grid[g, 0]),
                    direction_rad=float(grid[g, 1]),
                    separates=(fits[pair[g] // len(fits)].said, fits[pair[g] % len(fits)].said),
                    apart_N=float(worth[g]),
                )
                for g in _spread(grid, worth)
            )
    return _narrowing(problem, standing, grid, forces[0]) if len(standing.x) else ()


def _spread(grid: Array, worth: Array) -> list[int]:
    """The best few, their orientations apart."""
    chosen: list[int] = []
    for g in np.argsort(-worth, kind="stable"):
        turned = [np.abs(wrapped(grid[g, 0] - grid[k, 0])) for k in chosen]
        if all(t >= _APART_RAD for t in turned):
            chosen.append(int(g))
        if len(chosen) == _MANY:
            break
    return chosen


def _narrowing(problem: PullProblem, found: Fit, grid: Array, here: Array) -> tuple[NextPull, ...]:
    """Pulls that take most off the parameter with the widest interval, in scales."""
    _, _, scale = limits_of(found.structure)
    steps = steps_inside(found.structure, found.x, 0.05)
    slope = np.empty((len(grid), len(found.x)))
    for i, step in enumerate(np.diag(steps)):
        moved = setting_limits(problem.model(build(found.structure, found.x + step)), grid)
        slope[:, i] = (moved - here) / steps[i] * scale[i] / problem.sigma_N
    flat = found.jacobian.reshape(-1, len(found.x)) * scale
    covariance = np.linalg.pinv(flat.T @ flat)
    widest = int(np.argmax(np.diag(covariance)))
    # One more pull with slope j: C − C j jᵀ C / (1 + jᵀ C j) (Sherman–Morrison).
    shift = slope @ covariance
    less = shift[:, widest] ** 2 / (1.0 + np.sum(shift * slope, axis=1))
    factor = np.sqrt(np.maximum(1.0 - less / max(covariance[widest, widest], 1e-300), 0.0))
    keys = [f"{c.name}.{key}" for c in found.structure for key in c.keys]
    return tuple(
        NextPull(
            phi_rad=float(grid[g, 0]),
            direction_rad=float(grid[g, 1]),
            narrows=keys[widest],
            factor=float(factor[g]),
        )
        for g in _spread(grid, -factor)
        if factor[g] < 1.0 - 1e-3
    )
