"""Limits before and after the found effects are added: pull, acceleration and plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.plan_change import PlanChange, plan_change
from slipmargin.diagnosis.pull_check import PullCheck, pull_check
from slipmargin.effects import Recipe
from slipmargin.limits.band import band
from slipmargin.limits.bounds import directions
from slipmargin.limits.motion_state import Contact
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit_or_zero
from slipmargin.model import Model
from slipmargin.physics.convention import Convention

#: Orientations of the pull and directions of motion, one degree and five degrees apart.
_ORIENTATIONS, _DIRECTIONS = 360, 72


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Limits:
    """Limits of one model.

    Parameters
    ----------
    f_max_N, f_low_N, f_high_N : (360,)
        F_emax at every degree of orientation, all wheels on rollers, and lowest and highest over what
        the wheels may stand on [N]; 0 where the robot slips without any pull.
    start_m_s2, brake_m_s2, start_worst_m_s2, brake_worst_m_s2 : (72,)
        Greatest acceleration, and deceleration, along a direction of motion every five degrees
        (counted from the body's +x) without turning, all wheels on rollers, and in the worst
        state of what they may stand on; 0 where even steady motion slips [m/s²].
    """

    f_max_N: Array
    f_low_N: Array
    f_high_N: Array
    start_m_s2: Array
    brake_m_s2: Array
    start_worst_m_s2: Array
    brake_worst_m_s2: Array

    def __post_init__(self) -> None:
        for name in ("f_max_N", "f_low_N", "f_high_N"):
            object.__setattr__(self, name, frozen(name, getattr(self, name), (_ORIENTATIONS,)))
        for name in ("start_m_s2", "brake_m_s2", "start_worst_m_s2", "brake_worst_m_s2"):
            object.__setattr__(self, name, frozen(name, getattr(self, name), (_DIRECTIONS,)))

    @property
    def f_max_min_N(self) -> float:
        """F_emax of the weakest orientation, on rollers [N]."""
        return float(self.f_max_N.min())

    @property
    def f_max_mean_N(self) -> float:
        """Mean F_emax over orientations, on rollers [N]."""
        return float(self.f_max_N.mean())


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LimitsChange:
    """The same limits of the believed model and of the corrected one; measured pulls beside both."""

    phi_rad: Array
    direction_rad: Array
    before: Limits
    after: Limits
    plan: PlanChange
    pulls: PullCheck | None = None
    convention: Convention = Convention.PAPER

    @property
    def moved(self) -> bool:
        """Whether anything differs by more than a part in a million."""
        pairs = [(getattr(self.before, n), getattr(self.after, n)) for n in Limits.__slots__]
        return not all(np.allclose(one, two, rtol=1e-6, atol=1e-9) for one, two in pairs)


def limits_change(before: Recipe, after: Recipe, surface: str, pulls: Pulls | None = None) -> LimitsChange:
    """Limits of two recipes on one surface.

    Parameters
    ----------
    before, after : Recipe
        What was believed, and that with the found effects.
    pulls : Pulls, optional
        Measured pulls to compare both with.
    """
    phi = np.deg2rad(np.arange(_ORIENTATIONS, dtype=float))
    direction = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    believed, corrected = before.build(surface), after.build(surface)
    return LimitsChange(
        phi_rad=phi,
        direction_rad=direction,
        before=_limits(believed, phi, direction),
        after=_limits(corrected, phi, direction),
        plan=plan_change(believed, corrected),
        pulls=None if pulls is None else pull_check(believed, corrected, pulls),
        convention=believed.convention,
    )


def _limits(model: Model, phi: Array, direction: Array) -> Limits:
    pull = Pull()
    low, high = band(model, phi, pull)
    start, brake = _along(model, direction, Contact.ROLLERS)
    start_worst, brake_worst = _along(model, direction, Contact.UNKNOWN)
    return Limits(
        f_max_N=limit_or_zero(model, phi, pull),
        f_low_N=low,
        f_high_N=high,
        start_m_s2=start,
        brake_m_s2=brake,
        start_worst_m_s2=start_worst,
        brake_worst_m_s2=brake_worst,
    )


def _along(model: Model, direction: Array, contact: Contact) -> tuple[Array, Array]:
    """Starting and braking limits by direction of motion; a motion that must slip has none."""
    found = directions(model, direction, contact=contact)
    return np.maximum(found.starting_m_s2, 0.0), np.maximum(found.braking_m_s2, 0.0)
