"""Lines of the floor at which the motion changes as it would on a narrow ridge: where one may lie.

A narrow ridge answers a tangent only where it is, and there are thousands of places for it.  But each wheel
that crosses it is held back and pushed on again, in every run, on one line.  So no line is simulated: the
body's velocity that the model does not predict is compared with what a ridge on each of many lines would do
to it (a matched filter), and fits start on the best of these lines.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.odometry import body_velocity, bridged
from slipmargin.diagnosis.fit import Fit
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.screen import Screened, Screening
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.tangents import in_parts
from slipmargin.physics import frames, relief
from slipmargin.physics.compiled import kernel, twin

_RIDGE = relief.RIDGE
_beyond, _rise, _to_body = twin(relief.beyond), twin(relief.rise), twin(frames.to_body)
#: So many widths to either side a ridge is flat: 2^−16 of its height.
_FLAT = 2.0
#: Directions of the normals: every five degrees of half a turn.
_DIRECTIONS = np.arange(36) * np.pi / 36.0
#: At most so many lines a direction: over more than 16 m they lie farther apart.
_MOST = 800


def at_crossings(
    before: State, screening: Screening, overdue: Callable[[], bool] = lambda: False
) -> list[Screened]:
    """Entries of candidates that say a line, with starts on the lines that the residual points to.

    Each start is the best of several, as simulated, on its line; the best line comes first, and what it takes
    off is promised.
    """
    entries = [e for e in screening.entries if e.stands_alone and len(e.structure[0].near)]
    found = lines(before.view, before.fit) if entries else np.zeros((0, 2))
    shifts = np.array([-1.0, 0.0, 1.0]) * SETTINGS.crossing_m
    out, base, problem = [], before.fit, before.view.rough()
    off = np.sum(problem.residuals([base.effects], [base.trials])[0] ** 2) if len(found) else 0.0
    for entry in entries:
        candidate = entry.structure[0]
        best: list[tuple[float, Array]] = []
        for offset, direction in found:
            rows = np.concatenate([candidate.on_line(offset + shift, direction) for shift in shifts])
            points = [(*base.effects, candidate.build(x)) for x in rows]
            squares = [float(np.sum(r**2)) for r in in_parts(problem, points, base.trials, overdue)]
            if squares:
                best.append((min(squares), rows[int(np.argmin(squares))]))
        if best:
            best.sort(key=lambda row: row[0])
            out.append(replace(entry, starts=tuple(x for _, x in best), promise=float(off) - best[0][0]))
    return out


def lines(problem: Problem, base: Fit) -> Array:
    """Lines (L, 2) at which the motion that ``base`` leaves changes as on a ridge: offset [m], normal [rad].

    The one whose ridge takes most off the squared velocity comes first.
    """
    model = problem.model(base.effects)
    arms = np.column_stack([model.geometry.position_m - model.inertia.com_m, model.loads.rest_N])
    memory = SETTINGS.probe_memory_s
    every = max(1, int(SETTINGS.crossing_step_s / problem.step_s))
    ends, poses, rates = _left_over(problem, base, every)
    if not len(poses):
        return np.zeros((0, 2))
    arm = float(np.hypot(*arms[:, :2].T).max())
    along = poses[:, :2] @ [np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)]
    low, high = along.min(axis=0) - arm, along.max(axis=0) + arm
    many = int(np.clip(np.max(high - low) / SETTINGS.crossing_m, 2, _MOST))
    tried = np.stack([np.linspace(low, high, many), np.tile(_DIRECTIONS, (many, 1))], axis=-1).reshape(-1, 2)
    products = np.zeros((len(tried), 2))
    keep = float(np.exp(-problem.step_s * every / memory))
    per_push = memory / model.inertia.diagonal / problem.sigma
    _compared(tried, SETTINGS.crossing_width_m, ends, poses, rates, arms, per_push, keep, products)
    pulls, squares = products.T
    gains = pulls**2 / np.maximum(squares + SETTINGS.crossing_touched * squares.max(), 1e-300)
    kept: list[tuple[float, float]] = []
    for offset, direction in tried[np.argsort(-gains, kind="stable")].tolist():
        if not any(_same(offset, direction, *other) for other in kept):
            kept.append((offset, direction))
        if len(kept) == SETTINGS.crossings:
            break
    return np.array(kept)


@kernel
def _compared(
    lines: Any,
    width: float,
    ends: Any,
    poses: Any,
    rates: Any,
    arms: Any,
    per_push: Any,
    keep: float,
    out: Any,
) -> None:
    """Products of what a ridge 1 m high and ``width`` wide on each line (L, 2) does to the body's velocity.

    Into ``out`` (L, 2): with the velocities ``rates`` (T, 3) at ``poses`` (T, 3), and with itself.  ``ends``
    (R + 1): where runs begin in these; ``arms`` (N, 3): each wheel's place from the centre of mass and load;
    ``per_push`` (3,): velocity, over its noise, that a lasting unit of force or moment leads to; ``keep``:
    what is left of a velocity after a step.
    """
    for line in range(len(lines)):
        offset, direction = lines[line, 0], lines[line, 1]
        pull, square = 0.0, 0.0
        for run in range(len(ends) - 1):
            x, y, turn = 0.0, 0.0, 0.0
            for k in range(ends[run], ends[run + 1]):
                along_x, along_y = _to_body(poses[k, 2], np.cos(direction), np.sin(direction))
                middle = _beyond(offset, direction, poses[k, 0], poses[k, 1])
                force, moment = 0.0, 0.0
                for w in range(len(arms)):
                    d = middle + along_x * arms[w, 0] + along_y * arms[w, 1]
                    if abs(d) < _FLAT * width:
                        push = -arms[w, 2] * _rise(_RIDGE, 1.0, width, width, d)
                        force += push
                        moment += push * (arms[w, 0] * along_y - arms[w, 1] * along_x)
                x = keep * x + (1.0 - keep) * per_push[0] * force * along_x
                y = keep * y + (1.0 - keep) * per_push[1] * force * along_y
                turn = keep * turn + (1.0 - keep) * per_push[2] * moment
                pull += x * rates[k, 0] + y * rates[k, 1] + turn * rates[k, 2]
                square += x * x + y * y + turn * turn
        out[line, 0], out[line, 1] = pull, square


def _same(offset: float, direction: float, other: float, towards: float) -> bool:
    turned = abs(direction - towards)
    if turned > 0.5 * np.pi:  # the same line has its normal the other way round
        turned, other = np.pi - turned, -other
    return turned <= SETTINGS.crossing_same_rad and abs(offset - other) <= SETTINGS.crossing_same_m


def _left_over(problem: Problem, base: Fit, every: int) -> tuple[Array, Array, Array]:
    """Where each run begins (R + 1), poses (T, 3) of the centre of mass, and velocities (T, 3) not predicted.

    These are the body's, over the noise of the pose [1/s]: a heading that went astray does not turn them.
    One sample of ``every`` is looked at.
    """
    whole = replace(problem, piece=None)
    com_m = problem.model(base.effects).inertia.com_m
    half = max(1, round(0.5 * SETTINGS.crossing_s / problem.step_s))
    ends, poses, rates = [0], [np.zeros((0, 3))], [np.zeros((0, 3))]
    predicted = whole.predict([base.effects], [base.trials])[0]
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
    return np.array(ends), np.concatenate(poses), np.concatenate(rates)
