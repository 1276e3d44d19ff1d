"""What a search finds in the runs that are not held out: whole first, then cut at events."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Index
from slipmargin.data.data_set import DataSet
from slipmargin.data.noise import white_noise
from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.conditions import held_runs_of
from slipmargin.diagnosis.court import Court
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.events import cut_apart, find_events
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.held_out import searched_runs
from slipmargin.diagnosis.mounted import rotations_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.ranges import ranges
from slipmargin.diagnosis.refits import fitted, needed
from slipmargin.diagnosis.restated import redefined
from slipmargin.diagnosis.result import Event
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.search import search
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch, no_progress
from slipmargin.effects import AnyEffect


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Searched:
    """What a search found without the held-out trials.

    ``runs`` (R,) is the number of the run that each trial is, or is cut from; ``held`` and ``seen`` are the
    numbers of the trials that were held out and of the others; ``events`` happened in the uncut runs.
    """

    problem: Problem
    uncut: Problem
    runs: tuple[int, ...]
    held: Index
    seen: Index
    seen_runs: Index
    candidates: list[Candidate]
    state: State
    rounds: list[Round]

    def court(self, data_set: DataSet, seed: int) -> Court:
        """The runs of the data set, before which what was found is judged."""
        return Court(
            problem=self.problem,
            runs=self.runs,
            held=self.held,
            seen=self.seen,
            records=tuple(data_set.trials),
            seed=seed,
            rotations=rotations_of(self.problem.nominal, data_set.members),
        )


def searched(
    data_set: DataSet,
    seed: int,
    progress: Watch | None = None,
    held_runs: Index | None = None,
    leaves: float = np.inf,
) -> Searched:
    """Noise, cuts, ranges, wheel phases and effects, all from the trials that are not held out.

    ``held_runs`` are the numbers of the runs to hold out; by default they are drawn.  The runs are searched
    whole first: a slip that only some runs hold looks like an event.  They are cut where something seems to
    have happened once that what is found does not explain.  The search ends where its first
    effect leaves a chi above ``leaves``.
    """
    progress = progress or Watch(report=no_progress)
    progress("reading the noise", 0.0)
    count = len(data_set.trials)
    if held_runs is None:
        held_runs = held_runs_of(data_set, seed)
    seen_runs = searched_runs(count, held_runs)
    if data_set.sigma is None:
        data_set = replace(data_set, sigma=white_noise(tuple(data_set.trials[i] for i in seen_runs)))
    uncut = problem_of(data_set)
    found = _searched(data_set, uncut, (), held_runs, seed, progress, leaves)
    if found.state.chi > leaves:
        return found
    events = events_of(
        uncut.with_wheel_phases(found.problem.wheel_phases), found.state.fit.effects, seen_runs
    )
    looked = found.rounds[0].before.fit.trials if found.rounds else found.seen
    if events and _spared(found, looked, events):
        found = _cut(found, data_set, events)
    elif events:
        found = _searched(data_set, uncut, events, held_runs, seed, progress, leaves)
    return found


def _spared(found: Searched, trials: Index, events: tuple[Event, ...]) -> bool:
    """Whether none of these trials holds one of the events."""
    return {e.trial for e in events}.isdisjoint(found.problem.trials[i].name for i in trials)


def _cut(found: Searched, data_set: DataSet, events: tuple[Event, ...]) -> Searched:
    """The same rounds, and what they found fitted to the runs cut at events that no round has looked at.

    What only a run that is held out did once changes nothing of what was found.
    """
    problem, runs = _apart(data_set, events)
    phases = found.problem.wheel_phases[list(runs)]
    if wheel_phase.is_unknown(problem):  # a log of speeds counts from the angle at which it begins
        starts = [(data_set.trials[r], float(t.t_s[0])) for r, t in zip(runs, problem.trials, strict=True)]
        phases = phases + [wheel_phase.turned_before(*start, problem.commanded) for start in starts]
    problem = replace(problem, rtol=found.problem.rtol).with_wheel_phases(phases).with_rough()
    held, seen = (np.flatnonzero(np.isin(runs, part)) for part in (found.held, found.seen))
    last, own = found.state, [runs[i] for i in seen]
    if _spared(found, found.seen, events) and len(last.fit.trials) == len(seen):
        state = last.moved(problem, runs)
    else:
        view = problem.as_seen_in(last.view, runs)
        state = needed(fitted(view, last.structure, last.fit.x, seen, own), own)
    return replace(
        found,
        problem=problem,
        runs=runs,
        held=held,
        seen=seen,
        state=state,
        rounds=[step.moved(problem, runs) for step in found.rounds],
    )


def _apart(data_set: DataSet, events: tuple[Event, ...]) -> tuple[Problem, tuple[int, ...]]:
    """The runs cut at events, and of each part the number of its run."""
    records, runs = cut_apart(data_set.trials, events)
    return problem_of(data_set, records, runs), runs


def _searched(
    data_set: DataSet,
    uncut: Problem,
    events: tuple[Event, ...],
    held_runs: Index,
    seed: int,
    progress: Watch,
    leaves: float,
) -> Searched:
    """What a search finds in the runs, cut at these events."""
    problem, count = uncut, len(data_set.trials)
    seen_runs = searched_runs(count, held_runs)
    runs: tuple[int, ...] = tuple(range(count))
    if events:
        problem, runs = _apart(data_set, events)
    held = np.flatnonzero(np.isin(runs, held_runs))
    seen = np.flatnonzero(np.isin(runs, seen_runs))
    known = tuple(effect.name for effect in data_set.recipe.effects)
    model, commanded = problem.model(()), problem.commanded
    covered = ranges(tuple(problem.trials[i] for i in seen))
    reach = covered.covered | {"body": model.geometry.reach_m}
    timed = data_set.nominal_rate_Hz is None
    angles = not commanded and not wheel_phase.is_unknown(problem)
    candidates = in_groups(
        [
            *named_candidates(
                model.geometry.names,
                commanded,
                known,
                reach,
                timed=timed,
                angles=angles,
                coupled=model.grip.coupled_part == 1.0,
            ),
            *general_candidates(model, covered, commanded),
        ],
        data_set.members,
    )
    progress("comparing the residual with measured variables", 0.0)
    problem, state, rounds = search(
        problem, seen, [runs[i] for i in seen], candidates, seed, progress, leaves
    )
    state = redefined(state, [runs[i] for i in state.fit.trials], progress)
    return Searched(
        problem=problem,
        uncut=uncut,
        runs=runs,
        held=held,
        seen=seen,
        seen_runs=seen_runs,
        candidates=candidates,
        state=state,
        rounds=rounds,
    )


def events_of(problem: Problem, effects: tuple[AnyEffect, ...], ordinary: Index) -> tuple[Event, ...]:
    """What happened once, beside these effects; the runs ``ordinary`` say what is usual."""
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    predicted, plain = problem.predict([effects, ()], [everyone, everyone])
    return find_events(problem, predicted, plain, ordinary)
