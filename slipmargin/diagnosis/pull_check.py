"""Pull tests beside a diagnosis: measured forces that nothing was fitted to, predicted before and after.

They are another experiment, with the wheels locked: where the corrected robot predicts them better
too, they confirm the effects found on moving runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.data.pulls import Pulls
from slipmargin.limits.pull_settings import setting_bands, setting_limits
from slipmargin.model import Model
from slipmargin.physics.sectors import on_rigid, pitch


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class PullCheck:
    """``count`` pulls; root mean square [N] and mean [N] of measured minus predicted, before and after.

    ``noise_N`` is what the data set states for one pull [N], if it does.
    """

    count: int
    rms_before_N: float
    rms_after_N: float
    mean_before_N: float
    mean_after_N: float
    noise_N: float | None = None


def pull_check(believed: Model, corrected: Model, pulls: Pulls) -> PullCheck:
    """Measured pulls against the limits of two models.

    Parameters
    ----------
    believed, corrected : Model
        Before and after.
    pulls : Pulls
        Orientation [rad], breakaway force [N], wheel angles [rad] where known.
    """
    before, after = (pulls.force_N - predicted(m, pulls) for m in (believed, corrected))
    return PullCheck(
        count=len(pulls.force_N),
        rms_before_N=float(np.sqrt(np.mean(before**2))),
        rms_after_N=float(np.sqrt(np.mean(after**2))),
        mean_before_N=float(np.mean(before)),
        mean_after_N=float(np.mean(after)),
        noise_N=pulls.sigma_N,
    )


def predicted(model: Model, pulls: Pulls) -> Array:
    """F_emax (P,) [N] of the contact state that belongs to each pull's wheel angles.

    Where the angles are not known, that of the band which is nearest to the measured force.
    """
    settings, which = pulls.settings()
    if pulls.theta_rad is None:
        low, high = setting_bands(model, settings)
        return np.clip(pulls.force_N, low[which], high[which])
    rigid = on_rigid(pulls.theta_rad, pitch(model.grip.rollers), model.grip.rigid_fraction)
    found = np.empty(len(pulls.phi_rad))
    for state in np.unique(rigid, axis=0):
        rows = np.all(rigid == state, axis=1)
        found[rows] = setting_limits(model, settings, state)[which[rows]]
    return found
