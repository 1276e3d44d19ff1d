"""What a quantity that an effect acts over is taken to be, asked once all else is found.

Definitions differ by less than what a model far above the noise still lacks, so they are no candidates.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from slipmargin.diagnosis.search import refitted
from slipmargin.diagnosis.settings import SETTINGS
from slipmargin.diagnosis.state import State, as_good
from slipmargin.diagnosis.watch import Watch


def redefined(state: State, runs: Sequence[int], progress: Watch) -> State:
    """The state with each effect under the definition that predicts runs left out best.

    That of the effect as found is kept unless another leaves less beyond the spread of the runs.
    """
    for index, known in enumerate(state.structure):
        for other in known.definitions:
            if state.chi <= SETTINGS.noise_chi or progress.expired:
                return state
            progress(f"fitting {other.label}", 0.0)
            structure = (*state.structure[:index], other, *state.structure[index + 1 :])
            found = refitted(state, structure, state.fit.x, runs)
            if np.isfinite(found.chi) and not as_good(state, found):
                state = found
    return state
