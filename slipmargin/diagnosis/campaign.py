"""What a diagnosis of a campaign says of each group: findings taken apart, evidence of each data set.

The evidence is computed by the problem in which the diagnosis found its effects: mended runs, cut at events.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import Member
from slipmargin.data.odometry import body_path, driven_m
from slipmargin.diagnosis.limits_change import tried
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.pull_check import PullCheck, pull_check
from slipmargin.diagnosis.result import Diagnosis, Estimate, Finding, Score, ShownBy, TrialTrajectories
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.effects import AnyEffect, Recipe
from slipmargin.effects.confined import Confined, acting


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drift:
    """Errors over whole runs (root mean square): displacement over distance driven [1], heading [rad].

    A run that went no farther than noise, as one on the spot, has no share in the first.
    """

    displacement: float
    heading_rad: float


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MemberResult:
    """A data set of a campaign, its errors before and after, and its corrected robot.

    Errors are those of the ``judged`` runs, which were held out; where none was, those of all its runs, which
    the search has seen.  ``pulls`` is its pull tests beside both robots, and ``missing`` why there is none.
    """

    member: Member
    runs: int
    judged: int
    before: Score
    after: Score
    drift_before: Drift
    drift_after: Drift
    corrected: Recipe
    pulls: PullCheck | None = None
    missing: tuple[str, ...] = ()


def by_group(members: Sequence[Member], diagnosis: Diagnosis) -> tuple[Diagnosis, tuple[MemberResult, ...]]:
    """The diagnosis with each finding taken apart by group, and the result of each data set.

    Parameters
    ----------
    members : sequence of Member
        The data sets of the campaign.
    diagnosis : Diagnosis
        What :func:`slipmargin.diagnosis.loop.diagnose` found in their runs.
    """
    effects: tuple[AnyEffect, ...] = tuple(f.effect for f in diagnosis.findings)
    found = tuple(part for finding in diagnosis.findings for part in _apart(finding))
    results = tuple(_member(number, member, diagnosis, effects) for number, member in enumerate(members))
    return replace(diagnosis, findings=found), results


def shown_in(
    problem: Problem, runs: Sequence[int], members: Sequence[Member], found: tuple[Finding, ...]
) -> tuple[Finding, ...]:
    """The findings, each with its evidence from every data set of a campaign, in the order of these.

    ``runs`` is the number of the run that each trial of the problem is, or is cut from.
    """
    if not members or not found:
        return found
    everyone = np.arange(len(problem.trials), dtype=np.int64)
    effects = tuple(f.effect for f in found)
    sets = [effects, *((*effects[:i], *effects[i + 1 :]) for i in range(len(effects)))]
    with_all, *without = problem.residuals(sets, [everyone] * len(sets))
    of = [np.flatnonzero(problem.member_of == number) for number in range(len(members))]

    def chi(residual: Array, rows: Index) -> float:
        return float(np.sqrt(np.sum(residual[rows] ** 2) / max(1.0, problem.samples(rows))))

    return tuple(
        replace(
            finding,
            shown_by=tuple(
                ShownBy(
                    data_set=member.name,
                    runs=len({runs[i] for i in rows.tolist()}),
                    chi_without=chi(left, rows),
                    chi_with=chi(with_all, rows),
                )
                for member, rows in zip(members, of, strict=True)
            ),
        )
        for finding, left in zip(found, without, strict=True)
    )


def _apart(finding: Finding) -> list[Finding]:
    effect = finding.effect
    if not isinstance(effect, Confined):
        return [finding]
    several = len(effect.groups) > 1
    return [
        replace(
            finding,
            effect=own,
            group=group,
            parameters=_of_group(finding.parameters, group) if several else finding.parameters,
            derived=_of_group(finding.derived, group),
            shown_by=tuple(s for number, s in enumerate(finding.shown_by) if number in members),
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
    held = [t for t in own if t.held_out]
    judged = held or own
    corrected = member.recipe.with_effects(*acting(effects, number))
    pulls, missing = _pulls(member, corrected)
    drift_before, drift_after = _drifts(judged, diagnosis.noise)
    return MemberResult(
        member=member,
        runs=len({t.run for t in own}),
        judged=len({t.run for t in held}),
        before=_score(judged, [t.before for t in judged], diagnosis.noise),
        after=_score(judged, [t.after for t in judged], diagnosis.noise),
        drift_before=drift_before,
        drift_after=drift_after,
        corrected=corrected,
        pulls=pulls,
        missing=missing,
    )


def _pulls(member: Member, corrected: Recipe) -> tuple[PullCheck | None, tuple[str, ...]]:
    """The pull tests of a data set beside its robot before and after; why they could not be compared."""
    pulls, missing = member.pulls, list[str]()
    if pulls is None:
        return None, ()
    before, after = (recipe.build(member.surface) for recipe in (member.recipe, corrected))
    found = tried(
        f"the comparison with pulls of {member.name}", missing, lambda: pull_check(before, after, pulls)
    )
    return found, tuple(missing)


def _score(trials: list[TrialTrajectories], predicted: list[Array], sigma: Array) -> Score:
    gaps = [t.measured - p for t, p in zip(trials, predicted, strict=True)]
    gap = np.concatenate(gaps) if gaps else np.zeros((1, 3))
    x, y, turn = np.nanmean(gap**2, axis=0)
    return Score(
        rmse_position_m=float(np.sqrt(x + y)),
        rmse_heading_rad=float(np.sqrt(turn)),
        chi=float(np.sqrt(np.nanmean((gap / sigma) ** 2))),
    )


def _drifts(trials: list[TrialTrajectories], sigma: Array) -> list[Drift]:
    """Those of the model as it is and of the corrected one."""
    noise, offs, driven = SETTINGS.outlier_sigma * float(np.max(sigma[:2])), [], []
    for trial in trials:
        seen = np.isfinite(trial.measured).all(axis=1)
        path = body_path(trial.measured[seen])
        offs.append([body_path(pose[seen])[-1] - path[-1] for pose in (trial.before, trial.after)])
        driven.append(driven_m(path[:, :2], noise))
    off, distance = np.reshape(offs, (-1, 2, 3)), np.array(driven)
    far = distance > noise
    share = np.hypot(off[far, :, 0], off[far, :, 1]) / distance[far, None]
    return [Drift(displacement=_rms(share[:, k]), heading_rad=_rms(off[:, k, 2])) for k in (0, 1)]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else 0.0
