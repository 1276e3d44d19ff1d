"""Intervals of fitted parameters from whole trials, and how well the data excite the model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.diagnosis.fit import Fit

#: Coverage of the intervals.
_SURE = 0.95


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Intervals:
    """Intervals of the parameters: ``low`` and ``high`` (P,), ``deviation`` (P,) 1 s.d.

    ``excitation`` (P,) are the singular values of the whitened Jacobian per unit of scale: a small
    one is a direction in which these trials say nothing.
    """

    low: Array
    high: Array
    deviation: Array
    excitation: Array


def intervals(found: Fit, leave_one_out: Array, scale: Array, log_shift: Array) -> Intervals:
    """Intervals from whole trials, 95 % for each parameter.

    The inverse normal matrix (times the reduced χ² where that is above 1) is widened by what the trials
    scatter beyond their noise (:func:`_disagreement`): noise that is stated wrong or correlated in time, a
    form that is only approximate, or trials that differ make them scatter more.  A test says whether they
    do; where it says no, that does not show that they agree, so that the widening stays.  Where it says
    yes, the jackknife over trials, √((R−1)/R Σ (x₋ᵢ − x̄)²), is taken if it is larger, with Student's t
    of R − 1 degrees of freedom.

    Parameters
    ----------
    found : Fit
        The fit on R trials.
    leave_one_out : array (R, P)
        Parameters fitted without each trial.
    scale : array (P,)
        Units of the parameters.
    log_shift : array (P,)
        How far they move when the wheels' motion between samples is rebuilt another way that may be right.
    """
    from scipy.special import ndtri, stdtrit

    count, size = leave_one_out.shape
    flat = found.jacobian.reshape(-1, size) * scale
    deviation = deviations(found, scale)
    sure = 0.5 * (1.0 + _SURE)
    quantile = float(ndtri(sure))
    apart, agree = _disagreement(found, scale)
    wider = np.sqrt(deviation**2 + apart**2)
    if not agree and count > 1:
        spread = leave_one_out - leave_one_out.mean(axis=0)
        jackknife = np.sqrt((count - 1) / count * np.sum(spread**2, axis=0))
        wider = np.maximum(wider, jackknife)
        quantile = float(stdtrit(count - 1, sure))
    deviation = np.sqrt(wider**2 + log_shift**2)
    return Intervals(
        low=found.x - quantile * deviation,
        high=found.x + quantile * deviation,
        deviation=deviation,
        excitation=np.asarray(np.linalg.svd(flat, compute_uv=False)),
    )


def deviations(found: Fit, scale: Array) -> Array:
    """Standard deviations (P,) where the trials agree within their noise, times the reduced χ² above 1."""
    flat = found.jacobian.reshape(-1, len(scale)) * scale
    seen = int(np.count_nonzero(found.residual))
    reduced = max(1.0, found.cost / max(1, seen - len(scale)))
    covariance = np.linalg.pinv(flat.T @ flat) * reduced
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 0.0)) * scale)


def _disagreement(found: Fit, scale: Array) -> tuple[Array, bool]:
    """What trials that each have a parameter of their own add to its standard deviation (P,), if they do.

    One trial may weigh as much as all others together; the jackknife then hardly sees that they
    disagree.  The variance between trials is estimated from what every trial would move the
    parameters by alone (R. DerSimonian and N. Laird, Controlled Clinical Trials 7, 177, 1986), in the
    combinations of them that the trials together determine, and reaches the joint fit with the
    weights that the trials have in it.  The sum of their Q, which is χ² with P (R − 1) degrees of freedom
    where the trials agree within the noise, says whether they agree (5 %).
    """
    from scipy.special import chdtri

    tangents = found.jacobian * scale
    normal = np.einsum("rkp,rkq->rpq", tangents, tangents)
    size, axes = np.linalg.eigh(normal.sum(axis=0))
    known = size > 1e-12 * size[-1]
    basis = axes[:, known] / np.sqrt(size[known])  # whitens the sum: its columns are the combinations
    weight = np.einsum("pz,rpq,qy->rzy", basis, normal, basis)  # adds up to the unit matrix
    pull = np.einsum("pz,rkp,rk->rz", basis, tangents, found.residual)
    own = np.maximum(np.einsum("rzz->rz", weight), 1e-300)
    scatter = np.sum(pull**2 / own, axis=0)
    freedom = len(own) - 1
    agree = bool(freedom < 1 or scatter.sum() <= chdtri(freedom * len(scatter), 1.0 - _SURE))
    between = np.maximum(0.0, scatter - freedom) / np.maximum(1.0 - np.sum(own**2, axis=0), 1e-300)
    covariance = np.einsum("rzy,y,rxy->zx", weight, between, weight)
    apart = np.sqrt(np.maximum(np.einsum("pz,zx,px->p", basis, covariance, basis), 0.0)) * scale
    return np.asarray(apart), agree
