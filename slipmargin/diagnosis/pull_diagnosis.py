"""The diagnosis of a data set that holds pulls alone: what the model lacks, proved on settings left out.

The whole search is repeated without each part of the settings, and the pulls of that part are predicted with
what was found without them.  The verdict follows from these predictions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis.candidate import equation_of
from slipmargin.diagnosis.fit import Fit, build, limits_of, spans
from slipmargin.diagnosis.pull_candidates import pull_candidates
from slipmargin.diagnosis.pull_instrument import explaining
from slipmargin.diagnosis.pull_next import NextPull, next_pulls
from slipmargin.diagnosis.pull_problem import PullProblem
from slipmargin.diagnosis.pull_remarks import remarks
from slipmargin.diagnosis.pull_search import (
    PullRound,
    PullState,
    beside,
    left_out,
    noise_N,
    restated,
    search,
)
from slipmargin.diagnosis.pull_unseen import PullScore, Unseen
from slipmargin.diagnosis.result import Estimate, Finding, Step, Tried, Verdict
from slipmargin.diagnosis.settings import PULLS, SETTINGS
from slipmargin.diagnosis.watch import Watch, cut_short
from slipmargin.effects import Effect, Quantity, Recipe, Trace
from slipmargin.errors import InputError

_GENERAL_CONFIRM = "pull in further directions, at other points of the body, and see whether it holds"


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullLead:
    """Something the pulls may follow: a variable, the best candidate over it, and chi as steps count it."""

    traced_to: Trace
    label: str
    named: bool
    chi: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullDiagnosis:
    """Verdict, findings and evidence of a data set of pulls.

    ``noise_from`` says what ``sigma_N`` is from: "stated", "repeats", "neighbours" (differences between
    neighbouring orientations), or "residual" (what the model found leaves of all pulls).
    ``phi_rad``, ``force_N``, ``before_N`` and ``after_N`` (P,): each pull as measured, and as expected by the
    model as believed and by models found without its setting.  ``found_in`` of ``folds`` searches without a
    part of the settings found the same names; ``was_cut``: time ended a search.  chi of steps, leads and
    findings is the root of minus twice the log likelihood of a pull in settings that a fit was not made to.
    """

    data_set: str
    surface: str
    verdict: Verdict
    sigma_N: float
    noise_from: str
    before: PullScore
    after: PullScore
    p_value: float
    findings: tuple[Finding, ...]
    leads: tuple[PullLead, ...]
    steps: tuple[Step, ...]
    settings: int
    folds: int
    found_in: int
    was_cut: bool
    phi_rad: Array
    force_N: Array
    before_N: Array
    after_N: Array
    next_pulls: tuple[NextPull, ...]
    recipe: Recipe
    corrected: Recipe
    remarks: tuple[str, ...]


def diagnose_pulls(
    data_set: DataSet,
    *,
    seed: int = 0,
    progress: Callable[[str, float], None] = lambda stage, share: None,
    budget_s: float | None = None,
) -> PullDiagnosis:
    """Find what the model of a data set lacks from its pulls alone.

    Parameters
    ----------
    data_set : DataSet
        The robot as its file describes it, with pulls.
    seed : int
        Draws the parts that are left out and the surrogate noise; the same seed gives the same answer.
    progress : callable (stage, share)
        Called with what is being done and how far it is (0 … 1).
    budget_s : float, optional
        Seconds after which the searches stop; what they found until then is judged, which takes a few seconds
        more.

    Raises
    ------
    InputError
        Without pulls, or with pulls in fewer than four settings.
    """
    pulls = data_set.pulls
    if pulls is None:
        raise InputError("pulls.csv", "is not there", "add it", data_set.name)
    watch = Watch.of(progress, budget_s)
    progress("reading the noise", 0.0)
    sigma, freedom, repeated = noise_N(pulls)
    noise_from = "stated" if pulls.sigma_N is not None else "repeats" if repeated else "neighbours"
    problem = PullProblem.of(data_set.recipe, data_set.surface, pulls, sigma, noise_from == "stated")
    candidates = pull_candidates(problem)
    progress("searching in all pulls", 0.0)
    first = watch.part(PULLS.first_share)
    state, rounds = search(problem, problem.everyone, candidates, seed, first)
    was_cut = first.expired
    scatter = _scatter(problem, state.fit)
    if pulls.sigma_N is None and scatter < (1.0 - PULLS.least_share) * sigma:
        # What the wheels stood on is part of the scatter of repeats; the model found says how large a part.
        sigma, noise_from = scatter, "residual"
        freedom = max(1.0, problem.count(problem.everyone) - len(state.fit.x))
        problem = PullProblem.of(data_set.recipe, data_set.surface, pulls, sigma, noise_known=True)
        second, known = watch.part(PULLS.first_share), rounds
        state, rounds = search(problem, problem.everyone, candidates, seed, second)
        if second.expired:
            was_cut, known = True, [restated(problem, r) for r in known]
            if known[-1].after.score < state.score:
                state, rounds = known[-1].after, known
    split = _parts(len(problem.rows), seed)
    without: list[PullState] = []
    for number, part in enumerate(split):
        progress("searching without some of the orientations", number / len(split))
        others = np.setdiff1d(problem.everyone, part).astype(np.int64)
        left = watch.part(1.0 / (len(split) - number))
        without.append(search(problem, others, candidates, seed, left)[0])
        was_cut |= left.expired
    unseen = Unseen.of(problem, split, without, freedom, seed)
    names = [{c.name for c in s.structure} for s in without]
    own = {c.name for c in state.structure}
    verdict = unseen.verdict(bool(state.structure))
    taken = verdict is Verdict.EFFECT_FOUND
    wrong = explaining(problem, state.fit if taken else None) if taken or unseen.misfit_before else []
    rivals = (*_rivals(state, rounds, names), *(fault.said for fault in wrong)) if taken else ()
    findings = _findings(problem, state, rounds, rivals, len(candidates)) if taken else ()
    progress("choosing the next pulls", 0.5)
    confused = [s for r in rounds if r.taken for s in r.rivals()]
    leads = _leads(problem, rounds)
    ahead = next_pulls(
        problem, state.fit if taken else rounds[0].before.fit, _competing(rounds, taken, confused)
    )
    return PullDiagnosis(
        data_set=data_set.name,
        surface=data_set.surface,
        verdict=verdict,
        sigma_N=sigma,
        noise_from=noise_from,
        before=unseen.before,
        after=unseen.after if taken else unseen.before,
        p_value=unseen.p_value,
        findings=findings,
        leads=leads,
        steps=tuple(_step(problem, r) for r in rounds),
        settings=len(problem.rows),
        folds=len(split),
        found_in=sum(n == own for n in names),
        was_cut=was_cut,
        phi_rad=pulls.phi_rad,
        force_N=pulls.force_N,
        before_N=unseen.before_N,
        after_N=unseen.after_N if taken else unseen.before_N,
        next_pulls=ahead,
        recipe=data_set.recipe,
        corrected=data_set.recipe.with_effects(*state.fit.effects) if taken else data_set.recipe,
        remarks=(
            *(cut_short(budget_s) if was_cut else ()),
            *remarks(problem, state, unseen, noise_from, wrong, taken=taken),
            *of_unused(data_set),
        ),
    )


def of_unused(data_set: DataSet) -> tuple[str, ...]:
    """What the file of a data set of pulls alone says of runs."""
    return tuple(f"{said} has no effect: the data set holds pulls and no runs." for said in data_set.unused)


def _scatter(problem: PullProblem, found: Fit) -> float:
    """Root mean square [N] of what a fit leaves of each pull beside its probable contact state."""
    freedom = problem.count(found.trials) - len(found.x)
    return problem.sigma_N * float(np.sqrt(np.sum(beside(found.residual)) / max(1, freedom)))


def _parts(count: int, seed: int) -> list[Index]:
    order = np.random.default_rng(seed).permutation(count)
    parts = min(PULLS.folds, count)
    return [np.sort(order[k::parts]).astype(np.int64) for k in range(parts)]


def _rivals(state: PullState, rounds: list[PullRound], names: list[set[str]]) -> tuple[str, ...]:
    """Effects, not among those chosen, of states that are as good and of searches without a part."""
    own = {c.name for c in state.structure}
    equal = [
        c
        for r in rounds
        if r.taken
        for s in r.rivals()
        for c in s.structure
        if not own <= {k.name for k in s.structure}
    ]
    found = [c.label for c in equal if c.name not in own]
    found += [name for chosen in names for name in sorted(chosen - own) if own - chosen]
    return tuple(dict.fromkeys(found))


def _competing(rounds: list[PullRound], taken: bool, confused: list[PullState]) -> list[Fit]:
    """Fits that further pulls should tell from the model that stands."""
    if taken:
        return [s.fit for s in confused]
    return [s.fit for s in rounds[0].tried[:3]]


def _leads(problem: PullProblem, rounds: list[PullRound]) -> tuple[PullLead, ...]:
    """The best single candidate of each variable, best first."""
    best: dict[Trace, PullState] = {}
    for s in rounds[0].tried:
        if len(s.structure) == 1:
            best.setdefault(s.structure[0].trace, s)
    pulls = len(problem.pulls.force_N)
    return tuple(
        PullLead(
            traced_to=trace, label=s.structure[0].label, named=s.structure[0].named, chi=_chi(s.score, pulls)
        )
        for trace, s in best.items()
        if s.score < rounds[0].before.score
    )


def _chi(squares: float, pulls: int) -> float:
    return float(np.sqrt(squares / pulls))


def _step(problem: PullProblem, done: PullRound) -> Step:
    pulls = problem.count(done.before.fit.trials)
    rows = tuple(
        Tried(
            label=" + ".join(c.label for c in s.structure),
            traced_to=s.structure[-1].trace,
            named=s.structure[-1].named,
            parameters=len(s.fit.x),
            chi=_chi(s.score, pulls),
        )
        for s in done.tried
    )
    best = done.best
    taken = " + ".join(c.label for c in best.structure) if done.taken and best is not None else None
    return Step(chi_before=_chi(done.before.score, pulls), tried=rows, taken=taken)


def deviations(problem: PullProblem, found: Fit) -> Array:
    """Standard deviation (P,) of parameters: the larger of jackknife over settings and normal matrix."""
    _, _, scale = limits_of(found.structure)
    flat = found.jacobian.reshape(-1, len(found.x)) * scale
    pulls = problem.count(found.trials)
    reduced = max(1.0, found.cost / max(1, pulls - len(found.x)))
    formal = np.sqrt(np.maximum(np.diag(np.linalg.pinv(flat.T @ flat)) * reduced, 0.0)) * scale
    each = np.array(left_out(found, [np.array([g]) for g in range(len(found.trials))]))
    spread = each - each.mean(axis=0)
    count = len(each)
    jackknife = np.sqrt((count - 1) / count * np.sum(spread**2, axis=0))
    return np.asarray(np.maximum(formal, jackknife))


def _findings(
    problem: PullProblem,
    state: PullState,
    rounds: list[PullRound],
    rivals: tuple[str, ...],
    tried: int,
) -> tuple[Finding, ...]:
    from scipy.special import stdtrit

    found = state.fit
    low, high, _ = limits_of(found.structure)
    sure = 0.5 * (1.0 + SETTINGS.interval_level)
    half = float(stdtrit(max(1, len(found.trials) - 1), sure)) * deviations(problem, found)
    bottom, top = np.maximum(found.x - half, low), np.minimum(found.x + half, high)
    stuck = found.at_bound()
    out, at = [], 0
    for index, (candidate, effect) in enumerate(zip(found.structure, found.effects, strict=True)):
        span = range(at, at + candidate.size)
        at += candidate.size
        p_value = next(r.p_value for r in rounds if r.best is not None and candidate in r.best.structure)
        out.append(
            Finding(
                effect=effect,
                name=candidate.name,
                label=candidate.label,
                traced_to=candidate.trace,
                wheels=candidate.wheels or problem.nominal.geometry.names,
                parameters=tuple(
                    Estimate(
                        name=key,
                        value=float(found.x[i]),
                        low=float(bottom[i]),
                        high=float(top[i]),
                        unit=unit,
                        at_bound=f"{candidate.label}.{key}" in stuck,
                    )
                    for key, unit, i in zip(candidate.keys, candidate.units, span, strict=True)
                ),
                derived=_derived(problem, found, half, index),
                chi_without=_without(problem, state, index),
                chi_with=_chi(state.score, problem.count(found.trials)),
                p_value=p_value,
                candidates_tried=tried,
                confused_with=rivals,
                confirm=effect.confirm if isinstance(effect, Effect) else _GENERAL_CONFIRM,
                equation=equation_of(candidate, effect),
            )
        )
    return tuple(out)


def _without(problem: PullProblem, state: PullState, index: int) -> float:
    """chi on settings left out with the other effects alone, fitted again."""
    from slipmargin.diagnosis.fit import fit
    from slipmargin.diagnosis.pull_search import state_of

    kept = [i for i in range(len(state.structure)) if i != index]
    own = spans(state.structure)
    x = np.concatenate([np.zeros(0), *(state.fit.x[own[i]] for i in kept)])
    rest = fit(problem, tuple(state.structure[i] for i in kept), x, state.fit.trials)
    return _chi(state_of(problem, rest).score, problem.count(state.fit.trials))


def _derived(problem: PullProblem, found: Fit, half: Array, index: int) -> tuple[Estimate, ...]:
    """What follows from an effect and can be checked by hand, with the intervals carried over linearly."""

    def quantities(x: Array) -> tuple[Quantity, ...]:
        effects = build(found.structure, x)
        effect = effects[index]
        return effect.derived(problem.model(effects)) if isinstance(effect, Effect) else ()

    def values(x: Array) -> Array:
        return np.array([q.value for q in quantities(x)])

    named = quantities(found.x)
    if not named:
        return ()
    reach = np.sqrt((found.slope(values) ** 2).T @ half**2)
    return tuple(
        Estimate(name=q.name, value=q.value, low=q.value - float(r), high=q.value + float(r), unit=q.unit)
        for q, r in zip(named, reach, strict=True)
    )
