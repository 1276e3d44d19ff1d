"""The residual a small step from some effects: to first order, from one simulation for many steps.

A fit asks how the residual changes with each parameter, and a screening asks it of hundreds of them.  Where
a step changes forces only, the answer follows from the run as it is (:mod:`slipmargin.sim.sensitivity`);
what moves the wheels' edges in time, or ridges of the floor, is simulated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.effects import AnyEffect
from slipmargin.model import Model
from slipmargin.sim.batch import Batch, Ending, Outcome
from slipmargin.sim.pack import pack, stack

#: A way from some effects: the effects that part of a step on.
Way = Callable[[float], tuple[AnyEffect, ...]]


class Simulated(Protocol):
    """What is asked of a problem: its runs, and how they are simulated and compared."""

    @property
    def batch(self) -> Batch:
        """The compiled runs."""
        ...

    @property
    def measured(self) -> Array:
        """Measured poses (R, T, 3)."""
        ...

    @property
    def member_of(self) -> Index:
        """The data set of each trial (R,)."""
        ...

    def possible(self, effects: Sequence[AnyEffect], member: int = 0) -> Model | None:
        """The model with effects, or None where no machine is like that."""
        ...

    def simulated(self, clock: float, rows: Array, runs: Index, **more: Any) -> Outcome:
        """Packed models in runs."""
        ...

    def sense(self, model: Model, rows: Index, runs: Index, pose: Array) -> None:
        """In place: what a sensor reports."""
        ...

    def residuals(self, effects: Sequence[tuple[AnyEffect, ...]], trials: Sequence[Index]) -> list[Array]:
        """The residual of each set of effects."""
        ...

    def residual_of(self, pose: Array, runs: Index) -> Array:
        """The residual of predicted poses."""
        ...


#: From so many steps on it saves time to follow them beside one simulation.
_SEVERAL = 3
#: The part of a step [1] that is followed, and then stretched: friction that sticks answers a whole one less.
_PART = 1e-3
#: A step that is told to move a run farther than this is no small one [m, rad]: where runs are unstable first
#: orders grow without bound.
_FARTHEST = 1e3


def near(
    problem: Simulated, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index
) -> list[Array]:
    """Residual (R, K) a step on each of several ways from ``effects``."""
    poses = _followed(problem, effects, ways, trials)
    rest = [k for k in range(len(ways)) if k not in poses]
    far = problem.residuals([ways[k](1.0) for k in rest], [trials] * len(rest)) if rest else []
    out = dict(zip(rest, far, strict=True))
    out |= {k: problem.residual_of(pose, trials) for k, pose in poses.items()}
    return [out[k] for k in range(len(ways))]


def _followed(
    problem: Simulated, effects: tuple[AnyEffect, ...], ways: Sequence[Way], trials: Index
) -> dict[int, Array]:
    """Measured pose (R, T, 3) a step on, by number of the way, where it can be told to first order.

    There are none where that saves nothing, or a wheel lifts, and not that of a step which is not small.
    Sensors are those a whole step on.
    """
    members, which = np.unique(problem.member_of[trials], return_inverse=True)

    def models(made: tuple[AnyEffect, ...]) -> list[Model | None]:
        return [problem.possible(made, int(m)) for m in members]

    ours = [m for m in models(effects) if m is not None]
    rows = [pack(m) for m in ours]
    parts: dict[int, list[Array]] = {}
    wholes: dict[int, list[Model]] = {}
    for k, way in enumerate(ways if len(ours) == len(members) else ()):
        part, whole = ([m for m in models(way(share)) if m is not None] for share in (_PART, 1.0))
        if len(part) < len(ours) or len(whole) < len(ours):
            continue
        one_clock = all(a.measurement.clock == b.measurement.clock for a, b in zip(ours, whole, strict=True))
        moved = [pack(m) for m in part]
        if one_clock and all(problem.batch.beside(a, b) for a, b in zip(rows, moved, strict=True)):
            parts[k], wholes[k] = moved, whole
    if len(parts) < _SEVERAL:
        return {}
    pose = np.empty((len(parts), len(trials), problem.measured.shape[1], 3))
    small = np.ones(len(parts), dtype=bool)
    for number, model in enumerate(ours):
        own = np.flatnonzero(which == number)
        table = stack([rows[number], *(moved[number] for moved in parts.values())])
        clock = model.measurement.clock
        found = problem.simulated(clock, table[:1], trials[own], others=table[1:])
        assert found.change is not None
        if np.any(found.ending != Ending.DONE) or np.isfinite(found.lifts_s).any():
            return {}
        change = found.change.swapaxes(0, 1)
        small &= np.max(np.abs(change), axis=(1, 2, 3)) <= _FARTHEST * _PART  # what is no number is not
        pose[:, own] = found.pose + np.where(small[:, None, None, None], change, 0.0) / _PART
    for told, whole in zip(pose, wholes.values(), strict=True):
        for number, model in enumerate(whole):
            problem.sense(model, np.flatnonzero(which == number), trials, told)
    return {k: told for k, told, right in zip(parts, pose, small, strict=True) if right}
