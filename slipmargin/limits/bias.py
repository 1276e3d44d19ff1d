"""Forces on a robot at rest that are neither the pull nor friction: slope, tether, what losses hold.

Terms against the motion and terms of a velocity are zero at rest.  Rolling resistance can hold a robot,
but never moves it; leaving it out keeps the limit on the safe side.
"""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.friction import span
from slipmargin.model import Model
from slipmargin.physics.terms import ForceTerm
from slipmargin.physics.variables import Frame, Variable

_UNKNOWN = (Variable.POSITION_X, Variable.POSITION_Y, Variable.TIME)


def bias_wrench(model: Model, phi_rad: Array) -> Array:
    """(M, 3) wrench of the losses at rest, body frame; unknown variables at v = 0 [N, N, N m]."""
    total = np.zeros((len(phi_rad), 3))
    for term in model.external.terms:
        if term.frame is not Frame.AGAINST_MOTION:
            v = phi_rad if term.variable is Variable.HEADING else np.zeros(len(phi_rad))
            total += _to_body(term.wrench(v), term.frame, phi_rad)
    return total


def bias_extremes(model: Model, phi_rad: Array, normals: Array) -> tuple[Array, Array]:
    """Least and greatest n·w of the bias over what cannot be known (place, time).

    Parameters
    ----------
    normals : (K, 3)

    Returns
    -------
    two (M, K)
        Relative to :func:`bias_wrench`: both zero where no term depends on place or time.
    """
    low = np.zeros((len(phi_rad), len(normals)))
    high = np.zeros_like(low)
    for variable in _UNKNOWN:
        terms = _unknown_terms(model, variable)
        if terms:
            across = np.stack([_along(terms, v, phi_rad, normals) for v in _grid(terms, variable)])
            rest = _along(terms, 0.0, phi_rad, normals)
            low += across.min(axis=0) - rest
            high += across.max(axis=0) - rest
    return low, high


def bias_samples(model: Model, phi_rad: Array, points: int = 5) -> list[Array]:
    """Bias wrenches (M, 3) at values spread over what cannot be known; the one at v = 0 comes first."""
    out = [bias_wrench(model, phi_rad)]
    for variable in _UNKNOWN:
        terms = _unknown_terms(model, variable)
        if terms:
            grid = _grid(terms, variable)
            values = grid[np.linspace(0, len(grid) - 1, points).astype(int)]
            rest = _along(terms, 0.0, phi_rad, np.eye(3))
            change = [_along(terms, float(v), phi_rad, np.eye(3)) - rest for v in (0.0, *values)]
            out = [w + step for w in out for step in change]
    return out


def _unknown_terms(model: Model, variable: Variable) -> list[ForceTerm]:
    return [t for t in model.external.terms if t.variable is variable and t.frame is not Frame.AGAINST_MOTION]


def _along(terms: list[ForceTerm], v: float, phi_rad: Array, normals: Array) -> Array:
    wrench = np.zeros((len(phi_rad), 3))
    for term in terms:
        still = np.broadcast_to(term.wrench(np.array([v])), wrench.shape)
        wrench += _to_body(still, term.frame, phi_rad)
    return np.asarray(wrench @ normals.T)


def _grid(terms: list[ForceTerm], variable: Variable) -> Array:
    return np.unique(np.concatenate([np.zeros(1), *(span(t.basis, t.shape, variable)[::12] for t in terms)]))


def _to_body(wrench: Array, frame: Frame, phi_rad: Array) -> Array:
    if frame is Frame.BODY:
        return wrench
    c, s = np.cos(phi_rad), np.sin(phi_rad)
    x, y = wrench[:, 0], wrench[:, 1]
    return np.stack([c * x + s * y, c * y - s * x, wrench[:, 2]], axis=1)
