"""Limits before and after the found effects are added: pull, acceleration and plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar, final

import numpy as np

from slipmargin.checks import Array, exact_mean, frozen, read_only
from slipmargin.data.pulls import Pulls
from slipmargin.diagnosis.plan_change import PlanChange, plan_change
from slipmargin.diagnosis.pull_check import PullCheck, pull_check
from slipmargin.effects import Recipe
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.band import band
from slipmargin.limits.bounds import directions, spin
from slipmargin.limits.friction import floor_has_directions
from slipmargin.limits.motion_state import Contact
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit_or_zero
from slipmargin.model import Model
from slipmargin.physics.convention import Convention

_T = TypeVar("_T")
#: How computing a limit fails: no solution, a division by zero, a singular matrix, a number out of range.
_FAILURES = (InputError, NoSolution, ArithmeticError, LookupError, ValueError, RuntimeError)
#: Limits over the orientation of a pull and over the direction of a motion; the others are one number each.
PULL_CURVES = ("f_max_N", "f_low_N", "f_high_N")
MOTION_CURVES = ("start_m_s2", "brake_m_s2", "start_worst_m_s2", "brake_worst_m_s2")
#: Orientations of the pull and directions of motion, one degree and five degrees apart.
_ORIENTATIONS, _DIRECTIONS = 360, 72
#: Directions in which a floor that has some lies under the robot, ten degrees apart: a cosine misses its
#: extreme by at most 0.4 % of its size.
_FLOORS = 36


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Limits:
    """Limits of one model.

    Parameters
    ----------
    f_max_N, f_low_N, f_high_N : (360,)
        F_emax at every degree of orientation, all wheels on rollers, and lowest and highest over what
        the wheels may stand on [N]; 0 where the robot slips without any pull, not a number where it could
        not be computed.  Where the floor has directions each is the least (``f_high_N``: the greatest) over
        them, the pull's direction on the body held.
    start_m_s2, brake_m_s2, start_worst_m_s2, brake_worst_m_s2 : (72,)
        Greatest acceleration, and deceleration, along a direction of motion every five degrees
        (counted from the body's +x) without turning, all wheels on rollers, and in the worst
        state of what they may stand on; 0 where even steady motion slips [m/s²].
    spin_rad_s2, spin_worst_rad_s2 : float
        Greatest yaw acceleration of turning on the spot, about the body's origin, either way, on rollers and
        in the worst state [rad/s²]; not a number where it could not be computed.
    """

    f_max_N: Array
    f_low_N: Array
    f_high_N: Array
    start_m_s2: Array
    brake_m_s2: Array
    start_worst_m_s2: Array
    brake_worst_m_s2: Array
    spin_rad_s2: float
    spin_worst_rad_s2: float

    def __post_init__(self) -> None:
        for name in PULL_CURVES:
            object.__setattr__(self, name, _gapped(name, getattr(self, name), _ORIENTATIONS))
        for name in MOTION_CURVES:
            object.__setattr__(self, name, _gapped(name, getattr(self, name), _DIRECTIONS))

    @property
    def f_max_min_N(self) -> float:
        """F_emax of the weakest orientation, on rollers [N]."""
        return float(self.f_max_N.min())

    @property
    def f_max_mean_N(self) -> float:
        """Mean F_emax over orientations, on rollers [N]."""
        return exact_mean(self.f_max_N)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LimitsChange:
    """The same limits of the believed model and of the corrected one; measured pulls beside both.

    ``missing`` says in sentences what could not be computed; the values concerned are not numbers, and
    ``plan`` is None where it is the plan.  ``floor_directions`` is how many directions of the floor the
    pulls are the worst of: one where no direction matters.
    """

    phi_rad: Array
    direction_rad: Array
    before: Limits
    after: Limits
    plan: PlanChange | None
    pulls: PullCheck | None = None
    convention: Convention = Convention.PAPER
    missing: tuple[str, ...] = ()
    floor_directions: int = 1

    @property
    def moved(self) -> bool:
        """Whether anything differs by more than a part in a million."""
        pairs = [(getattr(self.before, n), getattr(self.after, n)) for n in Limits.__slots__]
        return not all(np.allclose(one, two, rtol=1e-6, atol=1e-9, equal_nan=True) for one, two in pairs)


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
    same = after.robot is before.robot and after.effects == before.effects
    believed = before.build(surface)
    corrected = believed if same else after.build(surface)
    missing: list[str] = []
    new = old = _limits(believed, phi, direction, "the robot as believed", missing)
    if not same:
        new = _limits(corrected, phi, direction, "the corrected robot", missing)
    return LimitsChange(
        phi_rad=phi,
        direction_rad=direction,
        before=old,
        after=new,
        plan=tried("the plan before and after", missing, lambda: plan_change(believed, corrected)),
        pulls=None
        if pulls is None
        else tried("the comparison with pulls", missing, lambda: pull_check(believed, corrected, pulls)),
        missing=tuple(missing),
        convention=believed.convention,
        floor_directions=max(_floors(believed), _floors(corrected)),
    )


def tried(what: str, missing: list[str], made: Callable[[], _T]) -> _T | None:
    """What ``made`` gives; None, and a sentence in ``missing``, where it fails: no extra costs a finding."""
    try:
        return made()
    except _FAILURES as problem:
        reason = " ".join(str(problem).split()) or type(problem).__name__
        missing.append(f"Could not be computed: {what} ({reason}).")
        return None


def _floors(model: Model) -> int:
    """How many directions of the floor a pull is tried along."""
    return _FLOORS if floor_has_directions(model) else 1


def _limits(model: Model, phi: Array, direction: Array, whose: str, missing: list[str]) -> Limits:
    # Robot and pull are turned together: the pull acts on the body as before, and the floor lies differently.
    turns = 2.0 * np.pi * np.arange(_floors(model)) / _floors(model)
    pulls = [(phi + turn, Pull(direction_rad=float(turn))) for turn in turns]

    def weakest() -> tuple[Array, ...]:
        return (np.min([limit_or_zero(model, at, pull) for at, pull in pulls], axis=0),)

    def ends() -> tuple[Array, ...]:
        low, high = zip(*(band(model, at, pull) for at, pull in pulls), strict=True)
        return np.min(low, axis=0), np.max(high, axis=0)

    def asked(what: str, size: int, made: Callable[[], tuple[Array, ...]], count: int) -> tuple[Array, ...]:
        found = tried(f"{what} of {whose}", missing, made)
        return tuple(np.full(size, np.nan) for _ in range(count)) if found is None else found

    (highest,) = asked("the pull limits", _ORIENTATIONS, weakest, 1)
    low, high = asked("the band of pull limits", _ORIENTATIONS, ends, 2)
    start, brake = asked(
        "the acceleration limits", _DIRECTIONS, lambda: _along(model, direction, Contact.ROLLERS), 2
    )
    start_worst, brake_worst = asked(
        "the worst acceleration limits", _DIRECTIONS, lambda: _along(model, direction, Contact.UNKNOWN), 2
    )
    on_rollers, at_worst = (
        tried(f"turning on the spot of {whose}", missing, partial(_spin, model, contact))
        for contact in (Contact.ROLLERS, Contact.UNKNOWN)
    )
    return Limits(
        f_max_N=highest,
        f_low_N=low,
        f_high_N=high,
        start_m_s2=start,
        brake_m_s2=brake,
        start_worst_m_s2=start_worst,
        brake_worst_m_s2=brake_worst,
        spin_rad_s2=np.nan if on_rollers is None else on_rollers,
        spin_worst_rad_s2=np.nan if at_worst is None else at_worst,
    )


def _gapped(name: str, values: Array, size: int) -> Array:
    """``values`` read-only; all of them not numbers where they could not be computed."""
    if np.isnan(values).all():
        return read_only(np.full(size, np.nan))
    return frozen(name, values, (size,))


def _spin(model: Model, contact: Contact) -> float:
    """Greatest yaw acceleration on the spot; 0 where turning must slip."""
    return max(spin(model, contact=contact).starting_rad_s2, 0.0)


def _along(model: Model, direction: Array, contact: Contact) -> tuple[Array, Array]:
    """Starting and braking limits by direction of motion; a motion that must slip has none."""
    found = directions(model, direction, contact=contact)
    return np.maximum(found.starting_m_s2, 0.0), np.maximum(found.braking_m_s2, 0.0)
