"""The runs to drive next: from what a diagnosis leaves open, by comparing every motion of the library."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.fit import Fit
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.watch import Watch
from slipmargin.errors import InputError
from slipmargin.experiment.choose import (
    Pair,
    hideable,
    narrowed,
    narrowing,
    pairs,
    separating,
    showing,
    unseen,
)
from slipmargin.experiment.gain import evaluated, only, problem_of_drives
from slipmargin.experiment.motions import Space, library, reach_m
from slipmargin.experiment.refit import expected_rise
from slipmargin.experiment.remaining import Question, Remaining, remaining
from slipmargin.experiment.result import NextRuns, ProposedRun, Separation
from slipmargin.experiment.timing import Drive, Pace, drives
from slipmargin.paths.along import Caps

#: The longest run may take this long [s], however short the runs that there are.
_LONG_S = 5.0
#: Rivals with more parameters than this are not fitted again by simulation: it would take minutes.
_MOST_REFITTED = 6


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked for.

    ``size_m`` is the space, None: what the runs that there are have covered; ``longest_s`` the longest run,
    None: the longest one that there is; ``share`` of the grip; ``max_speed_m_s`` and ``max_yaw_rate_rad_s``
    are caps.
    """

    runs: int = 3
    size_m: tuple[float, float] | None = None
    share: float = 0.9
    longest_s: float | None = None
    max_speed_m_s: float = np.inf
    max_yaw_rate_rad_s: float = np.inf
    seed: int = 0


def next_runs(
    data_set: DataSet, request: Request, repairs: tuple[Repair, ...] | None, progress: Watch
) -> NextRuns:
    """Diagnose the data set and choose the runs that tell most of what it leaves open.

    Parameters
    ----------
    data_set : DataSet
        In the frame in which diagnoses are computed.
    request : Request
        What is asked for.
    repairs : tuple of Repair, optional
        What was mended in it already.
    progress : Watch
        Told what is being done.

    Raises
    ------
    InputError
        If the robot does not fit into the space, or no motion is possible in it.
    """
    reach = reach_m(data_set.recipe.build(data_set.surface))
    _space(data_set, request, reach).room_m(reach)  # what is too small is refused before the work
    left = remaining(data_set, repairs, request.seed, progress)
    return proposed(left, request, progress)


def proposed(
    left: Remaining, request: Request, progress: Watch, kinds: Collection[str] | None = None
) -> NextRuns:
    """The runs that tell most of what is left open.

    Parameters
    ----------
    left : Remaining
        What a diagnosis leaves.
    request : Request
        What is asked for.
    progress : Watch
        Told what is being done.
    kinds : collection of str, optional
        Motions of these kinds alone; by default the whole library.

    Raises
    ------
    InputError
        If the robot does not fit into the space, or no motion is possible in it.
    """
    data_set = left.data_set
    reach = reach_m(data_set.recipe.build(data_set.surface))
    space = _space(data_set, request, reach)
    able = _able(left, space, request, progress, kinds)
    if not able:
        raise _no_motion()
    progress("simulating every motion", 0.6)
    new = problem_of_drives(left.problem, able, request.seed)
    keep = _inside(left, able, new, space, reach)
    if not keep:
        raise _no_motion()
    able, new = [able[k] for k in keep], only(new, keep)
    on_new = evaluated(new, left.fits)
    progress("choosing", 0.7)
    every: list[Pair] = []
    if left.question is Question.WHICH:
        every = pairs(left, on_new)
        chosen = separating(request.runs, able, every)
        narrowings = narrowed(left, on_new[0], chosen)
    elif left.question is Question.HOW_MUCH:
        chosen = narrowing(request.runs, able, left, on_new[0])
        narrowings = narrowed(left, on_new[0], chosen)
    else:
        hidden = unseen(left, new)
        chosen = showing(request.runs, able, hidden)
        narrowings = hideable(hidden, chosen)
    driven = only(new, chosen)
    return NextRuns(
        data_set=data_set.name,
        robot=data_set.recipe.robot.name,
        surface=data_set.surface,
        verdict=left.verdict,
        question=left.question,
        explanations=tuple(f.said for f in left.fits),
        runs=_written([able[k] for k in chosen], driven, left.fits),
        separations=_separations(left, driven, every, chosen, progress),
        narrowings=narrowings,
        compared=len(able),
        space=space,
        reach_m=reach,
        share=request.share,
        misfit=left.misfit,
        noise=left.problem.sigma,
        front_rad=data_set.recipe.robot.convention.front_rad,
        was_cut=left.was_cut,
    )


def _no_motion() -> InputError:
    return InputError(
        "space",
        "is too small: in it no motion of the list keeps the limits of every explanation that is left",
        "give more space or longer runs, or drive what slipmargin diagnose proposes in words",
    )


def _space(data_set: DataSet, request: Request, reach: float) -> Space:
    """The space that is asked for, about the middle of the runs; or what these have covered."""
    seen = np.concatenate([t.pose[:, :2] for t in data_set.trials])
    low, high = np.nanmin(seen, axis=0), np.nanmax(seen, axis=0)
    x, y = (0.5 * (low + high)).tolist()
    if request.size_m is not None:
        return Space(middle_m=(x, y), size_m=request.size_m)
    a, b = (high - low + 2.0 * reach).tolist()
    return Space(middle_m=(x, y), size_m=(a, b))


def _able(
    left: Remaining, space: Space, request: Request, progress: Watch, kinds: Collection[str] | None
) -> list[Drive]:
    """Every motion of the library at every pace that keeps the limits of all explanations."""
    models = [left.problem.model(f.effects) for f in left.fits]
    spans = [float(t.t_s[-1] - t.t_s[0]) for t in left.problem.trials]
    pace = Pace(
        share=request.share,
        caps=Caps(speed_m_s=request.max_speed_m_s, yaw_rate_rad_s=request.max_yaw_rate_rad_s),
        step_s=left.problem.step_s,
        longest_s=max(_LONG_S, *spans) if request.longest_s is None else request.longest_s,
    )
    made: list[Drive] = []
    motions = [m for m in library(space, models[0]) if kinds is None or m.kind in kinds]
    for number, motion in enumerate(motions):
        progress("timing the motions", number / len(motions))
        made += drives(motion, models, pace)
    return made


def _inside(left: Remaining, able: Sequence[Drive], new: Problem, space: Space, reach: float) -> list[int]:
    """The drives in which no explanation leaves the space."""
    everyone = np.arange(len(new.trials), dtype=np.int64)
    poses = new.predict([f.effects for f in left.fits], [everyone] * len(left.fits))
    return [
        k
        for k, drive in enumerate(able)
        if all(space.excess_m(pose[k, : len(drive.trajectory.t_s)], reach) == 0.0 for pose in poses)
    ]


def _separations(
    left: Remaining, driven: Problem, every: Sequence[Pair], chosen: Sequence[int], progress: Watch
) -> tuple[Separation, ...]:
    """Every ordered pair with its χ² today, after each run, and after the rival's refit by simulation."""
    everyone = np.arange(len(driven.trials), dtype=np.int64)
    poses = driven.predict([f.effects for f in left.fits], [everyone] * len(left.fits))
    made = []
    for number, pair in enumerate(every):
        progress("fitting rivals to the runs as they would be", number / len(every))
        right, rival = left.fits[pair.right], left.fits[pair.rival]
        today = (rival.cost - right.cost) / left.misfit**2
        by_run = tuple(pair.contrast.gain(chosen[: n + 1]) for n in range(len(chosen)))
        simulated = len(rival.x) <= _MOST_REFITTED
        after = (
            expected_rise(left.problem, driven, right, rival, left.misfit)
            if simulated
            else today + by_run[-1]
        )
        apart = np.where(driven.seen, poses[pair.right] - poses[pair.rival], 0.0)
        made.append(
            Separation(
                right=right.said,
                rival=rival.said,
                today=today,
                expected=after,
                simulated=simulated,
                by_run=by_run,
                apart_mm=float(1e3 * np.max(np.hypot(apart[..., 0], apart[..., 1]))),
                apart_deg=float(np.rad2deg(np.max(np.abs(apart[..., 2])))),
            )
        )
    return tuple(made)


def _written(chosen: Sequence[Drive], driven: Problem, fits: Sequence[Fit]) -> tuple[ProposedRun, ...]:
    everyone = np.arange(len(driven.trials), dtype=np.int64)
    poses: list[Array] = driven.predict([f.effects for f in fits], [everyone] * len(fits))
    return tuple(
        ProposedRun(
            name=f"run-{k + 1}",
            words=drive.words,
            legs=drive.motion.legs,
            repeats=drive.repeats,
            trajectory=drive.trajectory,
            predicted=tuple(pose[k, : len(drive.trajectory.t_s)] for pose in poses),
        )
        for k, drive in enumerate(chosen)
    )
