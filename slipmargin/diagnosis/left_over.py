"""What a structure leaves where no round of the search began with it: the list is made once more.

The judgement may keep only a part of what the search proposed, or something else; what the residual follows
then is no matter of the rounds before.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Index
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import evaluate
from slipmargin.diagnosis.left_out import folds
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.search import screened
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State
from slipmargin.diagnosis.telling import enough, telling
from slipmargin.diagnosis.watch import Watch


def like(state: State | None, rounds: Sequence[Round]) -> Round | None:
    """The last round that began with the candidates of ``state`` (None: with none), if there is one.

    A list of names alone is no round of that kind.
    """
    labels = set() if state is None else {c.label for c in state.structure}
    whole = [r for r in rounds if not r.names_only]
    return next((r for r in reversed(whole) if {c.label for c in r.before.structure} == labels), None)


def left_over(
    state: State,
    rounds: Sequence[Round],
    runs: Sequence[int],
    candidates: list[Candidate],
    seed: int,
    progress: Watch,
) -> Round:
    """A round that begins with ``state`` on the trials that were searched, and tries nothing.

    ``runs`` is the run that each trial of the problem is, or is cut from.  Where the searched trials held
    nothing but noise, so that there are no rounds, trials of all that are not quiet are taken, whether they
    were held out or not: what comes of it is never claimed.
    """
    trials = rounds[0].before.fit.trials if rounds else _loud(state)
    view = state.view.evened(state.fit.effects, trials)
    at = evaluate(view, state.structure, state.fit.x, trials)
    own = [runs[i] for i in trials]
    parts = tuple(folds(own, SETTINGS.folds))
    before = State(
        fit=at,
        scores=np.asarray(np.sum(at.residual**2, axis=1)),
        samples=view.samples(trials),
        view=view,
        parts=parts,
        xs=np.tile(at.x, (len(parts), 1)),
    )
    screening = screened(before, own, candidates, seed, progress)
    return Round(before=before, screening=screening, tried=(), best=None, taken=False)


def _loud(state: State) -> Index:
    everyone = np.arange(len(state.view.trials), dtype=np.int64)
    return enough(everyone, state.view.knots, telling(state.view, everyone))
