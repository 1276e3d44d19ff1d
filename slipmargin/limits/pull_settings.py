"""Limits of pulls that each have an orientation, a direction, a point and a height of their own.

A setting is orientation φ [rad], direction [rad], point x, y in the body frame [m] (NaN: the centre of mass)
and height [m], as :meth:`slipmargin.data.pulls.Pulls.settings` gives them.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from slipmargin.checks import Array, Index
from slipmargin.limits.band import band
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit_or_zero
from slipmargin.model import Model
from slipmargin.physics.kinematics import KEPT


def setting_limits(model: Model, settings: Array, rigid: Array | None = None) -> Array:
    """F_emax (G,) [N] of settings (G, 5) in one contact state; 0 where the robot slips by itself."""
    found = np.empty(len(settings))
    for pull, rows in _alike(settings):
        found[rows] = limit_or_zero(model, settings[rows, 0], pull, rigid)
    return found


def setting_bands(model: Model, settings: Array) -> tuple[Array, Array]:
    """Lowest and highest F_emax (G,) [N] of settings over contact states."""
    found = np.empty((2, len(settings)))
    for pull, rows in _alike(settings):
        found[:, rows] = band(model, settings[rows, 0], pull)
    return found[0], found[1]


def _alike(settings: Array) -> tuple[tuple[Pull, Index], ...]:
    """Settings that differ in orientation alone, gathered: the pull and its rows."""
    return _gathered(np.asarray(settings, dtype=float).tobytes())


@lru_cache(maxsize=KEPT)
def _gathered(settings: bytes) -> tuple[tuple[Pull, Index], ...]:
    rest = np.nan_to_num(np.frombuffer(settings).reshape(-1, 5)[:, 1:], nan=np.inf)
    kinds, kind = np.unique(rest, axis=0, return_inverse=True)
    found = []
    for number, (direction, x, y, height) in enumerate(kinds):
        point = None if np.isinf(x) else np.array([x, y])
        pull = Pull(direction_rad=float(direction), point_m=point, height_m=float(height))
        found.append((pull, np.flatnonzero(kind.ravel() == number)))
    return tuple(found)
