"""The findings of a fitted structure: parameters with intervals, evidence, effects that fit as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate, equation_of
from slipmargin.diagnosis.evidence import Intervals, intervals
from slipmargin.diagnosis.fit import (
    Fit,
    Residuals,
    build,
    limits_of,
    misfit_of,
    shifted_by,
    spans,
)
from slipmargin.diagnosis.map_entry import MapEntry
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Estimate, Finding
from slipmargin.diagnosis.rivals import origin
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.signals import InterpolationScheme
from slipmargin.diagnosis.state import State
from slipmargin.effects import Effect, Quantity, Trace
from slipmargin.effects.confined import Confined, bare
from slipmargin.effects.general import PREFIX

_GENERAL_CONFIRM = (
    "vary this one variable, keep everything else as it was, and see whether the residual follows"
)


def findings(
    problem: Problem,
    state: State,
    useful: list[float],
    rivals: Sequence[tuple[str, ...]],
    rounds: list[Round],
    final: Fit,
    tried: int,
    entries: Sequence[MapEntry] = (),
) -> tuple[Finding, ...]:
    """One finding an effect of ``state``.

    Parameters
    ----------
    problem : Problem
        The trials.
    state : State
        The structure chosen on the trials that were not held out.
    useful : list of float
        What chi would be without each of its effects.
    rivals : sequence of tuples of str
        Labels of what explains the runs as well as each of its effects.
    rounds : list of Round
        How it was found.
    final : Fit
        The same structure fitted to all trials: the parameters to report.
    tried : int
        Number of candidates.
    entries : sequence of MapEntry
        The residual map of the model as believed.
    """
    if not len(final.x):
        return ()
    spread = _spread(problem, final)
    stuck = final.at_bound()
    found = []
    all_doubts = _doubts(problem, final, spread)
    own = zip(final.structure, final.effects, spans(final.structure), all_doubts, strict=True)
    for index, (candidate, effect, span, doubts) in enumerate(own):
        kind = bare(effect)
        step, own_state = origin(candidate, final.structure, rounds)
        found.append(
            Finding(
                effect=effect,
                name=f"{PREFIX}{candidate.trace.value}" if doubts else candidate.name,
                label=candidate.label,
                traced_to=candidate.trace,
                wheels=candidate.wheels or problem.nominal.geometry.names,
                parameters=tuple(
                    Estimate(
                        name=key,
                        value=float(value),
                        low=float(low),
                        high=float(high),
                        unit=unit,
                        at_bound=f"{candidate.label}.{key}" in stuck,
                    )
                    for key, unit, value, low, high in zip(
                        candidate.keys,
                        candidate.units,
                        final.x[span],
                        spread.low[span],
                        spread.high[span],
                        strict=True,
                    )
                ),
                derived=_derived(problem, final, spread, index),
                chi_without=useful[index],
                chi_with=state.chi,
                p_value=step.p_value_of(own_state),
                candidates_tried=tried,
                confused_with=rivals[index],
                confirm=kind.confirm if isinstance(kind, Effect) else _GENERAL_CONFIRM,
                equation=equation_of(candidate, kind),
                doubts=doubts,
                mapped=_mapped(candidate.trace, entries),
            )
        )
    return tuple(found)


def doubted(problem: Problem, final: Fit) -> bool:
    """Whether the evidence of some named effect of a fit does not carry its name."""
    return any(_doubts(problem, final, _spread(problem, final)))


def _spread(problem: Problem, final: Fit) -> Intervals:
    low, high, _ = limits_of(final.structure)
    spread = intervals(final, _other_log(problem, final))
    return replace(spread, low=np.maximum(spread.low, low), high=np.minimum(spread.high, high))


def _other_log(problem: Problem, final: Fit) -> Array:
    """What (P,) is added to the parameters' deviations since the wheels may have moved otherwise.

    Angles and speeds together determine their motion between samples: nothing then.  From speeds alone, or
    angles alone, it is a guess, and another one is tried too.
    """
    records = [t.record for t in problem.trials]
    if not problem.commanded and all(r.theta is not None and r.omega is not None for r in records):
        return np.zeros(len(final.x))
    return moved_by(problem.rebuilt(InterpolationScheme.OTHER), final)


def moved_by(other: Residuals, final: Fit) -> Array:
    """Standard deviations (P,) that another way to read the log adds.

    How far the parameters move with it counts by how probable the runs make it against the first, both being
    equally likely before (Bayesian averaging of models; J. A. Hoeting and others, Statistical Science 14,
    382, 1999): speeds that are held from row to row are half a row late, and runs that show this to be wrong
    do not make friction uncertain.
    """
    shift = shifted_by(other, final)
    there = np.clip(final.x + shift, *limits_of(final.structure)[:2])
    moved = other.residuals([build(final.structure, there)], [final.trials])[0]
    worse = (float(np.sum(moved**2)) - final.cost) / misfit_of(final.residual)
    probable = 0.5 * (1.0 - np.tanh(0.25 * worse))
    return np.asarray(np.sqrt(probable) * np.abs(shift))


def _doubts(problem: Problem, final: Fit, spread: Intervals) -> list[tuple[str, ...]]:
    """Why the own evidence of each effect does not carry its name; empty where it does."""
    as_logged, stuck, found = intervals(final), final.at_bound(), []
    for candidate, span in zip(final.structure, spans(final.structure), strict=True):
        doubts = [
            f"{candidate.label}.{key} ended at {value:.3g}, the edge of what makes sense"
            for key, value in zip(candidate.keys, final.x[span], strict=True)
            if f"{candidate.label}.{key}" in stuck
        ]
        # Another reading of the log says nothing against an effect of several parameters in whole runs.
        own = spread if candidate.size == 1 or problem.piece is not None else as_logged
        if candidate.nested and own.may_do_nothing(candidate, final.x, span):
            doubts.append("runs differ so much that it may do nothing")
        doubts += _against_name(candidate, final.x[span], spread.low[span], spread.high[span])
        found.append(tuple(doubts) if candidate.named else ())
    return found


def _against_name(candidate: Candidate, x: Array, low: Array, high: Array) -> list[str]:
    """Why values, intervals from ``low`` to ``high``, do not carry the name, where it means one side of null.

    One lies surely on the other side, or none lies surely on the side that is meant.
    """
    assert candidate.meant is not None
    means, less = candidate.meant != 0.0, candidate.meant < 0.0
    wrong = means & np.where(less, low > candidate.null, high < candidate.null)
    right = means & np.where(less, high < candidate.null, low > candidate.null)
    told = wrong if wrong.any() or right.any() else means
    return [
        f"{candidate.label}.{key} {'is' if sure else 'may as well be'} {value:.3g}, and the name means "
        f"{'less' if below else 'more'} than {null:g}"
        for key, value, null, below, sure, said in zip(
            candidate.keys, np.where(wrong, x, candidate.null), candidate.null, less, wrong, told, strict=True
        )
        if said
    ]


def _mapped(trace: Trace, entries: Sequence[MapEntry]) -> bool | None:
    return next((e.supported for e in entries if e.traced_to is trace), None)


def _derived(problem: Problem, final: Fit, spread: Intervals, index: int) -> tuple[Estimate, ...]:
    """What follows from an effect's parameters and can be checked by hand."""
    effect = final.effects[index]
    if isinstance(effect, Confined):
        return tuple(_quantities(problem, final, spread, index))
    if not isinstance(effect, Effect):
        return ()
    return (*_quantities(problem, final, spread, index), *_scanned(problem, final, index, effect))


def _scanned(problem: Problem, final: Fit, index: int, effect: Effect) -> list[Estimate]:
    """Parameters that no fit varied, each at the value that predicts best with all else as fitted."""
    units = {p.name: p.unit for p in effect.parameters}
    found = []
    for name, values in effect.scanned.items():
        sets = [
            (*final.effects[:index], replace(effect, **{name: value}), *final.effects[index + 1 :])  # type: ignore[type-var]
            for value in values
        ]
        costs = [float(np.sum(r**2)) for r in problem.residuals(sets, [final.trials] * len(sets))]
        best = values[int(np.argmin(costs))]
        found.append(Estimate(name=name, value=best, low=best, high=best, unit=units[name]))
    return found


def _quantities(problem: Problem, final: Fit, spread: Intervals, index: int) -> list[Estimate]:
    """What the effect derives from the model, with the parameters' intervals carried over linearly.

    How parameters vary together is carried over too; no end lies beyond what the ends of all of theirs say.
    """

    def derived(x: Array) -> tuple[Quantity, ...]:
        effects = build(final.structure, x)
        effect = effects[index]
        if isinstance(effect, Confined):
            return tuple(
                replace(q, name=f"{q.name} ({group})")
                for own, members, group in zip(effect.effects, effect.members, effect.groups, strict=True)
                if isinstance(own, Effect)
                for q in own.derived(problem.model(effects, min(members)))
            )
        return effect.derived(problem.model(effects)) if isinstance(effect, Effect) else ()

    def values(x: Array) -> Array:
        return np.array([q.value for q in derived(x)])

    quantities = derived(final.x)
    if not quantities:
        return []
    slope = final.slope(values)
    reach = spread.quantile * np.sqrt(np.einsum("pq,pr,rq->q", slope, spread.covariance, slope))
    ends = np.sort([slope * (end - final.x)[:, None] for end in (spread.low, spread.high)], axis=0)
    low, high = np.maximum(-reach, ends[0].sum(axis=0)), np.minimum(reach, ends[1].sum(axis=0))
    return [
        Estimate(name=q.name, value=q.value, low=q.value + float(down), high=q.value + float(up), unit=q.unit)
        for q, down, up in zip(quantities, low, high, strict=True)
    ]
