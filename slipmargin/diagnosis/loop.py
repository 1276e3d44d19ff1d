"""The diagnosis: compare model and measurement, try every candidate, add what is missing, compare again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Index
from slipmargin.data.data_set import DataSet
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.candidate import named_candidates
from slipmargin.diagnosis.conditions import problem_of, ready
from slipmargin.diagnosis.events import cut_apart, find_events, with_measured_velocity
from slipmargin.diagnosis.findings import findings
from slipmargin.diagnosis.fit import Fit, fit
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.diagnosis.order_analysis import Periodicity, order_analysis
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.ranges import ranges, variables_of
from slipmargin.diagnosis.residual_diagnostics import dependences
from slipmargin.diagnosis.result import Diagnosis, Event, Finding, Step, TrialTrajectories, Tried, Verdict
from slipmargin.diagnosis.scores import scores
from slipmargin.diagnosis.search import FAR, Progress, Round, State
from slipmargin.diagnosis.selection import last_view, needed, refitted, search, without
from slipmargin.diagnosis.signals import InterpolationScheme
from slipmargin.effects import AnyEffect

#: With at least so many trials some are held out altogether; with fewer all are cross-validated.
ENOUGH_TO_HOLD_OUT = 6
_HELD_OUT_SHARE = 0.2
#: So many trials are enough to search with; the parameters are then fitted to all.
_SEARCHED = 12
#: Steps of the last fit, which starts where the search ended.
_FINAL_STEPS = 6
#: Above this chi, a residual that no candidate explains is reported as unexplained.
_UNEXPLAINED_CHI = 1.3


def no_progress(stage: str, share: float) -> None:
    """Progress that is not shown."""


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
    candidates: int
    state: State
    rounds: list[Round]


def searched(data_set: DataSet, seed: int, progress: Progress = no_progress) -> Searched:
    """Noise, cuts, ranges, wheel phases and effects, all from the trials that are not held out."""
    progress("reading the noise", 0.0)
    every_run = np.arange(len(data_set.trials))
    held_runs = _held_out(len(every_run), seed)
    seen_runs = np.setdiff1d(every_run, held_runs).astype(np.int64)
    uncut = problem = problem_of(data_set)
    runs: tuple[int, ...] = tuple(range(len(every_run)))
    if events := _events(uncut, (), seen_runs):
        records, runs = cut_apart(data_set.trials, events)
        problem = with_measured_velocity(problem_of(data_set, records), runs)
    held = np.flatnonzero(np.isin(runs, held_runs))
    seen = np.flatnonzero(np.isin(runs, seen_runs))
    known = tuple(effect.name for effect in data_set.recipe.effects)
    model, commanded = problem.model(()), problem.commanded
    candidates = [
        *named_candidates(model.geometry.names, commanded, known),
        *general_candidates(model, ranges(tuple(problem.trials[i] for i in seen)), commanded),
    ]
    progress("comparing the residual with measured variables", 0.0)
    some = seen[np.unique(np.linspace(0, len(seen) - 1, _SEARCHED).round().astype(int))]
    problem, state, rounds = search(problem, some, seen, candidates, seed, progress)
    if state.structure and (len(some) < len(seen) or state.chi > FAR):
        progress("fitting all trials that are not held out", 0.0)
        state = refitted(problem, state, state.structure, state.fit.x, seen)
    return Searched(
        problem=problem,
        uncut=uncut,
        runs=runs,
        held=held,
        seen=seen,
        seen_runs=seen_runs,
        candidates=len(candidates),
        state=needed(problem, state),
        rounds=rounds,
    )


def diagnose(
    data_set: DataSet,
    *,
    seed: int = 0,
    progress: Progress = no_progress,
    repairs: tuple[Repair, ...] | None = None,
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

    Returns
    -------
    Diagnosis
    """
    progress("mending the data", 0.0)
    conditions = ready(data_set, repairs)
    data_set = conditions.data_set
    s = searched(data_set, seed, progress)
    state, held, trials = s.state, s.held, s.problem.trials
    everyone = np.arange(len(trials), dtype=np.int64)
    judged = held if len(held) else everyone
    cross_validated = not len(held)
    progress("predicting the held-out trials", 0.0)
    full = s.problem.rebuilt(InterpolationScheme.FULL)
    records = [data_set.trials[s.runs[i]] for i in judged]
    score = scores(full, state, judged, records, cross_validated)
    problem = score.problem
    progress("fitting the parameters to report", 0.0)
    # With phases from their first parts alone, held-out trials are no match for the others in a fit.
    fitted = s.seen if score.phased and len(held) else everyone
    view = last_view(problem, state)
    final = fit(view, state.structure, state.fit.x, fitted, iterations=_FINAL_STEPS)
    progress("computing intervals", 0.0)
    useful = [without(s.problem, state, index).chi for index in range(len(state.structure))]
    found = findings(view, state, useful, s.rounds, final, s.candidates)
    drawn_before, drawn_after = (problem.predict([e], [everyone])[0] for e in ((), state.fit.effects))
    uncut = s.uncut
    if len(uncut.trials) == len(trials):
        uncut = uncut.with_wheel_phases(problem.wheel_phases)
    events = _events(uncut, state.fit.effects, s.seen_runs)
    rates_before, rates_after = (problem.residual_rates(p) for p in (drawn_before, drawn_after))
    variables = [variables_of(t, problem.model(())) for t in trials]
    turns = order_analysis(problem, rates_after, seed)
    return Diagnosis(
        data_set=data_set.name,
        surface=data_set.surface,
        verdict=_verdict(state, s.rounds),
        noise=problem.sigma,
        noise_estimated=conditions.noise_estimated,
        held_out=tuple(trials[i].name for i in held),
        cross_validated=cross_validated,
        before=score.before,
        after=score.after if found else score.before,
        findings=found,
        steps=tuple(_step(r) for r in s.rounds),
        where=dependences(rates_before, variables, seed),
        where_after=dependences(rates_after, variables, seed),
        turns=turns,
        excitation=_excitation(final),
        events=events,
        outliers=sum(t.dropped for t in trials),
        trials=tuple(
            TrialTrajectories(
                name=t.name,
                held_out=i in held,
                t_s=t.t_s,
                measured=t.pose,
                before=drawn_before[i, : len(t.t_s)],
                after=drawn_after[i, : len(t.t_s)],
            )
            for i, t in enumerate(trials)
        ),
        recipe=data_set.recipe,
        corrected=data_set.recipe.with_effects(*final.effects),
        repairs=conditions.repairs,
        remarks=_remarks(state, found, final, events, turns, phased=score.phased, held=len(held) > 0),
    )


def _events(problem: Problem, effects: tuple[AnyEffect, ...], ordinary: Index) -> tuple[Event, ...]:
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    return find_events(problem, problem.predict([effects], [everyone])[0], ordinary)


def _held_out(count: int, seed: int) -> Index:
    """Indices of whole trials that nothing but the final comparison may see."""
    if count < ENOUGH_TO_HOLD_OUT:
        return np.zeros(0, dtype=np.int64)
    many = max(2, round(_HELD_OUT_SHARE * count))
    return np.sort(np.random.default_rng(seed).choice(count, size=many, replace=False)).astype(np.int64)


def _verdict(state: State, rounds: list[Round]) -> Verdict:
    if state.structure:
        return Verdict.EFFECT_FOUND
    return Verdict.UNEXPLAINED if rounds[0].before.chi > _UNEXPLAINED_CHI else Verdict.NO_MISSING_EFFECT


def _step(done: Round) -> Step:
    if done.tried:
        rows = [
            Tried(
                label=" + ".join(c.label for c in s.structure),
                traced_to=s.last.trace,
                named=s.last.named,
                parameters=len(s.fit.x),
                chi=s.chi,
            )
            for s in done.tried
        ]
    else:
        rows = sorted(
            (
                Tried(
                    label=c.label,
                    traced_to=c.trace,
                    named=c.named,
                    parameters=c.size,
                    chi=float(np.sqrt(max(0.0, done.before.chi**2 - gain / done.before.samples))),
                )
                for c, gain in zip(done.candidates, done.gains, strict=True)
            ),
            key=lambda t: t.chi,
        )[:20]
    best = done.best
    taken = " + ".join(c.label for c in best.structure) if done.taken and best is not None else None
    return Step(chi_before=done.before.chi, tried=tuple(rows), taken=taken)


def _excitation(final: Fit) -> tuple[float, ...]:
    if not len(final.x):
        return ()
    scale = np.concatenate([c.scale for c in final.structure])
    flat = final.jacobian.reshape(-1, len(final.x)) * scale
    return tuple(float(v) for v in np.linalg.svd(flat, compute_uv=False))


def _remarks(
    state: State,
    found: tuple[Finding, ...],
    final: Fit,
    events: tuple[Event, ...],
    turns: tuple[Periodicity, ...],
    *,
    phased: bool,
    held: bool,
) -> tuple[str, ...]:
    said = []
    if phased:
        which = "held-out run" if held else "run"
        said.append(
            f"No log holds the wheel angles.  On each {which} the start angles of the wheels were estimated "
            "from the first half of the way they turn, with parameters fitted to other runs; the errors "
            "reported are those of the rest of the run."
        )
    if found and state.chi > _UNEXPLAINED_CHI:
        said.append(
            f"The effects found leave a residual of {state.chi:.2f} times the noise: something is still "
            "missing, or a form is only approximate."
        )
    if final.at_bound():
        said.append("Stuck at the edge of its range: " + ", ".join(final.at_bound()) + ".")
    if events:
        said.append(
            "Something happened once in a trial; it is listed under events, not explained by physics."
        )
    said += [r.sentence for r in turns]
    return tuple(said)
