"""Friction coefficients from pulls with a scale: least squares on the limits, bootstrap over the pulls.

A pull at orientation φ measures F_emax(φ; μ_W, μ_T), along +x through the centre of mass at the floor or as
its own direction, point and height say; pulls at several orientations decide both coefficients
of each type of wheel.  Only pulls with all wheels on rollers count.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array, Index, frozen
from slipmargin.data.pulls import Pulls
from slipmargin.errors import InputError
from slipmargin.limits.pull_settings import setting_limits
from slipmargin.model import Model
from slipmargin.physics.grips import polyhedral
from slipmargin.physics.sectors import on_rigid, pitch

#: Redrawn sets of pulls: of a closed form, and where each limit is a cone program.
DRAWS, DRAWS_CONES = 200, 40
#: Coefficients are searched for in this range [1].
RANGE = (1e-3, 5.0)
#: No floor holds a pull of so many times the weight: a coefficient of 5 on every wheel, and to spare [1].
HEAVIEST = 10.0
#: A redrawn set is fitted until its squared residual falls by less than this share [1]: the coefficients are
#: then known to a hundredth of how far they scatter from set to set.
ENOUGH = 1e-5
#: The ends of an interval [1].
LOW, HIGH = 0.025, 0.975
#: Coefficients whose joint change by a part changes the forces by less than this share of it are not
#: measured, and the part by which they are changed to see it [1].
UNSEEN, PART = 3e-3, 0.03


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """Coefficients of T types of wheel, drive and transverse: value, low and high (T, 2) [1].

    Low and high hold 95 % of the redrawn sets of pulls.  ``types`` names the types, ``residual_N`` (P,) is
    measured minus predicted, ``left_out`` how many pulls had a wheel on rigid material.
    """

    types: tuple[str, ...]
    value: Array
    low: Array
    high: Array
    residual_N: Array
    left_out: int
    draws: int
    seed: int

    def __post_init__(self) -> None:
        for name in ("value", "low", "high"):
            object.__setattr__(self, name, frozen(name, getattr(self, name), (len(self.types), 2)))
        object.__setattr__(self, "residual_N", frozen("residual_N", self.residual_N, (None,)))


def wheel_types(roller_angle_deg: Array) -> tuple[tuple[str, ...], Index]:
    """The types of wheel by the size of their roller angle, and each wheel's type (N,)."""
    angle = np.round(np.abs(roller_angle_deg), 6)
    kinds = np.unique(angle)
    names = tuple("omni" if a == 0.0 else f"mecanum {a:g}°" for a in kinds)
    return names, np.searchsorted(kinds, angle)


def measure(model: Model, roller_angle_deg: Array, pulls: Pulls, *, seed: int = 0) -> Measured:
    """Coefficients of each type of wheel from pulls.

    Raises
    ------
    InputError
        If there are fewer pulls than coefficients on rollers, or the pulls do not decide them all.
    """
    from scipy.optimize import least_squares

    names, kind = wheel_types(roller_angle_deg)
    keep = np.ones(len(pulls.phi_rad), dtype=bool)
    if pulls.theta_rad is not None:
        rigid = on_rigid(pulls.theta_rad, pitch(model.grip.rollers), model.grip.rigid_fraction)
        keep = ~np.any(rigid, axis=1)
    settings, which = pulls.settings()
    used, back = np.unique(which[keep], return_inverse=True)
    settings, force, unknown = settings[used], pulls.force_N[keep], 2 * len(names)
    if len(force) <= unknown:
        raise InputError(
            "pulls",
            f"{len(force)} with all wheels on rollers are too few for {unknown} coefficients",
            f"pull at least {unknown + 1} times, in several directions",
        )

    worst = float(np.max(np.abs(force))) / model.inertia.weight_N
    if worst > HEAVIEST:
        raise InputError(
            "force_N",
            f"reaches {worst:.3g} times the robot's weight of {model.inertia.weight_N:.3g} N",
            "give newtons, and the mass of the robot as it was pulled",
        )

    def predicted(mu: Array) -> Array:
        roller = mu.reshape(-1, 2)[kind]
        return setting_limits(replace(model, grip=replace(model.grip, roller=roller)), settings)

    def fitted(weight: Array, start: Array, enough: float) -> Array:
        root = np.sqrt(weight)
        found = least_squares(
            lambda mu: root * (predicted(mu)[back] - force),
            start,
            bounds=RANGE,
            x_scale=0.1,
            ftol=enough,
            xtol=enough,
        )
        return np.asarray(found.x)

    grips = float(np.mean(force)) / model.inertia.weight_N
    start = np.clip(np.tile([1.3 * grips, 0.4 * grips], len(names)), 2.0 * RANGE[0], 0.5 * RANGE[1])
    best = fitted(np.ones(len(force)), start, 1e-8)
    middle = predicted(best)
    _refuse_undecided(names, best, middle, predicted)
    rng = np.random.default_rng(seed)
    draws = DRAWS if polyhedral(model.grip.shape, model.grip.coupling) else DRAWS_CONES
    redrawn = []
    for _ in range(draws):
        weight = np.bincount(rng.integers(0, len(force), len(force)), minlength=len(force)).astype(float)
        redrawn.append(fitted(weight, best, ENOUGH))
    low, high = np.quantile(redrawn, [LOW, HIGH], axis=0)
    shape = (len(names), 2)
    return Measured(
        types=names,
        value=best.reshape(shape),
        low=np.minimum(low, best).reshape(shape),
        high=np.maximum(high, best).reshape(shape),
        residual_N=force - middle[back],
        left_out=int(np.count_nonzero(~keep)),
        draws=draws,
        seed=seed,
    )


def _refuse_undecided(
    names: tuple[str, ...], best: Array, at: Array, predicted: Callable[[Array], Array]
) -> None:
    """Refuse pulls that leave a combination of coefficients open: by the least singular value."""
    if not np.max(at) > 0.0:
        raise InputError(
            "pulls",
            "no coefficients make this robot hold any pull: what acts on it slips it by itself",
            "take the effects that pull at it or take its grip away out of the robot file",
        )
    step = np.eye(len(best)) * PART
    slope = np.stack([(predicted(best * (1.0 + s)) - at) / (PART * np.max(at)) for s in step], axis=1)
    _, size, ways = np.linalg.svd(slope / np.sqrt(len(at)))
    if len(size) == len(best) and size[-1] >= UNSEEN:
        return
    open_ = np.abs(ways[-1]) > 0.1
    said = [f"{way} of {name}" for name in names for way in ("drive", "transverse")]
    which = " and ".join(one for one, on in zip(said, open_, strict=True) if on)
    raise InputError(
        "pulls",
        f"do not decide {which}: "
        + ("only together do they act" if open_.sum() > 1 else "no pull depends on it"),
        "pull in more directions, every 15 to 30 degrees; for mecanum wheels use the grip disc-strip",
    )
