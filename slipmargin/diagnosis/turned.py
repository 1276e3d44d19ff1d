"""A diagnosis is computed in one frame, whatever axes the robot file has, and told in the file's axes.

Every sum and every solver rounds; in turned axes it rounds otherwise, and a search that compares candidates
carries that into the fifth digit.  So a data set in the convention of ROS is first turned by a quarter
into the paper's axes, which is exact, and what was found is turned back.  Two files of one run, one in either
convention, then give the same report to the last digit.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import DataSet
from slipmargin.data.pulls import Pulls
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.limits_change import MOTION_CURVES, PULL_CURVES, Limits, LimitsChange
from slipmargin.diagnosis.residual_diagnostics import ResidualDependence
from slipmargin.diagnosis.result import Diagnosis, Estimate, Finding, TrialTrajectories
from slipmargin.effects import Effect, Recipe
from slipmargin.effects.confined import bare
from slipmargin.effects.sliding_direction import MOST_FRICTION, SlidingDirection
from slipmargin.effects.turned import DIRECTION, axes_of, direction, effect_in, recipe_in, waves_in
from slipmargin.physics.convention import Convention
from slipmargin.robot.turned import quarter_rad, vectors

#: The frame of every diagnosis.
FRAME = Convention.PAPER
_SWAP = {"x": "y", "y": "x"}


def data_set_in(data_set: DataSet, new: Convention) -> DataSet:
    """The same runs and pulls in a convention; itself where it is in it already."""
    old = data_set.recipe.robot.convention
    if old is new:
        return data_set
    return replace(
        data_set,
        recipe=recipe_in(data_set.recipe, new),
        trials=tuple(replace(t, pose=vectors(t.pose, old, new)) for t in data_set.trials),
        members=tuple(replace(m, recipe=recipe_in(m.recipe, new)) for m in data_set.members),
        sigma=None if data_set.sigma is None else data_set.sigma[[1, 0, 2]],
        pulls=None if data_set.pulls is None else _pulls(data_set.pulls, old, new),
    )


def _pulls(pulls: Pulls, old: Convention, new: Convention) -> Pulls:
    along = np.zeros(len(pulls.phi_rad)) if pulls.direction_rad is None else pulls.direction_rad
    return replace(
        pulls,
        direction_rad=along + quarter_rad(old, new),
        point_m=None if pulls.point_m is None else vectors(pulls.point_m, old, new),
    )


def diagnosis_in(found: Diagnosis, recipe: Recipe) -> Diagnosis:
    """A diagnosis in the axes of the robot file, whose recipe it is; itself where they are the frame's."""
    old, new = found.recipe.robot.convention, recipe.robot.convention
    if old is new:
        return found
    believed, corrected = (
        replace(recipe_in(r, new), robot=recipe.robot) for r in (found.recipe, found.corrected)
    )
    return replace(
        found,
        recipe=believed,
        corrected=corrected,
        noise=found.noise[[1, 0, 2]],
        findings=tuple(_finding(f, old, new) for f in found.findings),
        trials=tuple(_trial(t, old, new) for t in found.trials),
        where=tuple(_dependence(d) for d in found.where),
        where_after=tuple(_dependence(d) for d in found.where_after),
        events=tuple(replace(e, channel=_SWAP.get(e.channel, e.channel)) for e in found.events),
        repairs=tuple(_repair(r) for r in found.repairs),
    )


def _trial(trial: TrialTrajectories, old: Convention, new: Convention) -> TrialTrajectories:
    measured, before, after = (vectors(p, old, new) for p in (trial.measured, trial.before, trial.after))
    return replace(trial, measured=measured, before=before, after=after)


def _dependence(found: ResidualDependence) -> ResidualDependence:
    """What the residual depends on, named by the axes of the file."""
    return replace(found, variable=_swapped("position", found.variable))


def _repair(repair: Repair) -> Repair:
    """A repair whose sentence names the axes of the file."""
    return replace(repair, sentence=_swapped("in", repair.sentence))


def _swapped(after: str, said: str) -> str:
    """Words in which an axis that stands ``after`` a word is the other one."""
    return re.sub(rf"\b{after} ([xy])\b", lambda m: f"{after} {_SWAP[m[1]]}", said)


def _finding(finding: Finding, old: Convention, new: Convention) -> Finding:
    effect = bare(finding.effect)
    turned = replace(finding, effect=effect_in(finding.effect, old, new))
    if not isinstance(effect, Effect):
        return turned  # its coefficients have no axes in the report; those of the corrected file are turned
    return replace(
        turned,
        parameters=_estimates(finding.parameters, effect, old, new),
        derived=_estimates(finding.derived, effect, old, new),
    )


def _estimates(
    estimates: Sequence[Estimate], effect: Effect, old: Convention, new: Convention
) -> tuple[Estimate, ...]:
    """Estimates along the file's axes, in the order of the effect's parameters."""
    names: dict[str, tuple[str, bool]] = {}
    for x, y, factors in axes_of(effect):
        for name, unit in ((x, [1.0, 0.0]), (y, [0.0, 1.0])):
            there = vectors(np.array(unit), old, new)
            names[name] = (x if there[0] else y, bool(there.sum() < 0.0) and not factors)
    way, repeats = DIRECTION, 1
    if isinstance(effect, SlidingDirection):
        way, repeats = MOST_FRICTION, effect.repeats
        names |= waves_in(effect, old, new)
    out = []
    for e in estimates:
        key, of, group = e.name.partition(" (")  # in a campaign each group has its own
        name, reverse = names.get(key, (key, False))
        if reverse:
            e = replace(e, value=0.0 - e.value, low=0.0 - e.high, high=0.0 - e.low)
        if key == way:
            shift = direction(e.value, old, new, repeats) - e.value
            e = replace(e, value=e.value + shift, low=e.low + shift, high=e.high + shift)
        out.append((group, name, replace(e, name=f"{name}{of}{group}")))
    order = {p.name: k for k, p in enumerate(effect.parameters)}
    groups = list(dict.fromkeys(group for group, _, _ in out))
    out.sort(key=lambda row: (groups.index(row[0]), order.get(row[1], len(order))))
    return tuple(e for _, _, e in out)


def change_in(change: LimitsChange, new: Convention) -> LimitsChange:
    """Limits over orientation and direction, counted in the axes of a convention."""
    old = change.convention
    if old is new:
        return change
    turn = quarter_rad(old, new)
    # A pull along the floor's +x at heading φ comes from −φ in the body's axes: it turns the other way.
    return replace(
        change,
        convention=new,
        before=_limits(change.before, turn),
        after=_limits(change.after, turn),
    )


def _limits(limits: Limits, turn: float) -> Limits:
    def rolled(name: str, way: float) -> Array:
        values: Array = getattr(limits, name)
        return np.roll(values, round(way / (2.0 * np.pi) * len(values)))

    curves: dict[str, Any] = {name: rolled(name, -turn) for name in PULL_CURVES}
    curves |= {name: rolled(name, turn) for name in MOTION_CURVES}
    return replace(limits, **curves)
