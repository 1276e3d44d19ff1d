"""What the found effects change: pull, acceleration and plan, before and after."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array, frozen
from slipmargin.effects import Recipe
from slipmargin.errors import NoSolution
from slipmargin.limits.band import band
from slipmargin.limits.motion_rows import acceleration_rows
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.model import Model

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
        (0 = to the right, 90° = forwards) without turning, all wheels on rollers, and in the worst
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
    """The same limits of the believed model and of the corrected one."""

    phi_rad: Array
    direction_rad: Array
    before: Limits
    after: Limits

    @property
    def moved(self) -> bool:
        """Whether anything differs by more than a part in a million."""
        pairs = [(getattr(self.before, n), getattr(self.after, n)) for n in Limits.__slots__]
        return not all(np.allclose(one, two, rtol=1e-6, atol=1e-9) for one, two in pairs)


def limits_change(before: Recipe, after: Recipe, surface: str) -> LimitsChange:
    """Limits of two recipes on one surface.

    Parameters
    ----------
    before, after : Recipe
        What was believed, and that with the found effects.
    """
    phi = np.deg2rad(np.arange(_ORIENTATIONS, dtype=float))
    direction = np.linspace(0.0, 2.0 * np.pi, _DIRECTIONS, endpoint=False)
    one, two = (_limits(recipe.build(surface), phi, direction) for recipe in (before, after))
    return LimitsChange(phi_rad=phi, direction_rad=direction, before=one, after=two)


def _limits(model: Model, phi: Array, direction: Array) -> Limits:
    pull = Pull()
    low, high = band(model, phi, pull)
    return Limits(
        f_max_N=_rollers(model, phi, pull),
        f_low_N=low,
        f_high_N=high,
        start_m_s2=_along(model, direction, 1.0, Contact.ROLLERS),
        brake_m_s2=_along(model, direction, -1.0, Contact.ROLLERS),
        start_worst_m_s2=_along(model, direction, 1.0, Contact.UNKNOWN),
        brake_worst_m_s2=_along(model, direction, -1.0, Contact.UNKNOWN),
    )


def _rollers(model: Model, phi: Array, pull: Pull) -> Array:
    """F_emax, 0 where a slope or a cable alone makes the robot slip."""
    try:
        return limit(model, phi, pull)
    except NoSolution as fault:
        if not isinstance(fault.evidence, np.ndarray):
            raise
        return np.nan_to_num(fault.evidence, nan=0.0)


def _along(model: Model, direction: Array, sign: float, contact: Contact) -> Array:
    """Greatest a along ``sign`` times the direction of motion: the first row that A·d s ≤ b reaches.

    Drag counts at its full value (the published limit, whatever the speed); what a limit cannot know
    (heading, place) takes its worst value.
    """
    way = np.stack([np.cos(direction), np.sin(direction), np.zeros(len(direction))], axis=1)
    rows = acceleration_rows(model, Motion(velocity=way, saturated=True), contact=contact)
    along = sign * np.einsum("mra,ma->mr", rows.A, way)
    size = np.abs(rows.A).max(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(along > 1e-9 * size, rows.b / along, np.inf)
    found = reach.min(axis=1)
    blocked = np.any((np.abs(along) <= 1e-9 * size) & (rows.b < -1e-12), axis=1)
    return np.where(blocked | ~np.isfinite(found), 0.0, np.maximum(found, 0.0))
