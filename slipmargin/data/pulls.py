"""Measured breakaway pulls, one by one and gathered by orientation: what a sweep is compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen

#: Pulls closer together than this belong to one orientation [rad] (a fifth of a degree).
SAME_RAD = 3.5e-3


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pulls:
    """Measured breakaway pulls: direction (P,) [rad], force (P,) [N], rotor angles (P, N) [rad] or None."""

    phi_rad: Array
    force_N: Array
    theta_rad: Array | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "phi_rad", frozen("phi_rad", self.phi_rad, (None,)))
        put(self, "force_N", frozen("force_N", self.force_N, (len(self.phi_rad),)))
        if self.theta_rad is not None:
            put(self, "theta_rad", frozen("theta", self.theta_rad, (len(self.phi_rad), None)))


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PullGroups:
    """Pulls gathered by orientation, in ascending order; every array is (G,).

    ``phi_rad`` orientation [rad]; ``mean_N``, ``low_N``, ``high_N``, ``sd_N`` mean, least, greatest and
    standard deviation (n − 1; NaN of a single pull) of the force [N]; ``count`` pulls.
    """

    phi_rad: Array
    mean_N: Array
    low_N: Array
    high_N: Array
    sd_N: Array
    count: Array

    def __post_init__(self) -> None:
        for name in ("phi_rad", "mean_N", "low_N", "high_N", "count"):
            object.__setattr__(self, name, frozen(name, getattr(self, name), (None,)))

    def nearest(self, phi_rad: float) -> int | None:
        """The group at an orientation, or None where nothing was measured."""
        gap = np.abs(self.phi_rad - phi_rad)
        at = int(np.argmin(gap))
        return at if gap[at] <= SAME_RAD else None


def gather_pulls(phi_rad: Array, force_N: Array) -> PullGroups:
    """Group pulls whose orientations agree to :data:`SAME_RAD`."""
    order = np.argsort(phi_rad, kind="stable")
    phi, force = np.asarray(phi_rad)[order], np.asarray(force_N)[order]
    groups = np.split(np.arange(len(phi)), np.flatnonzero(np.diff(phi) > SAME_RAD) + 1)
    return PullGroups(
        phi_rad=np.array([phi[g].mean() for g in groups]),
        mean_N=np.array([force[g].mean() for g in groups]),
        low_N=np.array([force[g].min() for g in groups]),
        high_N=np.array([force[g].max() for g in groups]),
        sd_N=np.array([force[g].std(ddof=1) if len(g) > 1 else np.nan for g in groups]),
        count=np.array([float(len(g)) for g in groups]),
    )
