"""Lines of the floor at which the motion changes as it would on a ridge or a ramp: where one may lie.

A narrow ridge or a short ramp answers a tangent only where it is, and there are thousands of places for it.
But each wheel that crosses it is pushed, in every run, on one line.  So no line is simulated: the body's
velocity that the model does not predict is compared with what a relief on each of many lines would do to it
(a matched filter), and fits start on the best of these lines.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.odometry import body_velocity, bridged
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.spots import Spot, best_spots
from slipmargin.diagnosis.state import State
from slipmargin.effects.places import LINE
from slipmargin.model import Model
from slipmargin.physics import frames
from slipmargin.physics.compiled import kernel, twin
from slipmargin.physics.relief import RAMP, Relief, beyond, rise

_rise = twin(rise)
#: So many widths to either side a ridge is flat: 2^−16 of its height.
_FLAT = 2.0
#: A ramp is level so many widths of its edges beyond them: to 5e-5 of its slope.
_EDGES = 10.0
#: Directions of the normals: every five degrees of half a turn.
_DIRECTIONS = np.arange(36) * np.pi / 36.0
#: At most so many lines a direction: over more than some ten metres they lie farther apart.
_MOST = 800


def at_crossings(
    before: State, screening: Screening, overdue: Callable[[], bool] = lambda: False
) -> list[Screened]:
    """Entries of candidates that say a line, with starts on the lines that the residual points to.

    Each start is the best of several, as simulated, on its line; the best lines are moved to better ones
    beside them.  The best comes first, and what it takes off is promised.
    """
    entries = [e for e in screening.entries if e.stands_alone and e.structure[0].is_near(LINE)]
    if not entries:
        return []
    base, out = before.fit, []
    predicted = replace(before.view, piece=None).predict([base.effects], [base.trials])[0]
    centre = np.nanmedian(
        np.concatenate([before.view.trials[int(i)].pose[:, :2] for i in base.trials]), axis=0
    )
    for entry in entries:
        candidate = entry.structure[0]
        shapes = _shapes(before.view.nominal, candidate)
        reliefs = [relief for relief, _, _ in shapes]
        spots = []
        for line in () if overdue() else lines(before.view, base, predicted, reliefs, SETTINGS.crossings):
            relief, near, sizes = shapes[line.shape]
            apart_m = SETTINGS.crossing_apart * relief.extent_m
            rows = candidate.at(LINE, (line.offset_m, line.direction_rad), near[np.sign(sizes) == line.sign])
            spots.append(Spot(rows, partial(_beside, candidate, apart_m=apart_m, centre=centre)))
        out += best_spots(before, entry, spots, overdue)
    return out


def _beside(candidate: Candidate, x: Array, share: float, apart_m: float, centre: Array) -> Array:
    """Parameters ``x`` (P,) on eight lines (8, P) beside theirs: farther, nearer, turned about ``centre``.

    They lie a ``share`` of ``apart_m`` and of the angle between two directions away.
    """
    offset, direction = candidate.where(LINE, x)
    rows = []
    for way in np.array([-share, 0.0, share]) * (_DIRECTIONS[1] - _DIRECTIONS[0]):
        turned = float(beyond(0.0, direction + way, *centre) - beyond(0.0, direction, *centre))
        for shift in (-share * apart_m, 0.0, share * apart_m):
            if way or shift:
                rows.append(candidate.at(LINE, (offset + turned + shift, direction + way), x[None]))
    return np.concatenate(rows)


def _shapes(nominal: Model, candidate: Candidate) -> list[tuple[Relief, Array, Array]]:
    """A relief of each extent that a candidate starts with on a line; parameters (Q, P), sizes (Q,)."""
    found: dict[float, list[tuple[Relief, Array]]] = {}
    for x in candidate.near:  # of a floor of its own, in a campaign, it does not act in every model
        relief = candidate.build(x).rewrite(nominal.external, nominal).reliefs[-1]
        found.setdefault(relief.extent_m, []).append((relief, x))
    return [
        (rows[0][0], np.array([x for _, x in rows]), np.array([relief.size for relief, _ in rows]))
        for rows in found.values()
    ]


@final
@dataclass(frozen=True, slots=True)
class Line:
    """A line of the floor: where what lies on it begins [m], its normal [rad], the number of its shape.

    ``sign``: 1 for a ridge or a rise along the normal, −1 for a groove or a fall.
    """

    offset_m: float
    direction_rad: float
    shape: int
    sign: int


def lines(problem: Problem, base: Fit, predicted: Array, reliefs: Sequence[Relief], most: int) -> list[Line]:
    """Lines at which the motion that ``base`` leaves changes as on one of ``reliefs``: ``most`` at most.

    ``predicted`` (R, T, 3) are the poses that ``base`` says of whole runs.  The line comes first whose relief
    takes most off the squared velocity.
    """
    looked = [_gains(problem, base, predicted, relief) for relief in reliefs]
    gains = np.concatenate([np.zeros(0), *(np.abs(gain).ravel() for _, _, gain in looked)])
    ends = np.cumsum([gain.size for _, _, gain in looked])
    kept: list[tuple[Line, tuple[float, float, float]]] = []
    for k in np.argsort(-gains, kind="stable").tolist():
        shape = int(np.searchsorted(ends, k, side="right"))
        offsets, centre, gain = looked[shape]
        at = k - int(ends[shape]) + gain.size
        direction, sign = float(_DIRECTIONS[at // offsets.shape[1]]), 1 if gain.flat[at] >= 0.0 else -1
        line = Line(float(offsets.flat[at]), direction, shape, sign)
        place = _place(line, reliefs[shape], centre)
        if not any(line.shape == own.shape and _same(place, other) for own, other in kept):
            kept.append((line, place))
        if len(kept) == most:
            break
    return [line for line, _ in kept]


def _length(relief: Relief) -> float:
    """How far beyond its line a relief goes on [m]: a ramp begins there, a ridge is on it."""
    return relief.extent_m if relief.profile == RAMP else 0.0


def _place(line: Line, relief: Relief, centre: Array) -> tuple[float, float, float]:
    """How far the middle of what lies on a line is beyond ``centre`` (2,) [m], its normal, its length [m]."""
    long = _length(relief)
    return -float(beyond(line.offset_m + 0.5 * long, line.direction_rad, *centre)), line.direction_rad, long


def _same(one: tuple[float, float, float], other: tuple[float, float, float]) -> bool:
    """Whether a fit from one place reaches the other; each is a middle, a direction and a length."""
    (middle, direction, long), (far, towards, length) = one, other
    turned = abs(direction - towards)
    if turned > 0.5 * np.pi:  # the same line has its normal the other way round
        turned, far = np.pi - turned, -far
    near = max(SETTINGS.crossing_same_m, 0.5 * min(long, length))
    return turned <= SETTINGS.crossing_same_rad and abs(middle - far) <= near


def _gains(problem: Problem, base: Fit, predicted: Array, relief: Relief) -> tuple[Array, Array, Array]:
    """What a relief on each of many lines takes off the velocity that ``base`` leaves, squared [1/s].

    Offsets (D, O) of the lines in each direction, the middle of the floor that is driven over (2,), gains
    (D, O), in which velocities count by the noise of the pose; those of a groove or a fall are negative.
    """
    model = problem.model(base.effects)
    arms = np.column_stack([model.geometry.position_m - model.inertia.com_m, model.loads.rest_N])
    memory = SETTINGS.probe_memory_s
    left = _left_over(problem, base, predicted, SETTINGS.crossing_step_s_per_m * relief.extent_m)
    if not len(left.poses):
        return np.zeros((len(_DIRECTIONS), 0)), np.zeros(2), np.zeros((len(_DIRECTIONS), 0))
    arm = float(np.hypot(*arms[:, :2].T).max())
    heading, ahead = left.poses[:, 2], (np.cos(_DIRECTIONS)[:, None], np.sin(_DIRECTIONS)[:, None])
    normals = np.stack(frames.to_body(heading, *ahead), axis=-1)
    far = beyond(0.0, _DIRECTIONS[:, None], left.poses[:, 0], left.poses[:, 1])
    low, high = far.min(axis=1) - arm - _length(relief), far.max(axis=1) + arm
    many = 1 + int(
        np.clip(np.ceil(np.max(high - low) / (SETTINGS.crossing_apart * relief.extent_m)), 1, _MOST)
    )
    offsets = np.linspace(low, high, many, axis=1)
    keep = float(np.exp(-left.step_s / memory))
    per_push = memory / model.inertia.diagonal / problem.sigma
    shape = int(relief.profile), float(relief.extent_m), float(relief.edge_m)
    pulls, squares = np.zeros_like(offsets), np.zeros_like(offsets)
    _compared(offsets, *shape, far, normals, left.ends, left.rates, arms, per_push, keep, pulls, squares)
    squares += SETTINGS.crossing_touched * squares.max()
    gains = left.step_s * pulls * np.abs(pulls) / np.maximum(squares, 1e-300)
    return offsets, np.median(left.poses[:, :2], axis=0), gains


@kernel
def _compared(
    offsets: Any,
    profile: int,
    extent: float,
    edge: float,
    far: Any,
    normals: Any,
    ends: Any,
    rates: Any,
    arms: Any,
    per_push: Any,
    keep: float,
    pulls: Any,
    squares: Any,
) -> None:
    """Products of what a relief of size 1 on each line does to the body's velocity.

    Lines lie at ``offsets`` (D, O) in each of D directions.  Into ``pulls`` (D, O): with the velocities
    ``rates`` (T, 3); into ``squares`` (D, O): with itself.  ``far`` (D, T): how far the centre of mass lies
    in each direction; ``normals`` (D, T, 2): the direction as the body sees it; ``ends`` (R + 1): where runs
    begin in these; ``arms`` (N, 3): each wheel's place from the centre of mass and load; ``per_push`` (3,):
    velocity, over its noise, that a lasting unit of force or moment leads to; ``keep``: what is left of a
    velocity after a step.
    """
    low, high = -_FLAT * extent, _FLAT * extent
    if profile == RAMP:
        low, high = -_EDGES * edge, extent + _EDGES * edge
    for line in range(offsets.size):
        towards, offset = line // offsets.shape[1], offsets.flat[line]
        pull, square = 0.0, 0.0
        for run in range(len(ends) - 1):
            x, y, turn = 0.0, 0.0, 0.0
            for k in range(ends[run], ends[run + 1]):
                along_x, along_y = normals[towards, k, 0], normals[towards, k, 1]
                force, moment = 0.0, 0.0
                for w in range(len(arms)):
                    d = far[towards, k] - offset + along_x * arms[w, 0] + along_y * arms[w, 1]
                    if low < d < high:
                        push = -arms[w, 2] * _rise(profile, 1.0, extent, edge, d)
                        force += push
                        moment += push * (arms[w, 0] * along_y - arms[w, 1] * along_x)
                x = keep * x + (1.0 - keep) * per_push[0] * force * along_x
                y = keep * y + (1.0 - keep) * per_push[1] * force * along_y
                turn = keep * turn + (1.0 - keep) * per_push[2] * moment
                pull += x * rates[k, 0] + y * rates[k, 1] + turn * rates[k, 2]
                square += x * x + y * y + turn * turn
        pulls.flat[line], squares.flat[line] = pull, square


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _LeftOver:
    """Velocities that are not predicted.

    ``ends`` (R + 1,) says where each run begins in ``poses`` (T, 3) of the centre of mass and in ``rates``
    (T, 3): the body's velocities, over the noise of the pose [1/s], so that a heading that went astray does
    not turn them.  Samples lie ``step_s`` apart.
    """

    ends: NDArray[np.int64]
    poses: Array
    rates: Array
    step_s: float


def _left_over(problem: Problem, base: Fit, predicted: Array, step_s: float) -> _LeftOver:
    """Velocities, about every ``step_s``, that ``base`` does not say: it ``predicted`` poses (R, T, 3)."""
    every = max(1, int(step_s / problem.step_s))
    com_m = problem.model(base.effects).inertia.com_m
    half = max(1, round(0.5 * SETTINGS.crossing_s / problem.step_s))
    ends, poses, rates = [0], [np.zeros((0, 3))], [np.zeros((0, 3))]
    for number, pose in zip(base.trials, predicted, strict=True):
        trial = problem.trials[int(number)]
        measured = bridged(trial.t_s, trial.pose)
        if len(measured) <= 2 * half:
            continue
        there, believed = (body_velocity(trial.t_s, p, half) for p in (measured, pose[: len(measured)]))
        own = slice(half, len(measured) - half, every)
        poses.append(measured[own])
        poses[-1][:, :2] += np.stack(frames.to_floor(poses[-1][:, 2], *com_m), axis=1)
        rate = ((there - believed) / problem.sigma)[::every]
        rates.append(np.where(np.isfinite(rate), rate, 0.0))  # a prediction that diverged says nothing
        ends.append(ends[-1] + len(poses[-1]))
    return _LeftOver(
        ends=np.array(ends),
        poses=np.concatenate(poses),
        rates=np.concatenate(rates),
        step_s=problem.step_s * every,
    )
