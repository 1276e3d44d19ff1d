"""Candidates that pulls can show: all effects and general forms that move a static limit."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate, named_candidates
from slipmargin.diagnosis.forms import Ranges
from slipmargin.diagnosis.general_forms import general_candidates
from slipmargin.diagnosis.pull_problem import PullProblem, expectation
from slipmargin.diagnosis.settings import PULLS
from slipmargin.errors import InputError, NoSolution
from slipmargin.physics.terms import AGAINST
from slipmargin.physics.variables import Variable

#: What a robot at rest shows nothing of: a pull does not say where, when or at which wheel angle it was.
_UNKNOWN = frozenset(
    {
        Variable.WHEEL_ANGLE,
        Variable.SLIP_ANGLE,
        Variable.POSITION_X,
        Variable.POSITION_Y,
        Variable.TIME,
    }
)


def pull_candidates(problem: PullProblem) -> list[Candidate]:
    """Named effects and general forms that these pulls can show, each with a different prediction.

    One that depends on what a pull does not know (place, time, wheel angle other than by sectors), one
    of whose parameters moves no limit, and a second form of an effect that predicts the same, are left out.
    """
    known = tuple(effect.name for effect in problem.recipe.effects)
    model = problem.model(())
    still = Ranges(  # no motion: these only scale forms that a robot at rest does not show
        speed_m_s=1.0,
        slip_m_s=1.0,
        acceleration_m_s2=1.0,
        yaw_rate_rad_s=1.0,
        position_m=1.0,
        middle_m=(0.0, 0.0),
        duration_s=1.0,
        command_rad_s=1.0,
    )
    found: list[Candidate] = []
    shown: list[tuple[str, Array]] = []
    for candidate in [
        *named_candidates(model.geometry.names, False, known, {"body": model.geometry.reach_m}),
        *general_candidates(model, still, False),
    ]:
        moves = _moves(problem, candidate)
        if moves is None or any(name == candidate.name and _equal(moves, other) for name, other in shown):
            continue
        shown.append((candidate.name, moves))
        found.append(candidate)
    return found


def _equal(one: Array, other: Array) -> bool:
    return one.shape == other.shape and bool(
        np.allclose(one, other, rtol=0.0, atol=PULLS.moves * np.abs(one).max())
    )


def _moves(problem: PullProblem, candidate: Candidate) -> Array | None:
    """How far (P, G) each parameter moves what pulls are expected to need; None where one moves nothing.

    The contact state is taken as unknown, so that shares of rigid material count wherever wheels stand.
    """

    def mean(x: Array) -> Array:
        model = problem.model((candidate.build(x),))
        return expectation(model, problem.settings, problem.everyone, None).mean_N

    for start in candidate.starts:
        x = np.where(start == candidate.null, start + 0.5 * candidate.scale, start)
        x = np.clip(x, candidate.low, candidate.high)
        step = np.where(x + candidate.scale <= candidate.high, candidate.scale, -candidate.scale)
        try:
            if unseen(problem, candidate, x):
                return None
            there = mean(x)
            moved = np.array([mean(x + own) - there for own in np.diag(step)])
        except (InputError, NoSolution):
            continue
        return moved if bool(np.all(np.abs(moved).max(axis=1) > PULLS.moves * np.abs(there).max())) else None
    return None


def unseen(problem: PullProblem, candidate: Candidate, x: Array) -> bool:
    """Whether a candidate depends on a variable that a pull does not know."""
    base, changed = problem.model(()), problem.model((candidate.build(x),))
    factors = changed.grip.multipliers[len(base.grip.multipliers) :]
    forces = changed.external.terms[len(base.external.terms) :]
    return (
        any(factor.variable in _UNKNOWN for factor in factors)
        or any(force.variable in _UNKNOWN for force in forces)
        or any(force.frame in AGAINST for force in forces)
    )
