"""Values of an unknown variable among which the extremes of a basis are found."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.variables import Basis, Variable

#: Samples with which an unknown variable's range is searched for the extreme factors.
SAMPLES = 361
#: A step is over this many widths of its edge away from it: to 1 part in 10¹⁷.
EDGES = 40.0
#: An unbounded basis (polynomial, odd) over an unknown variable is trusted to this many scales.
SCALES = 1.0


def span(basis: Basis, shape: Array, variable: Variable, count: int, samples: int = SAMPLES) -> Array:
    """Values (S,) over an unknown variable's range, which follows from the basis and its constants.

    Kinks, jumps and ends of ``count`` functions are among them, and some ``samples`` in between.
    """
    a, b = float(shape[0]), float(shape[1])
    if variable is Variable.SLIP_ANGLE:
        return np.linspace(0.0, np.pi / 2, samples)
    forward = variable is Variable.TIME  # time only runs forwards
    if basis is Basis.STEP:
        low = 0.0 if variable is Variable.FROM_PLACE or forward else a - EDGES * b
        return np.linspace(low, a + EDGES * b, samples)
    if basis is Basis.LOBE:  # of an angle
        return np.append(np.linspace(0.0, 2.0 * np.pi, samples), a)
    if basis is Basis.HATS:
        return np.union1d(np.linspace(a, b, samples), np.linspace(a, b, count))
    if basis is Basis.FOURIER:
        return np.linspace(0.0, abs(a), samples)
    if basis is Basis.WINDOW:
        return np.array([max(a, 0.0) if forward else a, 0.5 * (a + b), b + abs(b - a)])
    if basis in (Basis.DECAY, Basis.RECIPROCAL):
        return np.concatenate([np.linspace(0.0, 5.0 * abs(a), samples), [1e6 * abs(a)]])
    reach = SCALES * abs(a)
    return np.linspace(0.0 if forward else -reach, reach, samples)
