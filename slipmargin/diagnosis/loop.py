"""The diagnosis: compare model and measurement, try every candidate, add what is missing, compare again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.attempt import Attempt
from slipmargin.diagnosis.campaign import shown_in
from slipmargin.diagnosis.conditions import ready
from slipmargin.diagnosis.court import Checked
from slipmargin.diagnosis.findings import findings
from slipmargin.diagnosis.fit import Fit, fit
from slipmargin.diagnosis.held_out import score
from slipmargin.diagnosis.leads import leads
from slipmargin.diagnosis.left_over import left_over, like
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.order_analysis import Periodicity, order_analysis
from slipmargin.diagnosis.ranges import variables_of
from slipmargin.diagnosis.refits import without
from slipmargin.diagnosis.remarks import (
    of_noise,
    of_one_run,
    of_pieces,
    of_small_shares,
    of_the_clock,
    of_the_draw,
    of_the_fit,
)
from slipmargin.diagnosis.residual_diagnostics import dependences
from slipmargin.diagnosis.result import (
    Diagnosis,
    Event,
    Finding,
    Step,
    TrialTrajectories,
    Tried,
    Verdict,
)
from slipmargin.diagnosis.rivals import cannot_be_told
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.run_order import drift_in
from slipmargin.diagnosis.searched import Searched, events_of
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.signals import InterpolationScheme
from slipmargin.diagnosis.verdict import judged
from slipmargin.diagnosis.watch import Progress, Watch, cut_short, no_progress
from slipmargin.effects.confined import acting
from slipmargin.sim.threads import linear_algebra_alone

#: Steps of the last fit, which starts where the search ended.
_FINAL_STEPS = 6
_FINE_STEPS = 2


def diagnose(
    data_set: DataSet,
    *,
    seed: int = 0,
    progress: Progress = no_progress,
    repairs: tuple[Repair, ...] | None = None,
    budget_s: float | None = None,
) -> Diagnosis:
    """Find what the model of a data set lacks, and test it on trials that were held out of the search.

    Parameters
    ----------
    data_set : DataSet
        The robot as its file describes it, and what was measured.
    seed : int
        Draws the held-out trials and the surrogate noise; the same seed gives the same answer.
    progress : callable (stage, share)
        Called with what is being done and how far it is (0 … 1).
    repairs : tuple of Repair, optional
        What was mended in the data set already; by default it is mended here.
    budget_s : float, optional
        Seconds after which the search stops and the best answer so far is judged and reported, which takes
        a few seconds more.  Without it the same seed gives the same answer on any machine.

    Returns
    -------
    Diagnosis
    """
    watch = Watch.of(progress, budget_s)
    watch("mending the data", 0.0)
    with linear_algebra_alone():
        conditions = ready(data_set, repairs, seed)
        first = Attempt.of(conditions, seed, watch)
        found = _diagnosed(first, budget_s)
        other = first.with_white_noise()
        return found if other is None else _diagnosed(other, budget_s)


def _diagnosed(attempt: Attempt, budget_s: float | None) -> Diagnosis:
    """What an attempt found, reported."""
    conditions, s, checked = attempt.conditions, attempt.searched, attempt.checked
    data_set, seed, watch = conditions.data_set, attempt.seed, attempt.watch
    held, trials = s.held, s.problem.trials
    everyone = np.arange(len(trials), dtype=np.int64)
    court = s.court(data_set, seed)
    problem, state = checked.problem, checked.state
    before, after = (score(e, judged(court.unseen)) for e in (checked.before, checked.after))
    watch("what is left", 0.0)
    fitted = () if state is None else state.fit.effects
    drawn_before = drawn_after = problem.predict([()], [everyone])[0]
    if fitted:
        drawn_after = problem.predict([fitted], [everyone])[0]
    uncut = s.uncut
    if len(uncut.trials) == len(trials):
        uncut = uncut.with_wheel_phases(problem.wheel_phases)
    events = events_of(uncut, fitted, s.seen_runs)
    rates_before, rates_after = (problem.residual_rates(p) for p in (drawn_before, drawn_after))
    variables = [variables_of(t, problem.model(())) for t in trials]
    where = where_after = dependences(rates_before, variables, seed)
    if fitted:
        where_after = dependences(rates_after, variables, seed)
    turns = order_analysis(problem, rates_after, seed)
    entries = s.rounds[0].map() if s.rounds else ()
    watch("fitting what is reported", 0.3)
    found, final = _reported(s, checked, entries, lambda: watch.expired)
    found = shown_in(problem, s.runs, data_set.members, found)
    verdict = checked.verdict
    explained = after.chi <= SETTINGS.noise_chi and verdict is not Verdict.UNEXPLAINED
    last = _beside_all(attempt, explained)
    remaining = () if last is None else last.map()
    near, traces = verdict is Verdict.NO_MISSING_EFFECT, [f.traced_to for f in found]
    rejected = () if near else checked.rejected  # near the noise only the map's leads stand out
    drift = None if near or explained else drift_in(problem, fitted, s.runs, seed)
    made = leads(remaining, turns, last, rejected, traces, drift) if near or not explained else ()
    following = tuple(lead for lead in made if lead.stands_out or not near)
    return Diagnosis(
        data_set=data_set.name,
        surface=data_set.surface,
        verdict=verdict,
        noise=problem.sigma,
        noise_estimated=conditions.noise_estimated,
        held_out=tuple(trials[i].name for i in held),
        cross_validated=not len(held) and len(data_set.trials) > 1,
        before=before,
        after=after,
        judgement=checked.judgement,
        rejected=checked.rejected,
        findings=found,
        steps=tuple(_step(r) for r in s.rounds),
        map=entries,
        map_after=remaining,
        leads=following,
        where=where,
        where_after=where_after,
        turns=turns,
        excitation=_excitation(final),
        events=events,
        outliers=sum(t.dropped for t in trials),
        trials=_trajectories(attempt, drawn_before, drawn_after),
        recipe=data_set.recipe,
        corrected=data_set.recipe.with_effects(*(() if final is None else acting(final.effects, 0))),
        repairs=conditions.repairs,
        remarks=(
            *(cut_short(budget_s) if attempt.was_cut else ()),
            *_remarks(attempt, final, found, (before.chi, after.chi), events, turns),
        ),
    )


def _trajectories(attempt: Attempt, before: Array, after: Array) -> tuple[TrialTrajectories, ...]:
    """Each trial as measured, and as predicted (R, T, 3) before and after."""
    s, problem, data_set = attempt.searched, attempt.checked.problem, attempt.conditions.data_set
    places = [d.folder or d.name for d in data_set.members or (data_set,)]
    return tuple(
        TrialTrajectories(
            name=t.name,
            run=s.runs[i],
            data_set=places[problem.member_of[i]],
            held_out=i in s.held,
            t_s=t.t_s,
            measured=t.pose,
            before=before[i, : len(t.t_s)],
            after=after[i, : len(t.t_s)],
        )
        for i, t in enumerate(problem.trials)
    )


def _remarks(
    attempt: Attempt,
    final: Fit | None,
    found: Sequence[Finding],
    chi: tuple[float, float],
    events: tuple[Event, ...],
    turns: tuple[Periodicity, ...],
) -> Iterator[str]:
    """What else is to be said of the data, of the search and of what was found; ``chi`` before and after."""
    s, checked, data_set = attempt.searched, attempt.checked, attempt.conditions.data_set
    yield from of_the_clock(data_set, checked, final, s.candidates)
    yield from of_noise(data_set.members)
    yield from of_one_run(len(data_set.trials))
    yield from of_the_draw(checked, chi[0])
    yield from of_pieces(checked.state)
    yield from of_small_shares(found, checked.state, chi[1])
    yield from of_the_fit(final, events, turns, phased=checked.phased, held=len(s.held) > 0)


def _beside_all(attempt: Attempt, explained: bool) -> Round | None:
    """The round that began with all that was found: what the residual still follows.

    Where the search has none, it is made, unless all is ``explained`` or the time is over.
    """
    s, state, seed, watch = attempt.searched, attempt.checked.state, attempt.seed, attempt.watch
    last = like(state, s.rounds)
    if not explained and last is None and state is not None and s.rounds and not watch.expired:
        last = left_over(state, s.rounds, s.runs, s.candidates, seed, watch)
    told = last is not None and any(entry.supported for entry in last.map())
    if attempt.checked.verdict is Verdict.UNEXPLAINED and not told:
        # Too few of the searched runs show it: a lead, which claims nothing, may look at all.
        last = left_over(s.state if last is None else last.before, (), s.runs, s.candidates, seed, watch)
    return last


def _reported(
    s: Searched, checked: Checked, entries: tuple[MapEntry, ...], expired: Callable[[], bool]
) -> tuple[tuple[Finding, ...], Fit | None]:
    """The findings with the parameters to report, fitted to every trial that may be used."""
    state = checked.state
    if state is None:
        return (), None
    # With phases from their first parts alone, held-out trials are no match for the others in a fit.
    everyone = np.arange(len(s.problem.trials), dtype=np.int64)
    fitted = s.seen if checked.phased and len(s.held) else everyone
    view = checked.problem.as_seen_in(state.view).evened(state.fit.effects, fitted)
    final = fit(view, state.structure, state.fit.x, fitted, iterations=_FINAL_STEPS)
    # The last steps start each run where all of its frames put it, take every sample of the log and
    # integrate finely: the numbers to report.
    view = view.restarted(final.effects, fitted)
    final = fit(
        view.rebuilt(InterpolationScheme.FULL), state.structure, final.x, fitted, iterations=_FINE_STEPS
    )
    seen_runs = [s.runs[i] for i in s.seen]
    useful = [without(state, index, seen_runs).chi for index in range(len(state.structure))]
    rivals = cannot_be_told(state, s.rounds, seen_runs, expired)
    return findings(view, state, useful, rivals, s.rounds, final, len(s.candidates), entries), final


def _step(done: Round) -> Step:
    rows = [
        Tried(
            label=" + ".join(c.label for c in s.structure),
            traced_to=s.last.trace,
            named=s.last.named,
            parameters=len(s.fit.x),
            chi=s.chi,
        )
        for s in done.tried
    ] or [
        Tried(
            label=e.label,
            traced_to=e.parts[0].trace,
            named=e.named,
            parameters=len(e.step),
            chi=done.before.chi * float(np.sqrt(max(0.0, 1.0 - e.gain / max(done.screening.total, 1e-300)))),
        )
        for e in done.screening.entries[:20]
    ]
    best = done.best
    taken = " + ".join(c.label for c in best.structure) if done.taken and best is not None else None
    return Step(chi_before=done.before.chi, tried=tuple(rows), taken=taken)


def _excitation(final: Fit | None) -> tuple[float, ...]:
    if final is None or not len(final.x):
        return ()
    scale = np.concatenate([c.scale for c in final.structure])
    flat = final.jacobian.reshape(-1, len(final.x)) * scale
    return tuple(float(v) for v in np.linalg.svd(flat, compute_uv=False))
