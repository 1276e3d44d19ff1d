"""What limits a design: the heading of its least limit, and the friction limits that bind there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import NoSolution
from slipmargin.limits.band import band, states
from slipmargin.limits.bounds import directions, headings
from slipmargin.limits.friction import Extreme
from slipmargin.limits.motion_state import Contact
from slipmargin.limits.pull import Pull
from slipmargin.limits.sensitivity import sensitivity
from slipmargin.limits.sweep import limit
from slipmargin.limits.wrench_set import wrench_set
from slipmargin.model import Model
from slipmargin.physics.loads import LoadRule
from slipmargin.study.columns import STEP_DEG
from slipmargin.study.objectives import Kind, Objective
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.statics import headings as all_round


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Reason:
    """What limits an objective: ``where`` in words, ``what`` gives way (wheels and forces by name)."""

    where: str
    what: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.where}: {', '.join(self.what)}" if self.what else self.where


def reason(design: RobotOnSurface, goal: Objective) -> Reason:
    """What limits ``goal`` on this design.

    Raises
    ------
    InputError
        If the design cannot be built.
    """
    if goal.kind is Kind.LAPS:
        return _laps(design.build())
    if goal.kind is Kind.MOTION:
        return _moving(design.build(), goal.name)
    if goal.name in _RULES:
        design = design.with_robot(replace(design.robot, load_rule=_RULES[goal.name], load_fractions=None))
    return _static(design.build(), goal.name)


_RULES = {"f_worst_equal": LoadRule.EQUAL, "f_worst_static": LoadRule.STATIC}


def _static(model: Model, name: str) -> Reason:
    if name == "load_least":
        at = int(np.argmin(model.loads.rest_N))
        return Reason(where=f"the lightest wheel, by {model.loads.rule}", what=(model.geometry.names[at],))
    if name == "yaw_moment_N_m":
        return Reason(where="turned on the spot", what=_turned(model))
    phi, rigid = all_round(), np.zeros(model.count, dtype=bool)
    if name == "f_rigid_worst":
        rigid[:] = True
    elif name == "f_low_worst":
        rigid = _lowest_state(model, phi)
    try:
        force = limit(model, phi, Pull(), rigid)
    except NoSolution as fault:
        return Reason(where=str(fault), what=())
    at = int(np.argmax(force) if name == "f_best" else np.argmin(force))
    seen = sensitivity(model, phi[at : at + 1], rigid=rigid).forces()[0]
    word = "strongest" if name == "f_best" else "weakest"
    ground = "" if not np.any(rigid) else f" with {_listed(model, rigid)} on rigid material"
    return Reason(where=f"{word} at φ = {math.degrees(phi[at]):.4g}°{ground}, where these slip", what=seen)


def _lowest_state(model: Model, phi: Array) -> Array:
    low = float(np.min(band(model, phi, Pull())[0]))
    tried = states(model, Extreme.LOW)
    worst = [abs(float(np.min(limit(model, phi, Pull(), s))) - low) for s in tried]
    return tried[int(np.argmin(worst))]


def _turned(model: Model) -> tuple[str, ...]:
    wrenches = wrench_set(model)
    normals = wrenches.normals[wrenches.normals[:, 2] > 0.0]
    at = normals[int(np.argmin(wrenches.support(normals) / normals[:, 2]))]
    share = wrenches.share(at)
    return tuple(n for n, s in zip(model.geometry.names, share, strict=True) if s > 1e-9 * np.max(share))


def _moving(model: Model, name: str) -> Reason:
    way = headings(STEP_DEG)
    contact = Contact.UNKNOWN if "unknown" in name else Contact.RIGID if "rigid" in name else Contact.ROLLERS
    found = directions(model, way, contact=contact)
    if name.startswith(("slip_share", "steady_use")):
        at = int(np.argmax(found.steady_use))
        return Reason(
            where=f"steady motion needs most, {found.steady_use[at]:.3g} of the drive grip, "
            f"{_towards(model, way[at])}",
            what=found.starting.wheels[at],
        )
    if name.startswith("brake"):
        at = int(np.argmin(found.braking_m_s2))
        return Reason(where=f"weakest when moving {_towards(model, way[at])}", what=())
    at = int(np.argmin(found.starting_m_s2))
    return Reason(
        where=f"weakest when moving {_towards(model, way[at])}, limited by {found.starting.cause[at]} of",
        what=found.starting.wheels[at],
    )


def _towards(model: Model, way_rad: float) -> str:
    return f"towards {math.degrees(way_rad):.0f}° ({model.convention.compass})"


def _laps(model: Model) -> Reason:
    from slipmargin.study.laps import lap_times

    times = lap_times(model)
    slow = max(times, key=lambda name: times[name])
    if math.isinf(times[slow]):
        return Reason(where=f"no admissible motion along {slow!r}", what=())
    return Reason(where="seconds by path", what=tuple(f"{name} {t:.2f}" for name, t in times.items()))


def _listed(model: Model, rigid: Array) -> str:
    return (
        "every wheel"
        if np.all(rigid)
        else " and ".join(n for n, on in zip(model.geometry.names, rigid, strict=True) if on)
    )
