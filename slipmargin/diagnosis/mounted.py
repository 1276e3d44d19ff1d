"""Cameras of one campaign that are turned against each other, told from runs that drive alike under both.

What a model still lacks turns the tracks of runs by some degrees, more than a camera mounted anew, and
by another angle in each direction of travel: one recording alone says little about its camera.  But two runs
that drive alike lack the same.  What remains between them and is the same whichever way they drive is no
force: robot and floor, mirrored, would turn tracks the other way.  So each run is compared with that under
another camera in which the wheels turned most nearly in the same proportions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ttest_1samp

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import Member
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.court import Checked, Court, better
from slipmargin.diagnosis.fit import evaluate
from slipmargin.diagnosis.groups import in_groups
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.refits import refitted
from slipmargin.diagnosis.result import Rejected
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.effects.confined import Confined
from slipmargin.model import Model
from slipmargin.sim.signal import angles_at


def rotations_of(model: Model, members: Sequence[Member]) -> tuple[Candidate, ...]:
    """A rotation of each camera of a campaign, beside any that is declared; none where there is one."""
    named = named_candidates(model.geometry.names, False, ())
    grouped = in_groups([c for c in named if c.turns_all_ways], members)
    return tuple(c for c in grouped if _members(c))


def turned_cameras(court: Court, held: Checked, rejected: list[Rejected]) -> Checked:
    """What holds, with the camera that is most clearly turned against the others; as it is where none is."""
    state, rotations = held.state, court.rotations
    if state is None or not rotations or state.things & {c.thing for c in rotations}:
        return held
    level = SETTINGS.significance / (len(rotations) - 1)  # so many differences are there
    tried = [  # pairs say how far two cameras are apart, and the fit which of them it is
        refitted(state, (*state.structure, c), np.append(state.fit.x, angle), court.seen_runs)
        for (p_value, angle), c in zip(turned(state, rotations, court.seen), rotations, strict=True)
        if p_value <= level
    ]
    if not tried:
        return held
    return better(court, held, min(tried, key=lambda s: s.chi), rejected) or held


def turned(state: State, rotations: Sequence[Candidate], trials: Index) -> list[tuple[float, float]]:
    """For each camera, how likely luck turns its runs as much against the others', and the angle [rad]."""
    structure = (*state.structure, *rotations)
    x = np.concatenate([state.fit.x, *(c.null for c in rotations)])
    at = evaluate(state.view, structure, x, trials)
    slope = at.jacobian[..., len(state.fit.x) :].sum(axis=-1)
    angle = -np.sum(slope * at.residual, axis=1) / np.maximum(np.sum(slope**2, axis=1), 1e-300)
    ways = _directions(state.view, trials)
    own = state.view.member_of[trials]
    return [_apart(angle, ways @ ways.T, np.isin(own, list(_members(c)))) for c in rotations]


def _apart(angle: Array, alike: Array, inside: NDArray[np.bool_]) -> tuple[float, float]:
    """Probability and mean of how angles (R,) differ in runs ``inside`` from those most ``alike``."""
    mine, others = np.flatnonzero(inside), np.flatnonzero(~inside)
    nearest = others[np.argmax(alike[np.ix_(mine, others)], axis=1)]
    near = alike[mine, nearest] >= SETTINGS.alike_runs
    mine, nearest = mine[near], nearest[near]
    # Runs beside one and the same share its accident: together they are one observation.
    apart = np.array([np.mean(angle[mine[nearest == j]]) - angle[j] for j in np.unique(nearest)])
    if len(apart) < SETTINGS.few_unseen or not np.any(apart):
        return 1.0, 0.0
    return float(ttest_1samp(apart, 0.0).pvalue), float(np.mean(apart))


def _members(candidate: Candidate) -> frozenset[int]:
    """The data sets in which a candidate acts; none where it acts in all."""
    effect = candidate.build(candidate.starts[0])
    return frozenset[int]().union(*effect.members) if isinstance(effect, Confined) else frozenset()


def _directions(problem: Problem, trials: Index) -> Array:
    """Which way each trial drives: how its wheels turned from begin to end (R, N), of length one."""
    signals = [problem.signals[i] for i in trials]
    way = np.array([np.diff(angles_at(s, s.knots_s[[0, -1]]), axis=0)[0] for s in signals])
    return np.asarray(way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-300))
