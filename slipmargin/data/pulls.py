"""Measured breakaway pulls, one by one and gathered by orientation: what a sweep is compared with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, Index, frozen, real
from slipmargin.data.settings import SETTINGS
from slipmargin.errors import InputError
from slipmargin.physics.frames import wrapped


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pulls:
    """Measured breakaway pulls: orientation (P,) [rad], force (P,) [N], and what else is known of each.

    Parameters
    ----------
    phi_rad, force_N : (P,)
        Orientation of the robot [rad] and the pull at which it broke away [N].
    theta_rad : (P, N), optional
        Wheel angles [rad].
    direction_rad : (P,), optional
        Direction of the pull in the floor frame [rad]; along +x where not given.
    point_m : (P, 2), optional
        Where it pulls, in the body frame [m]; the centre of mass where not given.
    height_m : (P,), optional
        Height of that point above the floor [m]; 0 where not given.
    sigma_N : float, optional
        Repeatability of the measurement, one standard deviation [N].
    """

    phi_rad: Array
    force_N: Array
    theta_rad: Array | None = None
    direction_rad: Array | None = None
    point_m: Array | None = None
    height_m: Array | None = None
    sigma_N: float | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "phi_rad", frozen("phi_rad", self.phi_rad, (None,)))
        count = len(self.phi_rad)
        for key, shape in (
            ("force_N", (count,)),
            ("theta_rad", (count, None)),
            ("direction_rad", (count,)),
            ("point_m", (count, 2)),
            ("height_m", (count,)),
        ):
            value = getattr(self, key)
            if value is not None:
                put(self, key, frozen(key, value, shape))
        if self.height_m is not None and np.any(self.height_m < 0.0):
            raise InputError("height_m", f"is {self.height_m.min():g}", "give heights above the floor [m]")
        if self.sigma_N is not None:
            put(self, "sigma_N", real("sigma_N", self.sigma_N, above=0.0, cure="noise is positive"))

    def refuse_settings(self, file: str) -> None:
        """Refuse pulls with a direction, a point or a height of their own, beside limits of one for all.

        Raises
        ------
        InputError
            Placed at the header of ``file``.
        """
        if self.direction_rad is not None or self.point_m is not None or self.height_m is not None:
            raise InputError(
                "1:1",
                "pulls have a direction, a point or a height of their own, a sweep has one for all",
                "remove these columns, or use slipmargin diagnose",
                file,
            )

    def settings(self) -> tuple[Array, Index]:
        """What was pulled how: settings (G, 5), and which of them each pull (P,) is.

        A setting is orientation [rad], direction [rad], point x, y [m] (NaN: the centre of mass) and
        height [m].  Orientations within :attr:`DataSettings.same_rad`, a full turn apart or not, are one.
        """
        count = len(self.phi_rad)
        direction = np.zeros(count) if self.direction_rad is None else self.direction_rad
        point = np.full((count, 2), np.nan) if self.point_m is None else self.point_m
        height = np.zeros(count) if self.height_m is None else self.height_m
        found: list[Array] = []
        which = np.empty(count, dtype=np.int64)
        rows = np.column_stack([self.phi_rad, direction, point, height])
        for at in np.lexsort((np.mod(self.phi_rad + 0.5 * SETTINGS.same_rad, 2.0 * np.pi),)):
            which[at] = next((g for g, one in enumerate(found) if _same(one, rows[at])), len(found))
            if which[at] == len(found):
                found.append(rows[at])
        return np.array(found), which


def _same(one: Array, other: Array) -> bool:
    turned = np.abs(wrapped(one[:2] - other[:2]))
    return bool(np.all(turned <= SETTINGS.same_rad)) and bool(
        np.all(np.nan_to_num(np.abs(one[2:] - other[2:])) <= SETTINGS.same_m)
    )


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
        gap = np.abs(wrapped(self.phi_rad - phi_rad))
        at = int(np.argmin(gap))
        return at if gap[at] <= SETTINGS.same_rad else None


def gather_pulls(phi_rad: Array, force_N: Array) -> PullGroups:
    """Group pulls by orientation, as :meth:`Pulls.settings` does."""
    settings, which = Pulls(phi_rad=phi_rad, force_N=force_N).settings()
    of = [np.flatnonzero(which == g) for g in range(len(settings))]
    at = [one[0] + np.mean(wrapped(phi_rad[g] - one[0])) for one, g in zip(settings, of, strict=True)]
    order = np.argsort(at, kind="stable")
    force = [force_N[of[g]] for g in order]
    return PullGroups(
        phi_rad=np.array(at)[order],
        mean_N=np.array([f.mean() for f in force]),
        low_N=np.array([f.min() for f in force]),
        high_N=np.array([f.max() for f in force]),
        sd_N=np.array([f.std(ddof=1) if len(f) > 1 else np.nan for f in force]),
        count=np.array([float(len(f)) for f in force]),
    )
