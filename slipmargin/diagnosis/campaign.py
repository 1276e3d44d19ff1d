"""What a diagnosis of a campaign says of each group: findings taken apart, evidence of each data set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet, Member
from slipmargin.data.odometry import body_path
from slipmargin.diagnosis.data_problem import problem_of
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Diagnosis, Estimate, Finding, Score, ShownBy, TrialTrajectories
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.confined import Confined, acting


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drift:
    """Errors over whole runs (root mean square): displacement over distance [1], change of heading [rad]."""

    displacement: float
    heading_rad: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MemberResult:
    """A data set of a campaign, its errors before and after on runs held out, and its corrected robot."""

    member: Member
    runs: int
    judged: int
    before: Score
    after: Score
    drift_before: Drift
    drift_after: Drift
    corrected: Recipe


def by_group(data_set: DataSet, diagnosis: Diagnosis) -> tuple[Diagnosis, tuple[MemberResult, ...]]:
    """The diagnosis with each finding taken apart by group, and the result of each data set.

    Parameters
    ----------
    data_set : DataSet
        The runs of the campaign.
    diagnosis : Diagnosis
        What :func:`slipmargin.diagnosis.loop.diagnose` found in them.
    """
    effects: tuple[AnyEffect, ...] = tuple(f.effect for f in diagnosis.findings)
    problem = problem_of(replace(data_set, sigma=diagnosis.noise))
    found = tuple(
        part
        for index, finding in enumerate(diagnosis.findings)
        for part in _apart(finding, _shown_by(problem, data_set, effects, index))
    )
    members = tuple(
        _member(number, member, diagnosis, effects) for number, member in enumerate(data_set.members)
    )
    return replace(diagnosis, findings=found), members


def _shown_by(
    problem: Problem, data_set: DataSet, effects: tuple[AnyEffect, ...], index: int
) -> dict[int, ShownBy]:
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    others = (*effects[:index], *effects[index + 1 :])
    without, with_it = problem.residuals([others, effects], [everyone, everyone])
    found = {}
    for number, member in enumerate(data_set.members):
        rows = np.flatnonzero(problem.member_of == number)
        count = max(1.0, problem.samples(rows))
        found[number] = ShownBy(
            data_set=member.name,
            runs=len(rows),
            chi_without=float(np.sqrt(np.sum(without[rows] ** 2) / count)),
            chi_with=float(np.sqrt(np.sum(with_it[rows] ** 2) / count)),
        )
    return found


def _apart(finding: Finding, shown: dict[int, ShownBy]) -> list[Finding]:
    effect = finding.effect
    if not isinstance(effect, Confined):
        return [replace(finding, shown_by=tuple(shown.values()))]
    several = len(effect.groups) > 1
    return [
        replace(
            finding,
            effect=own,
            group=group,
            parameters=_of_group(finding.parameters, group) if several else finding.parameters,
            derived=_of_group(finding.derived, group),
            shown_by=tuple(s for number, s in shown.items() if number in members),
        )
        for own, members, group in zip(effect.effects, effect.members, effect.groups, strict=True)
    ]


def _of_group(estimates: Sequence[Estimate], group: str) -> tuple[Estimate, ...]:
    end = f" ({group})"
    return tuple(replace(e, name=e.name.removesuffix(end)) for e in estimates if e.name.endswith(end))


def _member(
    number: int, member: Member, diagnosis: Diagnosis, effects: tuple[AnyEffect, ...]
) -> MemberResult:
    own = [t for t in diagnosis.trials if t.name.startswith(f"{member.name}/")]
    judged = [t for t in own if t.held_out] or own
    return MemberResult(
        member=member,
        runs=len(own),
        judged=len(judged),
        before=_score(judged, [t.before for t in judged], diagnosis.noise),
        after=_score(judged, [t.after for t in judged], diagnosis.noise),
        drift_before=_drift(judged, [t.before for t in judged]),
        drift_after=_drift(judged, [t.after for t in judged]),
        corrected=member.recipe.with_effects(*acting(effects, number)),
    )


def _score(trials: list[TrialTrajectories], predicted: list[Array], sigma: Array) -> Score:
    gaps = [t.measured - p for t, p in zip(trials, predicted, strict=True)]
    gap = np.concatenate(gaps) if gaps else np.zeros((1, 3))
    x, y, turn = np.nanmean(gap**2, axis=0)
    return Score(
        rmse_position_m=float(np.sqrt(x + y)),
        rmse_heading_rad=float(np.sqrt(turn)),
        chi=float(np.sqrt(np.nanmean((gap / sigma) ** 2))),
    )


def _drift(trials: list[TrialTrajectories], predicted: list[Array]) -> Drift:
    way, turn = [], []
    for trial, pose in zip(trials, predicted, strict=True):
        went, meant = body_path(trial.measured)[-1], body_path(pose)[-1]
        distance = float(np.hypot(*went[:2]))
        if distance > 0.0:
            way.append(float(np.hypot(*(meant - went)[:2])) / distance)
        turn.append(float((meant - went)[2]))
    return Drift(
        displacement=float(np.sqrt(np.mean(np.square(way)))) if way else 0.0,
        heading_rad=float(np.sqrt(np.mean(np.square(turn)))) if turn else 0.0,
    )
