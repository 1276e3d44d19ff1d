"""Motions timed by the planner, so that every model that is left keeps its limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import InputError, NoSolution
from slipmargin.experiment.motions import Motion
from slipmargin.model import Model
from slipmargin.paths.along import Caps
from slipmargin.paths.check import check
from slipmargin.paths.path import through
from slipmargin.paths.plan import Plan, Request, plan
from slipmargin.paths.sample import at_times, use_along
from slipmargin.paths.trajectory import Trajectory

#: How much slower than the hardest each motion is driven [1].
PACES = {"as hard as the margin allows": 1.0, "at half the pace": 2.0, "slowly": 4.0}
#: Standing still at the start, between legs and at the end [s].
REST_S = 0.25
#: Grid points of a leg's plan.
_POINTS = 120
#: Motions are planned with so much less of the grip: the check of the whole motion goes by its samples [1].
_SAMPLING = 0.01
#: Smaller sizes that are tried, how much smaller than should fit, and the smallest that is driven [m].
_SIZES, _SMALLER, _SMALLEST_M = 4, 0.9, 0.1


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Pace:
    """What timing has to keep: share of the grip [1], caps, time step of the rows [s], longest run [s]."""

    share: float
    caps: Caps
    step_s: float
    longest_s: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drive:
    """A motion with its times: ``trajectory`` from rest to rest, ``use`` the most of every model's.

    ``repeats``: how often the motion is driven in it.
    """

    motion: Motion
    pace: str
    repeats: int
    trajectory: Trajectory

    @property
    def duration_s(self) -> float:
        """From the first to the last sample [s]."""
        return self.trajectory.duration_s

    @property
    def words(self) -> str:
        """What to drive."""
        often = f", {self.repeats} times" if self.repeats > 1 else ""
        return f"{self.motion.words}{often}, {self.pace}"


def drives(motion: Motion, models: Sequence[Model], pace: Pace) -> list[Drive]:
    """A motion at every pace at which all models keep the limits; empty where there is none.

    The first model plans.  Where another one would exceed its limits the whole motion is slowed down until it
    does not, and left out where slowing down does not help.  A motion that lasts less than half of the
    longest run is repeated; one that would last longer than it is driven smaller.
    """
    made: list[Drive] = []
    planned: dict[float, list[Plan]] = {}
    for words, factor in PACES.items():
        size = 1.0
        for _ in range(_SIZES):
            sized = motion.sized(size)
            try:
                if size not in planned:
                    planned[size] = _planned(sized, models[0], pace)
                found = _slowed(planned[size], models, pace, factor)
            except (NoSolution, InputError):
                break
            if isinstance(found, Trajectory):
                many = _repeats(sized, found)
                made.append(Drive(motion=sized, pace=words, repeats=many, trajectory=found))
                break
            size *= _SMALLER * found
            if size * motion.extent_m < _SMALLEST_M:
                break
    return made


def _planned(motion: Motion, model: Model, pace: Pace) -> list[Plan]:
    request = Request(share=max(0.01, pace.share - _SAMPLING), points=_POINTS, caps=pace.caps)
    return [plan(model, through(leg, arm=model.reach_m), request) for leg in motion.legs]


def _slowed(plans: Sequence[Plan], models: Sequence[Model], pace: Pace, factor: float) -> Trajectory | float:
    """The motion at ``factor`` times its shortest duration, or slower where another model asks for it.

    Where that takes too long: the factor by which a smaller one would fit, durations growing with the root of
    the size.

    Raises
    ------
    NoSolution
        If a model does not allow it at any pace.
    """
    for _ in range(2):
        once = sum(factor * p.duration_s + REST_S for p in plans)
        room = pace.longest_s - REST_S
        if once > room:
            rests = REST_S * len(plans)
            return max(0.0, (room - rests) / (once - rests)) ** 2
        rows = _rows(plans, factor, max(1, int(room / once)), pace.step_s)
        needed = max(check(m, rows.t_s, rows.pose, share=pace.share).time_scale_needed for m in models)
        if needed <= 1.0:
            return _with_use(rows, models)
        if not np.isfinite(needed):
            break
        factor *= 1.02 * needed
    raise NoSolution("the motion", "a model that is left asks for more grip", "drive another one")


def _rows(plans: Sequence[Plan], factor: float, repeats: int, step_s: float) -> Trajectory:
    """Rows on one clock: rest, leg, rest, leg … rest; use is not known yet."""
    blocks: list[tuple[Array, Array, Array, Array]] = []
    rest = max(2, round(REST_S / step_s))
    count = plans[0].model.count

    def stand(pose: Array) -> None:
        still = np.zeros((rest, 3))
        blocks.append((np.tile(pose, (rest, 1)), still, still, np.zeros((rest, count))))

    stand(plans[0].path.pose(np.zeros(1))[0])
    for _ in range(repeats):
        for leg in plans:
            t = np.arange(1, int(np.ceil(factor * leg.duration_s / step_s))) * step_s
            moved = at_times(leg, np.minimum(t / factor, leg.duration_s))
            blocks.append(
                (
                    moved.pose,
                    moved.velocity / factor,
                    moved.acceleration / factor**2,
                    moved.omega / factor,
                )
            )
            stand(leg.path.pose(np.array([leg.path.length]))[0])
    pose, velocity, acceleration, omega = (np.concatenate(part) for part in zip(*blocks, strict=True))
    return Trajectory(
        t_s=np.asarray(step_s * np.arange(len(pose)), dtype=np.float64),
        pose=pose,
        velocity=velocity,
        acceleration=acceleration,
        omega=omega,
        use=np.zeros_like(omega),
        wheels=plans[0].model.geometry.names,
    )


def _with_use(rows: Trajectory, models: Sequence[Model]) -> Trajectory:
    use = [use_along(m, rows.t_s, rows.pose, rows.velocity, rows.acceleration, held=True) for m in models]
    return Trajectory(
        t_s=rows.t_s,
        pose=rows.pose,
        velocity=rows.velocity,
        acceleration=rows.acceleration,
        omega=rows.omega,
        use=np.max(use, axis=0),
        wheels=rows.wheels,
    )


def _repeats(motion: Motion, rows: Trajectory) -> int:
    """How often a motion is driven: every leg ends in a rest, which begins where the wheels come to stand."""
    still = np.all(rows.omega == 0.0, axis=1)
    rests = int(np.count_nonzero(still[1:] & ~still[:-1]))
    return rests // len(motion.legs)
