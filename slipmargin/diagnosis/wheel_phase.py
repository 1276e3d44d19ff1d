"""Wheel phases that are not in the log: the angle of each wheel at the start of a trial.

Where only wheel speeds are logged, a wheel's angle is known but for a constant, its phase.  It matters
only to models that depend on the wheel angle, and only within one roller's pitch, or a turn where a wheel is
out of round.  On trials that a search may see, phases are fitted to the whole trial.  On a trial that is to
be predicted they are fitted to its first part alone, with parameters that come from other trials; the score
is then that of the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.odometry import bridged, wheel_angles
from slipmargin.data.record import Record
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, build, fit
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect
from slipmargin.model import Model
from slipmargin.physics.kinematics import integrated
from slipmargin.physics.sectors import pitch, switching
from slipmargin.physics.variables import Variable

#: Phases tried, in pitches: over the whole pitch; then ever closer around the best one.
_AROUND = np.arange(1, 20) / 20.0
_CLOSE = np.array([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0])
_FINER = (60.0, 60.0, 120.0, 240.0)
#: Sweeps of a first guess, from a start of the parameters, which only has to lie in the right valley.
_GUESS = (_AROUND, _CLOSE / 60.0, _AROUND, _CLOSE / 60.0)


def is_unknown(problem: Problem) -> bool:
    """Whether no trial's log holds wheel angles."""
    return all(trial.record.theta is None for trial in problem.trials)


def matters_to(model: Model) -> bool:
    """Whether friction or rolling of a model depends on where its wheels stand."""
    grip = model.grip
    sectors = switching(grip.rigid_fraction, *grip.roller.T, *grip.rigid.T)
    if np.any(sectors) or model.geometry.changes_in_a_turn:
        return True
    return any(m.variable is Variable.WHEEL_ANGLE for m in grip.multipliers)


def guessed(problem: Problem, trials: Index, candidates: Sequence[Candidate]) -> Problem:
    """With the phases that suit the model as it stands, or else the best candidate that depends on them.

    Only ``trials`` get phases; the others keep what they have.
    """
    rough = problem.rough()
    if matters_to(problem.model(())):
        rough = _swept(rough, [()], trials, _AROUND)
        return problem.with_wheel_phases(_swept(rough, [()], trials, _CLOSE / _FINER[0]).wheel_phases)
    fullest: dict[str, Candidate] = {}
    for candidate in candidates:
        if candidate.named and candidate.wheel_phase:
            known = fullest.get(candidate.name)
            fullest[candidate.name] = candidate if known is None or candidate.size > known.size else known
    tried = [_in_turn(rough, (c,), c.starts[0], trials, _GUESS) for c in fullest.values()]
    if not tried:
        return problem
    return problem.with_wheel_phases(min(tried, key=lambda pair: pair[1].cost)[0].wheel_phases)


def refined(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
    """Phases and parameters of a fit on its trials, each found in turn with the other as it stands.

    Phases from parameters that were far off may lie in a valley of their own: once the parameters are near,
    the whole pitch is looked at again.
    """
    close = [_CLOSE / fineness for fineness in _FINER]
    rough, near = _in_turn(
        problem.rough(), found.structure, found.x, found.trials, (*close[:2], _AROUND, close[1])
    )
    problem = problem.with_wheel_phases(rough.wheel_phases)
    return _in_turn(problem, near.structure, near.x, near.trials, close[2:])


def _in_turn(
    problem: Problem, structure: tuple[Candidate, ...], x: Array, trials: Index, sweeps: Sequence[Array]
) -> tuple[Problem, Fit]:
    """Phases swept over these steps, and parameters fitted from ``x`` after each sweep."""
    found = None
    for steps in sweeps:
        effects = build(structure, x) if found is None else found.effects
        problem = _swept(problem, [effects], trials, steps)
        view = problem.in_pieces(SETTINGS.phase_piece_s)
        found = fit(view, structure, x if found is None else found.x, trials)
    assert found is not None
    return problem, found


def first_part(record: Record) -> Record:
    """A trial until its wheels have turned :attr:`SearchSettings.phase_part` of all their way."""
    return record.part(record.t_s <= _end_of_first_part(record))


def from_first_parts(
    problem: Problem, rows: Index, runs: Sequence[Record], effects: Sequence[tuple[AnyEffect, ...]]
) -> tuple[Problem, Array]:
    """With phases of trials ``rows`` fitted to the first parts of their runs, and the times these end (R,).

    Nothing that was measured of the motion after these times has any influence.  Trials in other rows keep
    their phases and end before they begin.

    Parameters
    ----------
    problem : Problem
        The trials.
    rows : array (K,) of int
        Which of them.
    runs : sequence of K Record
        The run that each of them is, or is cut from.
    effects : sequence of K tuples of effects
        The effects to assume on each.
    """
    parts = tuple(clean(first_part(run), problem.sigma) for run in runs)
    early = Problem.of(
        problem.recipe,
        problem.surface,
        parts,
        problem.sigma,
        problem.commanded,
        problem.members,
        problem.member_of[rows],
    )
    early = replace(early, lasting=problem.lasting)
    everyone = np.arange(len(parts), dtype=np.int64)
    same = all(e == effects[0] for e in effects)
    rough = early.with_rough().rough()
    for steps in (_AROUND, _CLOSE / _FINER[0]):
        rough = _swept(rough, effects[:1] if same else effects, everyone, steps)
    early = early.with_wheel_phases(rough.wheel_phases)
    for fineness in _FINER[1:]:
        early = _swept(early, effects[:1] if same else effects, everyone, _CLOSE / fineness)
    phases = problem.wheel_phases.copy()
    ends = np.full(len(problem.trials), -np.inf)
    for row, run, phase in zip(rows, runs, early.wheel_phases, strict=True):
        phases[row] = phase + turned_before(run, float(problem.trials[row].t_s[0]), problem.commanded)
        ends[row] = _end_of_first_part(run)
    return problem.with_wheel_phases(phases), ends


def _speeds(run: Record, commanded: bool) -> Array:
    speeds = run.omega_cmd if commanded or run.omega is None else run.omega
    assert speeds is not None, f"{run.name} has no wheel speeds"
    return bridged(run.t_s, speeds)


def turned_before(run: Record, t_s: float, commanded: bool) -> Array:
    """Angle (N,) by which the wheels have turned at a time of a run [rad]."""
    angles = wheel_angles(run.t_s, None, _speeds(run, commanded))
    assert angles is not None
    return np.array([np.interp(t_s, run.t_s, column) for column in angles.T])


def _end_of_first_part(run: Record) -> float:
    rate = np.mean(np.abs(_speeds(run, run.omega is None)), axis=1)
    turned = integrated(run.t_s, rate)
    last = int(np.searchsorted(turned, SETTINGS.phase_part * turned[-1], side="right")) - 1
    return float(run.t_s[min(max(last, SETTINGS.phase_samples - 1), len(run.t_s) - 1)])


def _swept(
    problem: Problem, effects: Sequence[tuple[AnyEffect, ...]], trials: Index, steps: Array
) -> Problem:
    """The problem with the phases that fit each of some trials best, one wheel after the other, twice.

    ``effects`` are one set for all ``trials`` or one for each.
    """
    models = [problem.model(own) for own in effects]
    turn = pitch(problem.nominal.grip.rollers)
    if any(m.geometry.changes_in_a_turn for m in models):  # that repeats once a turn, not once a roller
        turn = np.full_like(turn, 2.0 * np.pi)
    best = problem.wheel_phases.copy()
    view = problem.in_pieces(SETTINGS.phase_piece_s)
    cost = _costs(view, best, effects, trials)
    for wheel in (*range(best.shape[1]),) * 2:
        start = best.copy()
        for step in steps:
            tried = start.copy()
            tried[:, wheel] += step * turn[wheel]
            found = _costs(view, tried, effects, trials)
            better = found < cost
            best[trials[better], wheel] = tried[trials[better], wheel]
            cost = np.where(better, found, cost)
    best[trials] = best[trials] % turn
    return problem.with_wheel_phases(best)


def _costs(problem: Problem, phases: Array, effects: Sequence[tuple[AnyEffect, ...]], trials: Index) -> Array:
    """Sum of squares of each trial with these phases."""
    rows = [trials] if len(effects) == 1 else [trials[i : i + 1] for i in range(len(trials))]
    residual = problem.with_wheel_phases(phases).residuals(effects, rows)
    return np.concatenate([np.sum(r**2, axis=1) for r in residual])
