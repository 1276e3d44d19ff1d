"""From what the search proposes to what may be claimed: the largest structure that unseen runs bear out.

Every proposal is first judged on the searched runs, each predicted without its own fold; only what holds
there is put to the runs that nothing has seen.  Where a proposal fails, the other forms of its last effect,
and the names that its round cannot tell from it, are asked before it is dropped.  If nothing is left, the
best single candidates of other kinds are asked, and if these fail too, nothing is found.  From a structure
that holds and that the search has not stood at, the search goes on.

Far above the noise runs are judged in pieces, as the search compares them; what is reported are the errors of
whole runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Index
from slipmargin.data.record import Record
from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.finalists import other_names
from slipmargin.diagnosis.findings import doubted
from slipmargin.diagnosis.fit import evaluate, spans
from slipmargin.diagnosis.held_out import (
    Prediction,
    by_run,
    phases_matter,
    predicted,
    score,
    sets_of_effects,
)
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import fitted, longer, needed, nothing_sure, without
from slipmargin.diagnosis.restated import exchanged, redefined, reformed, restated, simplified, unstuck
from slipmargin.diagnosis.result import Rejected, Score, Verdict
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.search import take_step
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.signals import InterpolationScheme
from slipmargin.diagnosis.state import State, worthwhile
from slipmargin.diagnosis.verdict import Judgement, RunErrors, explained_share, judge, judged, near_noise
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import AnyEffect


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Checked:
    """The structure that holds (None: none does), errors (a row each run) before and after, and the rest.

    ``problem`` has the wheel phases with which the runs were judged; ``judgement`` is that of ``state``;
    ``near_noise``: the model as it is leaves no more than noise.
    """

    state: State | None
    before: RunErrors
    after: RunErrors
    judgement: Judgement | None
    problem: Problem
    phased: bool
    rejected: tuple[Rejected, ...]
    near_noise: bool = False

    @property
    def verdict(self) -> Verdict:
        """Found, nothing missing (errors near the noise), or unexplained."""
        if self.state is not None:
            return Verdict.EFFECT_FOUND
        return Verdict.NO_MISSING_EFFECT if self.near_noise else Verdict.UNEXPLAINED


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Court:
    """The runs before which structures are judged.

    ``runs`` (R,) is the run each trial is, or is cut from; ``held`` are the trials that the search has not
    seen, ``seen`` the others; ``records`` are the uncut runs.
    """

    problem: Problem
    runs: tuple[int, ...]
    held: Index
    seen: Index
    records: tuple[Record, ...]
    seed: int

    @property
    def unseen(self) -> NDArray[np.bool_]:
        """Which runs (in order) the search has not seen."""
        return np.isin(np.unique(self.runs), [self.runs[i] for i in self.held])

    @property
    def seen_runs(self) -> list[int]:
        """The run of each trial that the search has seen."""
        return [self.runs[i] for i in self.seen]

    def errors(
        self, state: State | None, *, in_pieces: bool = False, like: State | None = None
    ) -> Prediction:
        """Errors of every trial, predicted with parameters that were fitted to others; whole or in pieces.

        Without a state no effect acts.  They are scored as those of ``like`` are, by default as their own.
        """
        count = len(self.problem.trials)
        effects: list[tuple[AnyEffect, ...]] = [() if state is None else state.fit.effects] * count
        if state is not None:
            for part, own in zip(state.parts, sets_of_effects(state.structure, state.xs), strict=True):
                for i in state.fit.trials[part]:
                    effects[i] = own
        like = like or state
        phased = phases_matter(self.problem, () if like is None else like.fit.effects)
        full = self.problem.rebuilt(InterpolationScheme.FULL)
        if in_pieces and like is not None:
            full = full.as_seen_in(like.view)
        records = [self.records[run] for run in self.runs]
        return predicted(full, np.arange(count, dtype=np.int64), records, effects, phased)

    def verdict(self, before: RunErrors, after: RunErrors) -> Judgement:
        """The judgement by the searched runs if these already speak against it, else by all."""
        unseen, sigma = self.unseen, self.problem.sigma
        if unseen.any() and not unseen.all():
            rows = np.flatnonzero(~unseen)
            none = np.zeros(len(rows), dtype=bool)
            some = before.of(rows), after.of(rows)
            early = judge(*some, none, self.seed, by_chance=False, numbers=rows, sigma=sigma)
            if not early.holds:
                return early
        return judge(before, after, unseen, self.seed, sigma=sigma)


def check(court: Court, proposed: State, rounds: list[Round], progress: Watch) -> Checked:
    """The largest part of what was proposed that the runs bear out, or another candidate, or nothing."""
    rejected: list[Rejected] = []
    for number, state in enumerate(_in_turn(court, proposed, rounds, progress)):
        progress("predicting runs with parameters fitted to others", min(0.9, 0.2 * number))
        found = _put(court, state, rejected)
        if found is not None and not _needless(court, found, rejected):
            return _further(court, found, rounds, rejected, progress)
    plain = court.errors(None)
    errors = by_run(plain.errors, court.runs)
    return Checked(
        state=None,
        before=errors,
        after=errors,
        judgement=None,
        problem=plain.problem,
        phased=plain.phased,
        rejected=tuple(rejected),
        near_noise=near_noise(errors, court.unseen, plain.problem.sigma),
    )


def _put(court: Court, state: State, rejected: list[Rejected]) -> Checked | None:
    labels = tuple(c.label for c in state.structure)
    after = court.errors(state)
    before = court.errors(None, like=state)
    one, two = by_run(before.errors, court.runs), by_run(after.errors, court.runs)
    fresh = judged(court.unseen)
    astray = larger(score(one, fresh), score(two, fresh))
    if state.view.piece is None:
        judgement = court.verdict(one, two)
    else:  # a wrong heading early in a whole run outweighs all that is right after it
        pieces = [court.errors(s, like=state, in_pieces=True) for s in (None, state)]
        judgement = court.verdict(*(by_run(p.errors, court.runs) for p in pieces))
    idle = [c.label for c, none in zip(state.structure, nothing_sure(state), strict=True) if none]
    failures = judgement.failures + astray
    failures += tuple(f"the runs leave it open that {label} does nothing" for label in idle)
    if one.chi() <= SETTINGS.noise_chi and doubted(state.view, state.fit):
        failures += ("so near the noise only a name that its own evidence carries is claimed",)
    if failures:
        rejected.append(
            Rejected(
                labels=labels,
                failures=failures,
                chi_before=one.chi(),
                chi_after=two.chi(),
                borne_out=not judgement.failures + astray,
                traced_to=tuple(c.trace for c in state.structure),
                lowers=not astray and explained_share(one.chi(), two.chi()) >= SETTINGS.explained_share,
            )
        )
        return None
    return Checked(
        state=state,
        before=one,
        after=two,
        judgement=judgement,
        problem=after.problem,
        phased=after.phased,
        rejected=tuple(rejected),
    )


def _needless(court: Court, held: Checked, rejected: list[Rejected]) -> bool:
    """Whether runs are predicted no better with the last of several effects than without it."""
    state = held.state
    if state is None or len(state.structure) < 2:
        return False
    fewer = without(state, len(state.structure) - 1, court.seen_runs)
    less = by_run(court.errors(fewer, like=state).errors, court.runs)
    if held.after.chi() < less.chi():
        return False
    said = f"runs are predicted no better with {state.last.label} than without it (chi {less.chi():.3g})"
    rejected.append(
        Rejected(
            labels=tuple(c.label for c in state.structure),
            failures=(said,),
            chi_before=held.before.chi(),
            chi_after=held.after.chi(),
        )
    )
    return True


def larger(before: Score, after: Score) -> tuple[str, ...]:
    """Which errors of whole runs that nothing has seen are larger after, in words.

    A correction with which one of them grows by more than the simulation is accurate is not claimed: what is
    called found makes every error that is reported smaller, or leaves it as it is.
    """
    rows = (
        ("chi", before.chi, after.chi, ""),
        ("the position error", 1e3 * before.rmse_position_m, 1e3 * after.rmse_position_m, " mm"),
        ("the heading error", 1e3 * before.rmse_heading_rad, 1e3 * after.rmse_heading_rad, " mrad"),
    )
    return tuple(
        f"on whole runs that nothing has seen {what} grows from {was:.4g} to {now:.4g}{unit}"
        for what, was, now, unit in rows
        if not now <= (1.0 + SETTINGS.same_error) * was
    )


def _in_turn(court: Court, proposed: State, rounds: list[Round], progress: Watch) -> Iterator[State]:
    """What was proposed, less its last effect, less its last two …; then the best of other kinds."""
    state = proposed
    while state.structure:
        yield state
        fewer = without(state, len(state.structure) - 1, court.seen_runs)
        if not progress.expired:
            yield from _other_forms(court, state, fewer, rounds)
        if not progress.expired:
            yield from _other_names(court, state, fewer, rounds)
        state = fewer
    if not rounds or (not proposed.structure and rounds[0].before.chi <= SETTINGS.noise_chi):
        return
    # A name that fails does not speak against free coefficients over its variable, nor the reverse, nor
    # against a name that left less and was passed over for something simpler.
    asked: set[object] = {(c.trace, c.named) for c in proposed.structure}
    asked |= {c.thing for c in proposed.structure}
    left, taken = SETTINGS.others, rounds[0].best
    for other in rounds[0].tried:
        if not left or progress.expired:
            return
        passed_over = taken is not None and other.named and other.chi < taken.chi
        kind = other.last.thing if passed_over else (other.last.trace, other.last.named)
        if len(other.structure) == 1 and kind not in asked and other.chi < rounds[0].before.chi:
            asked.add(kind)
            left -= 1
            yield _fitted_to_seen(court, other)


def _fitted_to_seen(court: Court, found: State) -> State:
    """What was fitted to the trials searched, fitted to all trials that are not held out."""
    view, x = found.view, found.fit.x
    if found.last.wheel_phase and wheel_phase.is_unknown(view):  # guessed for the searched runs alone
        view, near = wheel_phase.refined(view, evaluate(view, found.structure, x, court.seen))
        x = near.x
    return fitted(view, found.structure, x, court.seen, court.seen_runs)


def _candidates(rounds: list[Round]) -> list[Candidate]:
    """Everything that was screened."""
    return list({c.label: c for r in rounds for e in r.screening.entries for c in e.structure}.values())


def _other_forms(court: Court, state: State, fewer: State, rounds: list[Round]) -> Iterator[State]:
    """The state with its last effect in other forms, where these are worth having at all, best first.

    ``fewer`` is the state without this effect.
    """
    forms = [c for c in _candidates(rounds) if c.is_other_form_of(state.last)]
    found = [restated(state, len(state.structure) - 1, other, court.seen_runs) for other in forms]
    worth = [s for s in found if worthwhile(fewer, s.chi, s.last.named)]
    yield from sorted(worth, key=lambda s: s.chi)


def _other_names(court: Court, state: State, fewer: State, rounds: list[Round]) -> Iterator[State]:
    """The state with another name in the place of its last effect, best first.

    They are the names that the round in which it was found beside those of ``fewer`` cannot tell from it.
    """
    asked, index = {state.last.thing}, len(fewer.structure)
    for step in rounds if index else ():
        own = step.with_alone(state.last)
        if own is None or step.before.things != fewer.things:
            continue
        for rival in step.rivals(own):
            if not rival.named or not step.single(rival) or rival.last.thing in asked:
                continue
            if len(asked) > SETTINGS.others:
                return
            asked.add(rival.last.thing)
            x = rival.fit.x[spans(rival.structure)[-1]]
            yield exchanged(state, index, rival.last, x, court.seen_runs)


def _place(state: State) -> tuple[frozenset[str], int | None]:
    """Where the search stands: the effects it has, and how long the pieces are."""
    return frozenset(c.label for c in state.structure), state.view.piece


def _further(
    court: Court, held: Checked, rounds: list[Round], rejected: list[Rejected], progress: Watch
) -> Checked:
    """What holds, with what the search finds beside it where it has not stood there before.

    That is so where an effect took another form, or was dropped because a later one made it superfluous, or
    where the pieces that showed it are too short to show more: what adds up along a run may be hidden in
    short ones by what changes within them.  Its rounds are added to ``rounds``.
    """
    least_s, begun = 0.0, set[tuple[frozenset[str], int | None]]()
    while rounds and held.state is not None and not progress.expired:
        state, trials = held.state, rounds[0].before.fit.trials
        stood = [_place(r.before) for r in rounds]
        known = state.view.piece is None and _place(state) in stood
        if known or len(state.structure) >= SETTINGS.most_effects:
            break
        own = [court.runs[i] for i in trials]
        start = fitted(state.view, state.structure, state.fit.x, trials, own)
        start = longer(court.problem, start, own, least_s)
        if _place(start) in begun:
            break
        begun.add(_place(start))
        best = start = reformed(start, own, _candidates(rounds), rounds, progress, simpler=True)
        is_new = _place(start) not in stood and worthwhile(start, SETTINGS.floor_chi)
        if is_new:
            step = take_step(start, own, _candidates(rounds), court.seed, progress.staged("going on"))
            rounds.append(step)
            best = step.best if step.taken and step.best is not None else start
        found = None
        if best.structure != state.structure:
            best = longer(court.problem, best, own)
            more = unstuck(_fitted_to_seen(court, best), court.seen_runs, _candidates(rounds), progress)
            fresh = more.last if more.last.named else None
            more = needed(more, court.seen_runs, fresh=fresh)
            found = _better(court, held, more, rejected)
        if found is not None:
            held = found
        elif not is_new or start.view.piece is None:
            break
        else:
            least_s = 2.0 * start.view.piece_s
    return replace(_in_all_runs(court, held, rounds, rejected, progress), rejected=tuple(rejected))


def _in_all_runs(
    court: Court, held: Checked, rounds: list[Round], rejected: list[Rejected], progress: Watch
) -> Checked:
    """What holds, with names that show in all runs and not in the few that were searched.

    It is asked where much is left.  Simulating all runs takes long: beside each effect in its simplest form
    that is as good, every name is put on a list, whose first is fitted, and those that stand next on another.
    """
    runs, candidates = court.seen_runs, _candidates(rounds)
    names = [c for c in candidates if c.named]
    in_few = bool(rounds) and len(rounds[0].before.fit.trials) < len(court.seen)
    while in_few and held.state is not None and held.after.chi() > SETTINGS.noise_chi:
        if progress.expired or len(held.state.structure) >= SETTINGS.most_effects:
            break
        start = simplified(longer(court.problem, held.state, runs, np.inf), runs, candidates, progress)
        start = redefined(start, runs, progress)
        step = take_step(start, runs, names, court.seed, progress.staged("in all runs"), 1)
        rounds.append(replace(step, names_only=True))
        best = step.best if step.taken and step.best is not None else start
        if best.structure == held.state.structure:
            break
        found = _better(court, held, unstuck(best, runs, candidates, progress), rejected)
        held = found or held
        if found is None or not step.taken:
            break
        names = [e.structure[0] for e in other_names(step.screening, (), SETTINGS.contenders)]
    return held


def _better(court: Court, held: Checked, proposed: State, rejected: list[Rejected]) -> Checked | None:
    """A proposal that the runs bear out, if it predicts them better than what holds."""
    found = _put(court, proposed, rejected)
    return found if found is not None and found.after.chi() < held.after.chi() else None
