"""The noise of the measured pose: how large it is, and how long it lasts.

White noise is what a sample misses the smooth curve through its neighbours by.  Noise that lasts (a marker
that is recognised a little beside its place, and again so in the next frame) moves neighbours together and
is not seen that way.  It is read where the robot stands: all motion there is noise.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.record import Record

#: Neighbours of a sample that its curve goes through: two make a line, four a cubic.
_LINE, _CUBIC = (-1, 1), (-2, -1, 1, 2)


def white_noise(records: tuple[Record, ...]) -> Array:
    """Standard deviation (3,) of x [m], y [m], φ [rad], from neighbours that smooth motion cannot explain.

    Each sample is compared with the curve through its neighbours; the spread of that difference is
    σ √(1 + Σ w²), w the neighbours' weights.  The median makes it robust against outliers and against short
    hard accelerations.  A line sees curved motion as noise and a cubic hardly; the smaller one counts.
    """
    found = np.empty(3)
    for axis in range(3):
        spreads = []
        steps = np.zeros(0)
        for around in (_LINE, _CUBIC):
            misses = np.concatenate([np.abs(_against_neighbours(r, axis, around)) for r in records])
            if not len(misses):
                continue
            spreads.append(1.4826 * float(np.median(misses)))
            steps = misses[misses > 0.0] if around == _LINE else steps
        if not spreads:
            found[axis] = 1e-3
            continue
        spread = min(spreads)
        if spread == 0.0:  # a coarse sensor repeats its value: its step is the noise
            spread = float(np.min(steps)) if len(steps) else 1e-6
        found[axis] = max(spread, 1e-9)
    return found


def _against_neighbours(record: Record, axis: int, around: tuple[int, ...]) -> Array:
    """Each inner sample that is known minus the curve through known neighbours, per √(1 + Σ w²)."""
    known = np.isfinite(record.pose[:, axis])
    t, value = record.t_s[known], record.pose[known, axis]
    edge = max(around)
    if len(t) < 2 * edge + 1:
        return np.zeros(0)
    inner = np.arange(edge, len(t) - edge)
    at = t[inner]
    curve, power = np.zeros(len(inner)), np.ones(len(inner))
    for j in around:
        weight = np.ones(len(inner))
        for m in around:
            if m != j:
                weight *= (at - t[inner + m]) / (t[inner + j] - t[inner + m])
        curve += weight * value[inner + j]
        power += weight**2
    return np.asarray((value[inner] - curve) / np.sqrt(power))
