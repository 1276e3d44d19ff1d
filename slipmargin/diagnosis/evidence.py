"""Intervals of fitted parameters from whole trials, and whether an effect may do nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from slipmargin.checks import Array
from slipmargin.diagnosis.candidate import Candidate
from slipmargin.diagnosis.fit import Fit, limits_of
from slipmargin.diagnosis.left_out import leave_one_out
from slipmargin.diagnosis.settings import SETTINGS

#: What trials say of a direction, as a share of what they say most of, that is nothing but rounding.
_UNKNOWN = 1e-12


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Intervals:
    """Intervals of the parameters: ``low`` and ``high`` (P,), ``quantile`` times ``deviation`` (P,) away, or
    at a bound; a parameter of which no trial says anything has infinite ones.

    ``covariance`` (P, P) belongs to the deviations; ``freedom`` is that of their estimate: the trials less 1
    where trials disagree, infinite where their noise explains how they differ.  ``excitation`` (P,) are the
    singular values of the whitened Jacobian per unit of scale: a small one is a direction in which these
    trials say nothing.
    """

    low: Array
    high: Array
    deviation: Array
    quantile: float
    covariance: Array
    freedom: float
    excitation: Array

    def may_do_nothing(self, candidate: Candidate, x: Array, span: slice) -> bool:
        """Whether these trials leave it open (at 95 %) that one effect of the structure does nothing.

        Each of its parameters may be uncertain although together they are not: the share of rigid material
        and its coefficient, a force and the place at which it acts.  So the effect is taken away as a whole.
        The parameters that have no influence then stay where they were fitted, and the distance is measured
        by the covariance (Hotelling's T², which is χ² where the freedom is infinite).  The place of an effect
        was chosen too: all of its parameters count.

        Parameters
        ----------
        candidate : Candidate
            The effect.
        x : array (P,)
            Fitted parameters of the whole structure.
        span : slice
            Which of them are this effect's.
        """
        from scipy.special import chdtri, fdtri

        acts = ~candidate.idle
        away = (x[span] - candidate.null)[acts] / candidate.scale[acts]
        own = self.covariance[span, span] / np.outer(candidate.scale, candidate.scale)
        distance = float(away @ np.linalg.pinv(own)[np.ix_(acts, acts)] @ away)
        size, left = candidate.size, self.freedom - candidate.size + 1
        level = SETTINGS.interval_level
        if np.isinf(self.freedom):
            return distance <= float(chdtri(size, 1.0 - level))
        return left < 1 or distance <= size * self.freedom / left * float(fdtri(size, left, level))


def intervals(found: Fit, log_shift: Array | None = None) -> Intervals:
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
    log_shift : array (P,), optional
        How far the parameters move when the wheels' motion between samples is rebuilt another way that may be
        right; by default not at all.
    """
    from scipy.special import ndtri, stdtrit

    scale, alone = limits_of(found.structure)[-1], leave_one_out(found)
    count, size = alone.shape
    moved = np.zeros(size) if log_shift is None else log_shift
    flat = found.jacobian.reshape(-1, size) * scale
    sure = 0.5 * (1.0 + SETTINGS.interval_level)
    quantile, freedom = float(ndtri(sure)), np.inf
    apart, agree = _disagreement(found, scale)
    covariance = _covariance(found, scale) + apart
    together = _deviations(covariance)
    wider = together
    if not agree and count > 1:
        spread = alone - alone.mean(axis=0)
        jackknife = np.sqrt((count - 1) / count * np.sum(spread**2, axis=0))
        wider, freedom = np.maximum(wider, jackknife), float(count - 1)
        quantile = float(stdtrit(count - 1, sure))
    deviation = np.where(_unseen(flat), np.inf, np.sqrt(wider**2 + moved**2))
    widened = np.divide(wider, together, out=np.ones(size), where=together > 0.0)
    return Intervals(
        low=found.x - quantile * deviation,
        high=found.x + quantile * deviation,
        deviation=deviation,
        quantile=quantile,
        covariance=covariance * np.outer(widened, widened) + np.diag(moved**2),
        freedom=freedom,
        excitation=np.asarray(np.linalg.svd(flat, compute_uv=False)),
    )


def _unseen(flat: Array) -> NDArray[np.bool_]:
    """Which parameters (P,) lie in directions of which the Jacobian ``flat`` (R K, P) says nothing."""
    _, axes, known = _directions(flat.T @ flat)
    return np.asarray(np.sum(axes[:, ~known] ** 2, axis=1) > _UNKNOWN)


def _directions(normal: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """How much trials say (P,) of each direction (columns, P × P), and whether it is more than rounding."""
    size, axes = np.linalg.eigh(normal)
    return size, axes, size > _UNKNOWN * size[-1:]


def deviations(found: Fit, scale: Array) -> Array:
    """Standard deviations (P,) where the trials agree within their noise, times the reduced χ² above 1."""
    return _deviations(_covariance(found, scale))


def _deviations(covariance: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance), 0.0)))


def _covariance(found: Fit, scale: Array) -> Array:
    flat = found.jacobian.reshape(-1, len(scale)) * scale
    seen = int(np.count_nonzero(found.residual))
    reduced = max(1.0, found.cost / max(1, seen - len(scale)))
    size, axes, known = _directions(flat.T @ flat)
    # A direction of which no trial says anything is as uncertain as numbers can tell beside the others.
    size = np.maximum(np.where(known, size, _UNKNOWN * size[-1:]), 1e-300)
    return np.asarray((axes / size) @ axes.T * reduced * np.outer(scale, scale))


def _disagreement(found: Fit, scale: Array) -> tuple[Array, bool]:
    """What trials with parameters of their own add to the covariance (P, P), and whether they agree.

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
    size, axes, known = _directions(normal.sum(axis=0))
    basis = axes[:, known] / np.sqrt(size[known])  # whitens the sum: its columns are the combinations
    weight = np.einsum("pz,rpq,qy->rzy", basis, normal, basis)  # adds up to the unit matrix
    pull = np.einsum("pz,rkp,rk->rz", basis, tangents, found.residual)
    own = np.maximum(np.einsum("rzz->rz", weight), 1e-300)
    scatter = np.sum(pull**2 / own, axis=0)
    freedom = len(own) - 1
    by_chance = 1.0 - SETTINGS.interval_level
    agree = bool(freedom < 1 or scatter.sum() <= chdtri(freedom * len(scatter), by_chance))
    between = np.maximum(0.0, scatter - freedom) / np.maximum(1.0 - np.sum(own**2, axis=0), 1e-300)
    covariance = np.einsum("rzy,y,rxy->zx", weight, between, weight)
    return np.asarray((basis @ covariance @ basis.T) * np.outer(scale, scale)), agree
