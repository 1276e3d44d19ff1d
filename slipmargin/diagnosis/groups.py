"""Candidates of a campaign: what each belongs to decides which data sets share its parameters.

What belongs to the machine is shared by all.  What belongs to a floor or an instrument is a candidate of its
own on each.  What belongs to a loading is free in all loadings together: a robot is never without loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.data_set import Member
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.effects import AnyEffect, Scope, Trace
from slipmargin.effects.confined import Confined

#: What a general form belongs to; all other variables are the floor's.
_SCOPES = {
    Trace.WHEEL: Scope.MACHINE,
    Trace.WHEEL_ANGLE: Scope.MACHINE,
    Trace.ACTUATION: Scope.MACHINE,
    Trace.WHEEL_LOAD: Scope.LOADING,
    Trace.MEASUREMENT: Scope.INSTRUMENT,
}


def scope_of(candidate: Candidate) -> Scope:
    """What a candidate belongs to."""
    return candidate.scope or _SCOPES.get(candidate.trace, Scope.FLOOR)


def groups_of(scope: Scope, members: Sequence[Member]) -> dict[str, frozenset[int]]:
    """The groups of a campaign that share what has this scope: their words and their members' numbers."""
    if scope is Scope.MACHINE:
        return {"": frozenset(range(len(members)))}
    words = [getattr(member, scope.value) for member in members]
    return {w: frozenset(i for i, other in enumerate(words) if other == w) for w in dict.fromkeys(words)}


def in_groups(candidates: Sequence[Candidate], members: Sequence[Member]) -> list[Candidate]:
    """The candidates, each in the groups that may differ; as they are where there is one data set."""
    found: list[Candidate] = []
    for candidate in candidates:
        scope = scope_of(candidate)
        groups = groups_of(scope, members)
        if len(groups) < 2:
            found.append(candidate)
        elif scope is Scope.LOADING:
            found.append(_confined(candidate, scope, groups))
        else:
            found += [_confined(candidate, scope, {word: own}) for word, own in groups.items()]
    return found


def _confined(candidate: Candidate, scope: Scope, groups: dict[str, frozenset[int]]) -> Candidate:
    many, size = len(groups), candidate.size
    prior = np.zeros((many * len(candidate.prior), many * size))
    for g in range(many):
        prior[g * len(candidate.prior) : (g + 1) * len(candidate.prior), g * size : (g + 1) * size] = (
            candidate.prior
        )
    where = next(iter(groups)) if many == 1 else "each"

    def build(values: Array) -> AnyEffect:
        made = tuple(candidate.build(part) for part in np.split(np.asarray(values), many))
        return Confined(
            effects=tuple(e for e in made if not isinstance(e, Confined)),
            members=tuple(groups.values()),
            groups=tuple(f"{scope.value} {word}" for word in groups),
        )

    def tiled(values: Array | None) -> Array:
        assert values is not None
        return np.tile(values, many)

    return replace(
        candidate,
        label=f"{candidate.label} in {scope.value} {where}",
        subject=f"{candidate.subject} in {scope.value} {where}" if candidate.subject else "",
        keys=tuple(
            k if many == 1 else f"{k} ({scope.value} {word})" for word in groups for k in candidate.keys
        ),
        units=candidate.units * many,
        null=tiled(candidate.null),
        scale=tiled(candidate.scale),
        low=tiled(candidate.low),
        high=tiled(candidate.high),
        usual=tiled(candidate.usual),
        meant=tiled(candidate.meant),
        least=tiled(candidate.least),
        starts=np.tile(candidate.starts, (1, many)),
        idle=np.tile(candidate.idle, many),
        prior=prior,
        build=build,
        definitions=tuple(_confined(other, scope, groups) for other in candidate.definitions),
    )
