"""From what the search proposes to what may be claimed: the largest structure that unseen runs bear out.

Every proposal is first judged on the searched runs, each predicted without its own fold; only what holds
there is put to the runs that nothing has seen.  Where a proposal fails, the other forms of its last effect,
and the names that its round cannot tell from it, are asked before it is dropped.  If nothing is left, the
best single candidates of other kinds are asked, then what the search finds beside the best of them, and if
these fail too, nothing is found.  From a structure that holds and that the search has not stood at, the
search goes on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from slipmargin.diagnosis import wheel_phase
from slipmargin.diagnosis.all_runs import in_all_runs
from slipmargin.diagnosis.court import Checked, Court, better, put
from slipmargin.diagnosis.fit import evaluate, spans
from slipmargin.diagnosis.held_out import by_run
from slipmargin.diagnosis.mounted import turned_cameras
from slipmargin.diagnosis.refits import fitted, longer, needed, without
from slipmargin.diagnosis.restated import exchanged, reformed, restated, unstuck
from slipmargin.diagnosis.result import Rejected
from slipmargin.diagnosis.rounds import Round, candidates_of
from slipmargin.diagnosis.search import take_step
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, worthwhile
from slipmargin.diagnosis.verdict import near_noise
from slipmargin.diagnosis.watch import Watch


def check(court: Court, proposed: State, rounds: list[Round], progress: Watch) -> Checked:
    """The largest part of what was proposed that the runs bear out, or another candidate, or nothing."""
    rejected: list[Rejected] = []
    for number, state in enumerate(_in_turn(court, proposed, rounds, progress)):
        progress("predicting runs with parameters fitted to others", min(0.9, 0.2 * number))
        found = put(court, state, rejected)
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


def _in_turn(court: Court, proposed: State, rounds: list[Round], progress: Watch) -> Iterator[State]:
    """What was proposed, less its last effect, less its last two …; then the best of other kinds.

    In the end, what the search finds beside those.
    """
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
            break
        passed_over = taken is not None and other.named and other.chi < taken.chi
        kind = other.last.thing if passed_over else (other.last.trace, other.last.named)
        if len(other.structure) == 1 and kind not in asked and other.chi < rounds[0].before.chi:
            asked.add(kind)
            left -= 1
            yield _fitted_to_seen(court, other)
    yield from _beside_others(court, rounds, progress)


def _beside_others(court: Court, rounds: list[Round], progress: Watch) -> Iterator[State]:
    """What the search finds beside a first effect of another variable than the one it went on from.

    Which of several that take off much is meant may show only beside a second one.
    """
    for other in rounds[0].of_other_variables():
        if progress.expired:
            return
        own = [court.runs[i] for i in other.fit.trials]
        start = longer(court.problem, other, own)
        if not worthwhile(start, SETTINGS.floor_chi):
            continue
        beside = progress.staged(f"beside {other.last.label}")
        step = take_step(start, own, candidates_of(rounds), court.seed, beside)
        if step.taken and step.best is not None:
            yield _fitted_to_seen(court, longer(court.problem, step.best, own))


def _fitted_to_seen(court: Court, found: State) -> State:
    """What was fitted to the trials searched, fitted to all trials that are not held out."""
    view, x = found.view, found.fit.x
    if found.last.wheel_phase and wheel_phase.is_unknown(view):  # guessed for the searched runs alone
        view, near = wheel_phase.refined(view, evaluate(view, found.structure, x, court.seen))
        x = near.x
    return fitted(view, found.structure, x, court.seen, court.seen_runs)


def _other_forms(court: Court, state: State, fewer: State, rounds: list[Round]) -> Iterator[State]:
    """The state with its last effect in other forms, where these are worth having at all, best first.

    ``fewer`` is the state without this effect.
    """
    forms = [c for c in candidates_of(rounds) if c.is_other_form_of(state.last)]
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
        best = start = reformed(start, own, candidates_of(rounds), rounds, progress, simpler=True)
        is_new = _place(start) not in stood and worthwhile(start, SETTINGS.floor_chi)
        if is_new:
            step = take_step(start, own, candidates_of(rounds), court.seed, progress.staged("going on"))
            rounds.append(step)
            best = step.best if step.taken and step.best is not None else start
        found = None
        if best.structure != state.structure:
            best = longer(court.problem, best, own)
            more = unstuck(_fitted_to_seen(court, best), court.seen_runs, candidates_of(rounds), progress)
            fresh = more.last if more.last.named else None
            more = needed(more, court.seen_runs, fresh=fresh)
            found = better(court, held, more, rejected)
        if found is not None:
            held = found
        elif not is_new or start.view.piece is None:
            break
        else:
            least_s = 2.0 * start.view.piece_s
    held = turned_cameras(court, held, rejected)
    return replace(in_all_runs(court, held, rounds, rejected, progress), rejected=tuple(rejected))
