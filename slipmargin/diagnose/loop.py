"""The loop: compare, find where the residual sits, try every suspect, add what is missing, compare again.

The paper's story as a function: initial model, residual, its cause, improved model, better agreement.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.diagnose.candidate import named_candidates
from slipmargin.diagnose.diagnosis import Diagnosis, Event, Finding, Score, Step, Trace3, Tried, Verdict
from slipmargin.diagnose.events import cut_apart, find_events, in_full_swing
from slipmargin.diagnose.findings import findings
from slipmargin.diagnose.fit import Fit, build, fit
from slipmargin.diagnose.general_forms import general_candidates
from slipmargin.diagnose.left_out import leave_one_out
from slipmargin.diagnose.prepare import clean, noise
from slipmargin.diagnose.problem import Problem
from slipmargin.diagnose.ranges import ranges, variables_of
from slipmargin.diagnose.search import FAR, Progress, Round, State
from slipmargin.diagnose.selection import last_view, needed, refitted, search, without
from slipmargin.diagnose.signals import Way
from slipmargin.diagnose.turns import Recurrence, comes_round
from slipmargin.diagnose.where import dependences
from slipmargin.effects import AnyEffect

#: With at least so many trials some are held out altogether; with fewer all are cross-validated.
ENOUGH_TO_HOLD_OUT = 6
_HELD_OUT_SHARE = 0.2
#: So many trials are enough to search with; the parameters are then fitted to all.
_SEARCHED = 12
#: Steps of the last fit, which starts where the search ended.
_FINAL_STEPS = 6
#: A residual this far above the noise that nothing explains is not "no missing effect".
_UNEXPLAINED_CHI = 1.3


def quiet(stage: str, share: float) -> None:
    """Progress that nobody watches."""


def diagnose(data_set: DataSet, *, seed: int = 0, progress: Progress = quiet) -> Diagnosis:
    """Find what the model of a data set lacks, and prove it on trials that no fit has seen.

    Parameters
    ----------
    data_set : DataSet
        What is believed of the robot, and what was measured.
    seed : int
        Draws the held-out trials and the surrogate noise; the same seed gives the same answer.
    progress : callable (stage, share)
        Told what is being done and how far (0 … 1).

    Returns
    -------
    Diagnosis
    """
    progress("reading the noise", 0.0)
    sigma = noise(data_set.trials) if data_set.sigma is None else data_set.sigma
    uncut = problem = _problem(data_set, data_set.trials, sigma)
    runs: tuple[int, ...] = tuple(range(len(data_set.trials)))
    if events := _events(uncut, ()):
        records, runs = cut_apart(data_set.trials, events)
        problem = in_full_swing(_problem(data_set, records, sigma), runs)
    trials, commanded = problem.trials, problem.commanded
    everyone = np.arange(len(trials), dtype=np.int64)
    held = np.flatnonzero(np.isin(runs, _held_out(len(data_set.trials), seed)))
    seen = np.setdiff1d(everyone, held).astype(np.int64)
    known = tuple(effect.name for effect in data_set.recipe.effects)
    model = problem.model(())
    suspects = [
        *named_candidates(model.geometry.names, commanded, known),
        *general_candidates(model, ranges(trials), commanded),
    ]
    progress("looking where the residual sits", 0.0)
    searched = seen[np.unique(np.linspace(0, len(seen) - 1, _SEARCHED).round().astype(int))]
    problem, state, rounds = search(problem, searched, suspects, seed, progress)
    if state.structure and (len(searched) < len(seen) or state.chi > FAR):
        progress("fitting all trials that are not held out", 0.0)
        state = refitted(problem, state, state.structure, state.fit.x, seen)
    state = needed(problem, state)
    progress("fitting all trials", 0.0)
    searched_in, problem = problem, problem.rebuilt(Way.FULL)
    view = last_view(problem, state)
    final = fit(view, state.structure, state.fit.x, everyone, iterations=_FINAL_STEPS)
    progress("weighing what was found", 0.0)
    useful = [without(searched_in, state, index).chi for index in range(len(state.structure))]
    found = findings(view, state, useful, rounds, final, len(suspects))
    judged = held if len(held) else everyone
    base_pose, after_pose = _predictions(problem, state, judged, cross_validated=not len(held))
    before, after = (_score(problem, judged, pose) for pose in (base_pose, after_pose))
    drawn_before, drawn_after = (problem.predict([e], [everyone])[0] for e in ((), state.fit.effects))
    events = _events(uncut, state.fit.effects)
    rates_before, rates_after = (problem.residual_rates(p) for p in (drawn_before, drawn_after))
    variables = [variables_of(t, problem.model(())) for t in trials]
    turns = comes_round(problem, rates_after, seed)
    return Diagnosis(
        data_set=data_set.name,
        surface=data_set.surface,
        verdict=_verdict(state, rounds),
        noise=sigma,
        noise_estimated=data_set.sigma is None,
        held_out=tuple(trials[i].name for i in held),
        cross_validated=not len(held),
        before=before,
        after=after if found else before,
        findings=found,
        steps=tuple(_step(r) for r in rounds),
        where=dependences(rates_before, variables, seed),
        where_after=dependences(rates_after, variables, seed),
        turns=turns,
        excitation=_excitation(final),
        events=events,
        outliers=sum(t.dropped for t in trials),
        trials=tuple(
            Trace3(
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
        remarks=_remarks(state, found, final, events, turns),
    )


def _problem(data_set: DataSet, records: tuple[Record, ...], sigma: Array) -> Problem:
    trials = tuple(clean(record, sigma) for record in records)
    commanded = data_set.wheel_signal is WheelSignal.COMMANDED
    return Problem.of(data_set.recipe, data_set.surface, trials, sigma, commanded)


def _events(problem: Problem, effects: tuple[AnyEffect, ...]) -> tuple[Event, ...]:
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    return find_events(problem, problem.predict([effects], [everyone])[0])


def _held_out(count: int, seed: int) -> Index:
    """Indices of whole trials that nothing but the final comparison may see."""
    if count < ENOUGH_TO_HOLD_OUT:
        return np.zeros(0, dtype=np.int64)
    many = max(2, round(_HELD_OUT_SHARE * count))
    return np.sort(np.random.default_rng(seed).choice(count, size=many, replace=False)).astype(np.int64)


def _predictions(problem: Problem, state: State, judged: Index, cross_validated: bool) -> tuple[Array, Array]:
    """Poses (R, T, 3) of the judged trials without and with the effects, fitted to other trials."""
    before = problem.predict([()], [judged])[0]
    if not len(state.fit.x):
        return before, before
    if not cross_validated:
        return before, problem.predict([state.fit.effects], [judged])[0]
    sets = [build(state.structure, x) for x in leave_one_out(state.fit)]
    return before, np.concatenate(problem.predict(sets, [judged[i : i + 1] for i in range(len(judged))]))


def _score(problem: Problem, judged: Index, pose: Array) -> Score:
    seen = problem.seen[judged]
    gap = np.where(seen, problem.measured[judged] - pose, 0.0)
    both = seen[..., 0] & seen[..., 1]
    return Score(
        rmse_position_m=float(np.sqrt(np.sum(gap[..., :2] ** 2) / max(1, both.sum()))),
        rmse_heading_rad=float(np.sqrt(np.sum(gap[..., 2] ** 2) / max(1, seen[..., 2].sum()))),
        chi=float(np.sqrt(np.sum((gap / problem.sigma) ** 2) / max(1, seen.sum()))),
    )


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
                    chi=float(np.sqrt(max(0.0, done.before.chi**2 - hope / done.before.samples))),
                )
                for c, hope in zip(done.suspects, done.hopes, strict=True)
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
    turns: tuple[Recurrence, ...],
) -> tuple[str, ...]:
    said = []
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
    said += [r.told for r in turns]
    return tuple(said)
