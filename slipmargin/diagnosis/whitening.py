"""Whitening: residuals divided by their noise, and freed of the part of it that lasts.

The noise of a channel is white noise plus noise of first order (Ornstein-Uhlenbeck: it fades by 1/e in its
time).  A Kalman filter predicts the lasting part from the samples before; what a sample adds to that, over
its standard deviation, is independent of all others (the innovations form; Harvey, Forecasting, Structural
Time Series Models and the Kalman Filter, 1989, section 3.4).  The filter is linear, so that it may be
applied to a residual and to the directions that are projected off it alike.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.data.noise import LastingNoise
from slipmargin.physics.compiled import fast


@fast
def _innovations(
    values: Array, seen: NDArray[np.bool_], keep: float, white: float, lasting: float, out: Array
) -> None:
    """Whitened ``values`` (R, T) of variance ``white`` + ``lasting``; 0 where nothing was seen."""
    for r in range(values.shape[0]):
        level, spread = 0.0, lasting
        for k in range(values.shape[1]):
            if seen[r, k]:
                total = spread + white
                new = values[r, k] - level
                out[r, k] = new / np.sqrt(total)
                gain = spread / total
                level += gain * new
                spread *= 1.0 - gain
            else:
                out[r, k] = 0.0
            level *= keep
            spread = keep * keep * spread + (1.0 - keep * keep) * lasting


def whitened(
    values: Array, seen: NDArray[np.bool_], sigma: float, lasting: LastingNoise, axis: int, step_s: float
) -> Array:
    """Residuals or directions (R, T) of one channel, whitened.

    Parameters
    ----------
    values : array (R, T)
        In the units of ``sigma``, a sample every ``step_s``.
    seen : array (R, T) of bool
        Which samples exist.
    sigma : float
        Standard deviation of the whole noise.
    lasting : LastingNoise
        The part of it that lasts; ``axis`` says whose.
    """
    share = float(lasting.share[axis])
    out = np.empty(values.shape)
    keep = float(np.exp(-step_s / lasting.time_s[axis]))
    _innovations(
        np.ascontiguousarray(values),
        np.ascontiguousarray(seen),
        keep,
        (1.0 - share) * sigma**2,
        share * sigma**2,
        out,
    )
    return out
