"""What holds, asked again in all runs: the search itself looks at few of them.

Where much is left, names that show in all runs only, forms of what is known, and faults of single instruments
of a campaign are put before the runs in turn.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.court import Checked, Court, better
from slipmargin.diagnosis.finalists import other_names
from slipmargin.diagnosis.groups import scope_of
from slipmargin.diagnosis.refits import longer, refitted
from slipmargin.diagnosis.restated import in_best_forms, redefined, simplified, unstuck
from slipmargin.diagnosis.result import Rejected
from slipmargin.diagnosis.rounds import Round, candidates_of
from slipmargin.diagnosis.search import screened, take_step
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good, explained
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import Scope
from slipmargin.effects.confined import Confined, bare


def in_all_runs(
    court: Court, held: Checked, rounds: list[Round], rejected: list[Rejected], progress: Watch
) -> Checked:
    """What holds, with what shows in all runs and not in the few that were searched.

    It is asked where much is left.
    """
    if not rounds or len(rounds[0].before.fit.trials) >= len(court.seen):
        return held
    candidates = candidates_of(rounds)
    held = _with_names(court, held, rounds, rejected, progress)
    for ask in (_formed, _calibrated):
        if held.state is None or held.after.chi() <= SETTINGS.noise_chi or progress.expired:
            break
        start = longer(court.problem, held.state, court.seen_runs, np.inf)
        found = ask(court, start, candidates, progress)
        if found is not start:
            held = better(court, held, found, rejected) or held
    return held


def _with_names(
    court: Court, held: Checked, rounds: list[Round], rejected: list[Rejected], progress: Watch
) -> Checked:
    """What holds, with more names.

    Simulating all runs takes long: beside each effect in its simplest form that is as good, every name is put
    on a list, whose first is fitted, and those that stand next on another.
    """
    runs, candidates = court.seen_runs, candidates_of(rounds)
    names = [c for c in candidates if c.named]
    while held.state is not None and held.after.chi() > SETTINGS.noise_chi:
        if progress.expired or len(held.state.structure) >= SETTINGS.most_effects:
            break
        start = simplified(longer(court.problem, held.state, runs, np.inf), runs, candidates, progress)
        start = redefined(start, runs, progress)
        step = take_step(start, runs, names, court.seed, progress.staged("in all runs"), 1)
        rounds.append(replace(step, names_only=True))
        best = step.best if step.taken and step.best is not None else start
        if best.structure == held.state.structure:
            break
        found = better(court, held, unstuck(best, runs, candidates, progress), rejected)
        held = found or held
        if found is None or not step.taken:
            break
        names = [e.structure[0] for e in other_names(step.screening, (), SETTINGS.contenders)]
    return held


def _formed(court: Court, state: State, candidates: list[Candidate], progress: Watch) -> State:
    """The state with each effect in the form that all runs prefer: few runs do not tell forms apart."""
    return in_best_forms(state, court.seen_runs, candidates, progress)


def _calibrated(court: Court, state: State, candidates: list[Candidate], progress: Watch) -> State:
    """The state with what single instruments of a campaign do, as far as runs left out show it.

    A law is added to a robot where it takes off a share of the error.  That a camera was turned between two
    recordings says nothing of the robot, and is worth knowing however small it is: luck and the spread of the
    runs decide.  What all instruments seem to do alike is something else that is missing.
    """
    runs = court.seen_runs
    apart = [c for c in candidates if c.named and _of_one_instrument(c)]
    while apart and len(state.structure) < SETTINGS.most_effects and not progress.expired:
        screening = screened(state, runs, apart, court.seed, progress)
        single = (e for e in screening.entries if e.stands_alone)
        entry = max(single, key=lambda e: e.gain, default=None)
        if entry is None or entry.gain <= 0.0:
            break
        progress(f"fitting {entry.label}", 0.0)
        found, shared = (_with(state, c, runs) for c in (*entry.structure, _in_all(*entry.structure)))
        by_chance = screening.p_value(explained(state, found)) > SETTINGS.significance
        if not np.isfinite(found.chi) or by_chance or as_good(state, found) or as_good(shared, found):
            break
        state = found
    return state


def _with(state: State, candidate: Candidate, runs: list[int]) -> State:
    x = np.concatenate([state.fit.x, candidate.starts[0]])
    return refitted(state, (*state.structure, candidate), x, runs)


def _in_all(candidate: Candidate) -> Candidate:
    """The candidate in all instruments alike."""
    return replace(candidate, build=lambda x: bare(candidate.build(x)))


def _of_one_instrument(candidate: Candidate) -> bool:
    """Whether it is a fault of one of several instruments."""
    apart = isinstance(candidate.build(candidate.starts[0]), Confined)
    return apart and scope_of(candidate) is Scope.INSTRUMENT
