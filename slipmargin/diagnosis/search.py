"""The search: forward stepwise over one list of candidates, named and general, each step in one view.

A step screens the whole list by tangents (:mod:`~slipmargin.diagnosis.screen`), fits the few best by
simulation, and compares them by one score: the squared residual of runs that were left out of a refit, a
fold at a time.  The screening as a whole is tested against surrogate noise.  A named effect is preferred to
a general form where its left-out error is as good within the spread of the runs; what cannot be told apart
from the best is kept as its rivals.  In the end every effect that the others make superfluous is dropped.
Far above the noise runs are compared in pieces: an error early in a run must not outweigh what comes later.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Index
from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.bends import bends
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.crossings import at_crossings
from slipmargin.diagnosis.finalists import finalists, of_other_variables, other_names, pointed_at
from slipmargin.diagnosis.fit import build, evaluate, few_steps
from slipmargin.diagnosis.left_out import folds
from slipmargin.diagnosis.patches import at_patches
from slipmargin.diagnosis.probes import probes
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.promise import after_steps, as_simulated
from slipmargin.diagnosis.refits import evened, fitted, longest_piece_s, needed, refitted, scored, whole
from slipmargin.diagnosis.restated import reformed, unstuck
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.screen import Screened, Screening, screen
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good, choose, explained, quiet, worthwhile
from slipmargin.diagnosis.telling import enough, telling
from slipmargin.diagnosis.tolerance import eased, fitted_finely
from slipmargin.diagnosis.watch import Watch


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Standing:
    """Where a search stands after a round: what that added, and the state in the view of the next one.

    ``ahead`` is the next round, where it was looked at already and took something.
    """

    best: State
    problem: Problem
    state: State
    ahead: Round | None = None


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sought:
    """What all steps of one search share.

    ``trials`` of those ``seen`` are searched; ``runs`` says which run each of them is, or is cut from.  The
    watch ``progress`` says when the time is over.
    """

    seen: Index
    trials: Index
    runs: Sequence[int]
    candidates: list[Candidate]
    seed: int
    progress: Watch

    def as_it_is(self, problem: Problem) -> tuple[Problem, State]:
        """The model as it is, in the view from which the first step starts."""
        unknown = wheel_phase.is_unknown(problem)
        needs_phases = unknown and wheel_phase.matters_to(problem.model(()))
        if needs_phases:
            self.progress("estimating wheel phases", 0.0)
            problem = wheel_phase.guessed(problem, self.seen, self.candidates)
        state = fitted(problem, (), np.zeros(0), self.trials, self.runs)
        if unknown and not needs_phases and not quiet(state):
            self.progress("estimating wheel phases", 0.0)
            problem = wheel_phase.guessed(problem, self.trials, self.candidates)
            state = fitted(problem, (), np.zeros(0), self.trials, self.runs)
        state = evened(state, self.seen, self.runs)
        if state.chi > SETTINGS.far_chi and bends(problem, self.trials, state.fit.effects):
            state = evened(_in_pieces(problem, self.trials, self.runs), self.seen, self.runs)
        return problem, state

    def step(self, before: State, stage: str, *, names_only: bool = False) -> Round:
        """A round that starts from ``before``, over all candidates or over the names among them."""
        asked = [c for c in self.candidates if c.named or not names_only]
        step = take_step(before, self.runs, asked, self.seed, self.progress.staged(stage))
        return replace(step, names_only=names_only)

    def entered(self, problem: Problem, best: State, rounds: Sequence[Round]) -> Standing:
        """Where the next round starts from what one found, with the wheel phases it needs."""
        state = whole(problem, best, self.runs, lambda: self.progress.expired)
        if self.progress.expired:
            return Standing(best=best, problem=problem, state=state)
        state = evened(state, self.seen, self.runs)
        state = reformed(state, self.runs, self.candidates, rounds, self.progress)
        if wheel_phase.is_unknown(problem) and any(c.wheel_phase for c in state.structure):
            at = evaluate(problem, state.structure, state.fit.x, self.seen)
            problem, better = wheel_phase.refined(problem, at)
            view = problem.as_seen_in(state.view)
            state = fitted(view, state.structure, better.x, state.fit.trials, self.runs)
        return Standing(best=best, problem=problem, state=state)

    def followed(self, step: Round, tried: Sequence[Standing]) -> tuple[Standing, list[Round]]:
        """Of additions that a round can hardly tell apart, the one beside which the next round finds most.

        Far above the noise an effect shows only beside another one, as load that shifts with the acceleration
        does beside the loads at rest.  Each is followed by a round of its own over the names; the first is
        kept unless another, which that does not make superfluous, leaves less.  Where two were added at once,
        what was found beside the one of them that is tried alone compares the other with every name: such
        rounds are returned as well.
        """
        found: list[tuple[State, Standing]] = []
        beside: list[Round] = []
        for number, stands in enumerate(tried):
            if number and self.progress.expired:
                break
            level, ahead = stands.best, None
            # Beside a form names are hardly ever taken.
            if level.named and worthwhile(stands.state, SETTINGS.floor_chi):
                ahead = self.step(stands.state, f"beside {level.last.label}", names_only=True)
                beside.append(ahead)
                ahead = ahead if ahead.taken else None
            if ahead is not None and ahead.best is not None:
                structure, x = ahead.best.structure, ahead.best.fit.x
                level = needed(refitted(step.before, structure, x, self.runs), self.runs)
            if not number or stands.best.last in level.structure:
                found.append((level, replace(stands, ahead=ahead)))
        least = min(found, key=lambda f: f[0].chi)
        kept = (found[0] if as_good(found[0][0], least[0]) else least)[1]
        parts = [replace(r, taken=False) for r in beside if r.before.things < kept.best.things]
        return kept, parts


def search(
    problem: Problem,
    seen: Index,
    runs: Sequence[int],
    candidates: list[Candidate],
    seed: int,
    progress: Watch,
    leaves: float = np.inf,
) -> tuple[Problem, State, list[Round]]:
    """What the model lacks, judged on the trials ``seen``, and the rounds in which it was found.

    The problem comes back as well: wheel phases that were not logged are guessed on the way, for ``seen`` or,
    where the model does not need them, for the trials searched.  ``runs``: which run each is, or is cut from.
    Where the first effect leaves a chi above ``leaves``, it is not taken.
    """
    problem = problem.with_rough()
    trials = enough(seen, problem.knots, telling(problem, seen))
    problem = eased(problem, trials)
    sought = Sought(
        seen=seen,
        trials=trials,
        runs=[runs[i] for i in np.searchsorted(seen, trials)],
        candidates=candidates,
        seed=seed,
        progress=progress,
    )
    problem, state = sought.as_it_is(problem)
    rounds: list[Round] = []
    ahead: Round | None = None
    for number in range(SETTINGS.most_effects):
        if quiet(state) if not number else progress.expired or not worthwhile(state, SETTINGS.floor_chi):
            break  # the first list is made in any case: without it there is no answer, not even a lead
        if number and len(set(sought.runs)) < 2:
            break  # one run leads to a variable, and bears out nothing
        step = ahead or sought.step(state, f"round {number + 1}")
        rounds.append(step)
        if not step.taken or step.best is None or (not number and step.best.chi > leaves):
            break
        stands = sought.entered(problem, step.best, rounds)
        others = step.others() if stands.state.view.piece is not None else step.part_alone()
        if others and len(stands.state.structure) < SETTINGS.most_effects:
            tried = [stands, *(sought.entered(stands.problem, s, rounds) for s in others)]
            stands, beside = sought.followed(step, tried)
            rounds[-1:] = [replace(step, best=stands.best), *beside]
        problem, state, ahead = stands.problem, stands.state, stands.ahead
        if len(state.structure) >= SETTINGS.most_effects:
            break
    if state.structure and len(trials) < len(seen):
        progress("fitting all trials that are not held out", 0.0)
        state = _in_all(state, rounds, seen, runs, lambda: progress.expired)
        state = unstuck(state, runs, candidates, progress)
    fitted_to = runs if len(state.fit.trials) == len(seen) else sought.runs
    return problem, needed(state, fitted_to), rounds


def _in_all(
    state: State, rounds: Sequence[Round], seen: Index, runs: Sequence[int], expired: Callable[[], bool]
) -> State:
    """What was found fitted to all trials ``seen``, and the names that its round could not tell from it.

    More runs tell more of them apart.  Where what was found is stuck at a bound there, it stands for
    something else, and all such names are asked; else those that have no more parameters.
    """
    found = [fitted(state.view, state.structure, state.fit.x, seen, runs, expired)]
    stuck, size = found[0].fit.stuck, len(state.fit.x)
    rivals = [s for r in rounds if r.best is not None and _alike(r.best, state) for s in r.rivals()]
    sound = [s for s in rivals if s.named and not s.fit.stuck and (stuck or len(s.fit.x) <= size)]
    others: dict[frozenset[str], State] = {}
    for rival in sound:
        if rival.things != state.things:
            others.setdefault(frozenset(rival.things), rival)
    for rival in sound if stuck else list(others.values())[: SETTINGS.followed]:
        if not expired():
            found.append(fitted(state.view, rival.structure, rival.fit.x, seen, runs, expired))
    return choose(sorted(found, key=lambda s: s.chi))


def _alike(one: State, other: State) -> bool:
    return [c.label for c in one.structure] == [c.label for c in other.structure]


def screened(
    before: State, runs: Sequence[int], candidates: list[Candidate], seed: int, progress: Watch
) -> Screening:
    """The list of what may be added to ``before``, by tangents alone."""
    inside = {c.label for c in before.structure}
    fresh = [c for c in candidates if c.label not in inside and possible(before, c)]
    block = max(1, round(SETTINGS.piece_s / before.view.step_s))
    parts = folds(runs, SETTINGS.folds)
    beside = probes(before.view, before.fit)
    return screen(before.view, before.fit, fresh, beside, parts, block, seed, lambda: progress.overdue)


def take_step(
    before: State,
    runs: Sequence[int],
    candidates: list[Candidate],
    seed: int,
    progress: Watch,
    many: int = SETTINGS.finalists,
) -> Round:
    """The best addition to ``before``, and whether it is significant and worth its parameters.

    ``many`` names of the list are fitted, half as many general forms and as many pairs; where no name leaves
    nothing but noise, those names that a few steps show to be better than the list says, and forms over
    other variables.
    """
    progress("screening every candidate", 0.0)
    base = before.fit
    screening = screened(before, runs, candidates, seed, progress)
    nothing = Round(before=before, screening=screening, tried=(), best=None, taken=False)
    share = max((e.gain for e in screening.entries), default=0.0) / base.cost
    # Beside a form more is asked for than what tangents of friction that sticks promise.
    most = share if before.named else share / SETTINGS.tangents_promise
    promised = float(np.sqrt(max(0.0, 1.0 - most)))
    worth = worthwhile(before, promised * before.chi) and screening.p_value(share) <= SETTINGS.level
    if not worth and (before.structure or before.chi <= SETTINGS.noise_chi):
        return nothing

    def overdue() -> bool:
        return progress.overdue

    screening, spots = as_simulated(before, screening, overdue), list[Screened]()
    if not before.structure:
        spots = [*at_crossings(before, screening, overdue), *at_patches(before, screening, overdue)]
    screening = screening.with_better(spots)
    room = max(1, SETTINGS.most_effects - len(before.structure))
    chosen = [e for e in finalists(screening, many) if len(e.structure) <= room]
    fewest = 1 if before.structure else SETTINGS.fewest_fitted
    tried = _fitted_in_turn(before, chosen, (), runs, progress, fewest)
    if not tried:
        return nothing
    best = choose(tried, before)
    # A second effect is not sought so far down: forms are hardly ever taken beside the first, and a name that
    # explains part of what is left is followed by a round of its own.
    if not before.structure and (not best.named or worthwhile(best, SETTINGS.floor_chi)):
        progress("a few steps of other names", 0.2)
        pointed = pointed_at(screening, spots)
        others = [*pointed, *other_names(screening, [*chosen, *spots, *pointed], SETTINGS.contenders)]
        names = after_steps(before, [*spots, *others], lambda: progress.expired)[:many]
        forms = of_other_variables(screening, chosen, many)
        tried = _fitted_in_turn(before, [*names, *forms], tried, runs, progress)
        best = choose(tried, before)
    named = [s for s in tried if s.named]  # far above the noise a form takes up much that no name does
    if named and before.view.piece is not None and not worthwhile(before, best.chi, named=best.last.named):
        best = choose(named, before)
    return Round(
        before=before,
        screening=screening,
        tried=tuple(tried),
        best=best,
        taken=worthwhile(before, best.chi, named=best.last.named)
        and screening.p_value(explained(before, best)) <= SETTINGS.significance,
    )


def _fitted_in_turn(
    before: State,
    entries: Sequence[Screened],
    known: Sequence[State],
    runs: Sequence[int],
    progress: Watch,
    fewest: int = 1,
) -> list[State]:
    """What is ``known``, and each entry of the list fitted beside what stands already, best first.

    Even if the time is over, ``fewest`` variables are tried.
    """
    tried = list(known)
    for number, entry in enumerate(entries):
        traces = {s.last.trace for s in tried}
        if progress.expired and (len(traces) >= fewest or entry.parts[-1].trace in traces):
            continue
        progress(f"fitting {entry.label}", 0.2 + 0.8 * number / len(entries))
        least = min((s.fit.cost for s in tried), default=np.inf)
        tried.append(_added(before, entry, runs, least, lambda: progress.expired))
    return sorted(tried, key=lambda s: s.chi)


def _added(
    before: State, entry: Screened, runs: Sequence[int], best: float, expired: Callable[[], bool]
) -> State:
    """An entry of the list, fitted beside what is known; not to the end where it cannot be the best."""
    structure, trials = (*before.structure, *entry.structure), before.fit.trials
    plain = np.concatenate([c.candidate.starts[0] for c in entry.parts if c.candidate is not None])
    starts = [np.concatenate([before.fit.x, x]) for x in (*entry.starts, plain)]
    found = before.view.residuals([build(structure, x) for x in starts], [trials] * len(starts))
    order = np.argsort([np.sum(r**2) for r in found], kind="stable")
    x = starts[order[0]]
    if len(entry.starts) > 1:  # places and times: what is near one of them has its own optimum
        # As simulated, a start that does nothing may beat all others: that by tangents is tried in any case.
        tried = [0, *(i for i in order.tolist() if i)][: SETTINGS.starts]
        short = [
            few_steps(before.view, structure, starts[i], trials, expired)
            for i in (tried[:1] if expired() else tried)
        ]
        x = min(short, key=lambda end: end[1])[0]
    view, full = fitted_finely(before.view, structure, x, trials, expired, SETTINGS.out_of_reach * best)
    return scored(view, full, before.samples, runs)


def _in_pieces(problem: Problem, trials: Index, runs: Sequence[int]) -> State:
    """The model as it is, in the shortest pieces in which what it lacks is well above the noise."""
    piece_s = SETTINGS.piece_s
    while True:
        state = fitted(problem.in_pieces(piece_s), (), np.zeros(0), trials, runs)
        if state.chi >= SETTINGS.far_chi or 2.0 * piece_s > longest_piece_s(problem, trials):
            return state
        piece_s *= 2.0


def possible(before: State, candidate: Candidate) -> bool:
    """Whether the candidate can stand beside what is known: two laws for one thing refuse each other."""
    return before.view.possible((*before.fit.effects, candidate.build(candidate.starts[0]))) is not None
