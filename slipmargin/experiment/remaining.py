"""What a diagnosis leaves open: the models that its runs cannot tell apart, each fitted to all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import final

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.data.data_set import DataSet
from slipmargin.data.repair import Repair
from slipmargin.diagnosis.attempt import Attempt
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.conditions import ready
from slipmargin.diagnosis.court import Checked
from slipmargin.diagnosis.fit import Fit, fit
from slipmargin.diagnosis.left_over import like
from slipmargin.diagnosis.problem import Problem
from slipmargin.diagnosis.result import Verdict
from slipmargin.diagnosis.rivals import can_be, instead_of
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.searched import Searched
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.watch import Watch
from slipmargin.effects import Trace

#: Gauss–Newton steps of the fits to all runs, which start where the search ended.
_STEPS = 8
#: So many explanations are compared at most: each pair of them is one more thing that runs must tell.
MOST = 4


class Question(Enum):
    """What the next runs are to answer."""

    WHICH = "which"  #: which of several explanations is right
    HOW_MUCH = "how-much"  #: how large the parameters of the one explanation are
    ANYTHING = "anything"  #: whether anything is missing that these runs could not show


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Remaining:
    """The explanations that are left, the best first, each fitted to every run.

    Parameters
    ----------
    problem : Problem
        The runs, in the view in which they were compared.
    fits : tuple of Fit
        The explanations; one without candidates is the model as believed.
    question : Question
        What is open.
    verdict : Verdict
        That of the diagnosis.
    candidates : tuple of Candidate
        Everything that the diagnosis tried.
    data_set : DataSet
        The runs as they were mended.
    was_cut : bool
        Whether time ended the search for explanations.
    """

    problem: Problem
    fits: tuple[Fit, ...]
    question: Question
    verdict: Verdict
    candidates: tuple[Candidate, ...]
    data_set: DataSet
    was_cut: bool = False

    @property
    def misfit(self) -> float:
        """What the best explanation leaves, times the noise [1]: 1 where it leaves nothing but noise."""
        best = self.fits[0]
        return float(np.sqrt(max(1.0, best.cost / max(1, int(np.count_nonzero(best.residual))))))


def remaining(data_set: DataSet, repairs: tuple[Repair, ...] | None, seed: int, progress: Watch) -> Remaining:
    """Diagnose the runs, and fit to all of them every explanation that is as good as the best.

    Parameters
    ----------
    data_set : DataSet
        In the frame in which diagnoses are computed.
    repairs : tuple of Repair, optional
        What was mended in it already.
    seed : int
        That of the diagnosis.
    progress : Watch
        Told what is being done.
    """
    progress("mending the data", 0.0)
    first = Attempt.of(ready(data_set, repairs, seed), seed, progress)
    best = first.with_white_noise() or first
    found, checked = best.searched, best.checked
    progress("fitting what is left to all runs", 0.0)
    question, problem, fits = _left(found, checked)
    return Remaining(
        problem=problem,
        fits=tuple(fits),
        question=question,
        verdict=checked.verdict,
        candidates=tuple(found.candidates),
        data_set=best.conditions.data_set,
        was_cut=best.was_cut,
    )


def _left(found: Searched, checked: Checked) -> tuple[Question, Problem, list[Fit]]:
    state, everyone = checked.state, np.arange(len(checked.problem.trials), dtype=np.int64)
    if state is None:
        rounds = [] if checked.near_noise else found.rounds
        view = checked.problem if not rounds else checked.problem.as_seen_in(rounds[0].before.view)
        believed = _fitted(view, (), np.zeros(0), everyone)
        leads = [_fitted(view, s.structure, s.fit.x, everyone) for s in _leads(rounds[:1])]
        fits = sorted(leads, key=lambda f: f.cost) if len(leads) > 1 else [*leads, believed]
        return (Question.WHICH if len(fits) > 1 else Question.ANYTHING), view, fits
    view = checked.problem.as_seen_in(state.view)
    best = _fitted(view, state.structure, state.fit.x, everyone)
    rivals = [_fitted(view, c, x, everyone) for c, x in _rivals(state, found.rounds)]
    rivals = [r for r in rivals if _as_good(r, best)]
    if not rivals and checked.after.chi() > SETTINGS.noise_chi:  # something else is missing as well
        last = like(state, found.rounds)
        rivals = [_fitted(view, s.structure, s.fit.x, everyone) for s in _leads([last] if last else [])]
    rivals.sort(key=lambda f: f.cost)
    question = Question.WHICH if rivals else Question.HOW_MUCH
    return question, view, [best, *rivals[: MOST - 1]]


def _fitted(view: Problem, structure: tuple[Candidate, ...], x: Array, trials: Index) -> Fit:
    return fit(view, structure, x, trials, iterations=_STEPS)


def _as_good(rival: Fit, best: Fit) -> bool:
    """Whether all runs together do not tell a rival from the best: the rule of the search, without folds."""
    samples = max(1, int(np.count_nonzero(best.residual)))
    one, two = (float(np.sqrt(f.cost / samples)) for f in (rival, best))
    return one <= max(two + SETTINGS.least_chi, SETTINGS.as_good_factor * two)


def _names(structure: Sequence[Candidate]) -> frozenset[str]:
    return frozenset(c.name for c in structure)


def _rivals(state: State, rounds: Sequence[Round]) -> list[tuple[tuple[Candidate, ...], Array]]:
    """Structures with other names that were as good as the one that holds, and where to start their fits."""
    found: dict[frozenset[str], tuple[tuple[Candidate, ...], Array]] = {}
    for index in range(len(state.structure)):
        for rival in instead_of(state, index, rounds):
            names = _names(rival.structure)
            if not names >= _names(state.structure) and can_be(state.view, rival.structure, rival.x):
                found.setdefault(names, (rival.structure, rival.x))
    return list(found.values())


def _leads(rounds: Sequence[Round]) -> list[State]:
    """The best fit over each variable in a round that settled nothing, best first."""
    if not rounds:
        return []
    before = rounds[0].before
    best: dict[Trace, State] = {}
    for state in sorted(rounds[0].tried, key=lambda s: s.chi):
        if rounds[0].single(state) and state.chi < (1.0 - SETTINGS.least_lead) * before.chi:
            best.setdefault(state.last.trace, state)
    return list(best.values())[:MOST]
