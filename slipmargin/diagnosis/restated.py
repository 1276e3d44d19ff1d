"""An effect that is known, stated otherwise: in another form, by another name, or over another definition.

Which form of a law is meant, and which of the names that take off much of the same, shows once the other
effects are known.  Definitions differ by less than what a model far above the noise still lacks, so they are
no candidates and are asked once all else is found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import spans
from slipmargin.diagnosis.refits import refitted
from slipmargin.diagnosis.rounds import Round
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good, choose
from slipmargin.diagnosis.watch import Watch


def restated(state: State, index: int, other: Candidate, runs: Sequence[int]) -> State:
    """The state with another candidate in the place of one; parameters that both have start as they are."""
    at = dict(zip(state.structure[index].keys, state.fit.x[spans(state.structure)[index]], strict=True))
    start = [at.get(key, float(value)) for key, value in zip(other.keys, other.starts[0], strict=True)]
    return exchanged(state, index, other, np.clip(start, other.low, other.high), runs)


def exchanged(state: State, index: int, other: Candidate, x: Array, runs: Sequence[int]) -> State:
    """The state with another candidate, which starts at ``x``, in the place of one.

    It is not fitted to the end where it cannot come within reach of the state.
    """
    kept = [state.fit.x[span] for span in spans(state.structure)]
    kept[index] = x
    structure = (*state.structure[:index], other, *state.structure[index + 1 :])
    return refitted(state, structure, np.concatenate(kept), runs, SETTINGS.out_of_reach * state.fit.cost)


def reformed(
    state: State,
    runs: Sequence[int],
    candidates: Sequence[Candidate],
    rounds: Sequence[Round],
    progress: Watch,
    *,
    simpler: bool = False,
) -> State:
    """The state with each effect but the last, whose forms its own round compares, as what it is meant to be.

    It gives way to another name of its round as which it leaves less, and takes the form that is to be
    preferred.  A form with more parameters takes up what something else that is missing leaves: only those
    with fewer are asked with ``simpler``, and where nothing but noise is left, where no names are asked.
    """
    for index in range(len(state.structure) - 1):
        explained = state.chi <= SETTINGS.noise_chi
        if not explained:
            names = {s.last.label: s for r in rounds for s in r.instead_of(state.structure[index])}
            state = _renamed(state, index, list(names.values()), runs, progress)
        size = state.structure[index].size
        forms = [c for c in candidates if c.size < size or not (explained or simpler)]
        state = _in_best_form(state, index, forms, runs, progress)
    return state


def simplified(state: State, runs: Sequence[int], candidates: Sequence[Candidate], progress: Watch) -> State:
    """The state with each effect in a form with fewer parameters, where that is as good."""
    for index, known in enumerate(state.structure):
        state = _in_best_form(state, index, [c for c in candidates if c.size < known.size], runs, progress)
    return state


def unstuck(state: State, runs: Sequence[int], candidates: Sequence[Candidate], progress: Watch) -> State:
    """The state with each effect of which a parameter is stuck at a bound in another form that is as good.

    Such a parameter is one that these runs do not show, and the effect's name would not be claimed.
    """
    for index, known in enumerate(state.structure):
        if any(key.startswith(f"{known.label}.") for key in state.fit.at_bound()):
            state = _in_best_form(state, index, candidates, runs, progress)
    return state


def _in_best_form(
    state: State, index: int, candidates: Sequence[Candidate], runs: Sequence[int], progress: Watch
) -> State:
    """The state with one effect in the form, of those among ``candidates``, that is to be preferred."""
    known, tried = state.structure[index], [state]
    for other in candidates:
        if not other.is_other_form_of(known):
            continue
        if progress.expired:
            return state
        progress(f"fitting {other.label}", 0.0)
        tried.append(restated(state, index, other, runs))
    return choose(sorted((s for s in tried if np.isfinite(s.chi)), key=lambda s: s.chi))


def _renamed(state: State, index: int, names: Sequence[State], runs: Sequence[int], progress: Watch) -> State:
    """The state with the last effect of one of ``names`` in the place of one, where that leaves less."""
    kept = state
    for other in names:
        if any(c.is_same_as(other.last) for c in kept.structure):
            continue
        if progress.expired:
            break
        progress(f"fitting {other.last.label}", 0.0)
        found = exchanged(kept, index, other.last, other.fit.x[spans(other.structure)[-1]], runs)
        if np.isfinite(found.chi) and not as_good(state, found):
            state = found
    return state


def redefined(state: State, runs: Sequence[int], progress: Watch) -> State:
    """The state with each effect under the definition that predicts runs left out best.

    That of the effect as found is kept unless another leaves less beyond the spread of the runs.
    """
    for index, known in enumerate(state.structure):
        for other in known.definitions:
            if state.chi <= SETTINGS.noise_chi or progress.expired:
                return state
            progress(f"fitting {other.label}", 0.0)
            found = restated(state, index, other, runs)
            if np.isfinite(found.chi) and not as_good(state, found):
                state = found
    return state
