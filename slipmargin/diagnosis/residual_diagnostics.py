"""Residual diagnostics: on which measured variables the residual depends.

No fit is needed.  The residual is differentiated in time (the velocity that the model did not predict),
rotated into the body frame and sorted into bins of each variable; the correlation ratio η² is the share
of its variance that the bins explain.  The null distribution comes from shifting the variable in time
within each trial, which keeps the autocorrelation of both.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.physics.convention import Convention
from slipmargin.physics.frames import rotate_rows

_BINS = 12
_SHIFTS = 99
#: Over how long the residual is differentiated [s].
_SPAN_S = 0.06

CHANNELS = ("right", "forward", "turn")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualDependence:
    """How much of one channel's residual rate a variable explains.

    ``share`` is η² less its mean under the null; ``surprise`` is its distance from that mean in standard
    deviations; ``p_value`` the share of shifted variables that explain as much.
    """

    variable: str
    channel: str
    share: float
    surprise: float
    p_value: float


def residual_rate(
    t_s: Array, measured: Array, predicted: Array, convention: Convention = Convention.PAPER
) -> Array:
    """Rate (T, 3) of measured − predicted to the robot's right, forwards and turning [m/s, m/s, rad/s].

    NaN near gaps and ends.
    """
    gap = measured - predicted
    half = max(1, round(_SPAN_S / 2.0 / max(1e-9, float(np.median(np.diff(t_s))))))
    rate = np.full(gap.shape, np.nan)
    if len(t_s) <= 2 * half:
        return rate
    rate[half:-half] = (gap[2 * half :] - gap[: -2 * half]) / (t_s[2 * half :] - t_s[: -2 * half])[:, None]
    body = rotate_rows(predicted[:, 2], rate, inverse=True)
    return np.stack([*convention.right_forward(body[:, 0], body[:, 1]), body[:, 2]], axis=1)


def dependences(
    rates: Sequence[Array], variables: Sequence[Mapping[str, Array]], seed: int
) -> tuple[ResidualDependence, ...]:
    """The correlation ratio of every variable with every channel over the runs that have it, strongest first.

    Parameters
    ----------
    rates : sequence of arrays (T, 3)
        Residual rate of each trial.
    variables : sequence of mappings name → array (T,)
        The variables of each trial.
    seed : int
        Seed of the shifts.
    """
    random = np.random.default_rng(seed)
    found = []
    for name in dict.fromkeys(name for v in variables for name in v):
        which = [k for k, v in enumerate(variables) if name in v]
        values = [variables[k][name] for k in which]
        edges = np.quantile(np.concatenate(values), np.linspace(0.0, 1.0, _BINS + 1)[1:-1])
        bins = [np.searchsorted(edges, v) for v in values]
        twice = [np.concatenate([b, b]) for b in bins]
        shifted = [[_turned(t, random) for t in twice] for _ in range(_SHIFTS)]
        for axis, channel in enumerate(CHANNELS):
            rate = np.concatenate([rates[k][:, axis] for k in which])
            seen = np.isfinite(rate)
            if not seen.any():  # too many gaps to differentiate the pose anywhere
                continue
            share = _ratio(np.concatenate(bins)[seen], rate[seen])
            null = np.array([_ratio(np.concatenate(s)[seen], rate[seen]) for s in shifted])
            deviation = float(null.std()) or 1e-12
            found.append(
                ResidualDependence(
                    variable=name,
                    channel=channel,
                    share=max(0.0, share - float(null.mean())),
                    surprise=(share - float(null.mean())) / deviation,
                    p_value=float((1 + np.sum(null >= share)) / (1 + _SHIFTS)),
                )
            )
    return tuple(sorted(found, key=lambda d: -d.share))


def _turned(twice: Array, random: np.random.Generator) -> Array:
    """Values that stand in ``twice`` two times over, shifted in a circle by a tenth of them at least."""
    count = len(twice) // 2
    by = int(random.integers(count // 10, max(count // 10 + 1, count - count // 10)))
    return twice[count - by : 2 * count - by]


def _ratio(bins: Array, values: Array) -> float:
    """Correlation ratio η²: variance between bins over total variance."""
    count = np.bincount(bins, minlength=_BINS)
    total = np.bincount(bins, weights=values, minlength=_BINS)
    mean = values.mean()
    between = float(np.sum(total[count > 0] ** 2 / count[count > 0]) - len(values) * mean**2)
    spread = float(np.sum((values - mean) ** 2))
    return between / spread if spread > 0.0 else 0.0
