"""An effect that is known, stated otherwise: in another form, or over another definition of a quantity.

Which form of a law is meant shows once the other effects are known.  Definitions differ by less than what a
model far above the noise still lacks, so they are no candidates and are asked once all else is found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import spans
from slipmargin.diagnosis.refits import refitted
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good, choose
from slipmargin.diagnosis.watch import Watch


def restated(state: State, index: int, other: Candidate, runs: Sequence[int]) -> State:
    """The state with another candidate in the place of one; parameters that both have start as they are."""
    known, own = state.structure[index], spans(state.structure)
    at = dict(zip(known.keys, state.fit.x[own[index]], strict=True))
    start = [at.get(key, float(value)) for key, value in zip(other.keys, other.starts[0], strict=True)]
    kept = [state.fit.x[span] for span in own]
    kept[index] = np.clip(start, other.low, other.high)
    structure = (*state.structure[:index], other, *state.structure[index + 1 :])
    return refitted(state, structure, np.concatenate(kept), runs)


def reformed(state: State, runs: Sequence[int], candidates: Sequence[Candidate], progress: Watch) -> State:
    """The state with each effect but the last, whose forms its own round compares, in the form that is meant.

    A form with more parameters takes up what something else that is missing leaves: where nothing but noise
    is left, only those with fewer are asked.
    """
    for index, known in enumerate(state.structure[:-1]):
        tried, explained = [state], state.chi <= SETTINGS.noise_chi
        for other in candidates:
            if not other.is_other_form_of(known) or (explained and other.size >= known.size):
                continue
            if progress.expired:
                return state
            progress(f"fitting {other.label}", 0.0)
            tried.append(restated(state, index, other, runs))
        state = choose(sorted((s for s in tried if np.isfinite(s.chi)), key=lambda s: s.chi))
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
