"""The chance of slip of a plan whose robot is uncertain, and the margin for a chosen chance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.limits.uncertainty import Draws
from slipmargin.limits.uncertainty_motion import needed_shares
from slipmargin.model import Model
from slipmargin.paths.path import Path
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import longest_step, trajectory
from slipmargin.paths.trajectory import Trajectory
from slipmargin.physics.frames import rotate_rows

#: Plans tried for a chosen chance; how close in margin the last two must be [1]; the largest share tried [1].
_TRIES, _CLOSE, _MOST = 12, 2e-3, 0.999


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class PlanChance:
    """How likely a plan makes a wheel slip, over the spread of the robot.

    ``at_plan`` is the share of the draws that slip or tip somewhere on it.  ``margin`` is the smallest margin
    found whose plan slips with the ``chance`` that was asked, and ``duration_s`` how long that plan takes;
    both None where no chance was asked or no plan has it.
    """

    at_plan: float
    chance: float | None
    margin: float | None
    duration_s: float | None
    draws: int
    seed: int


def plan_chance(
    model: Model,
    way: Path,
    request: Request,
    rows: Trajectory,
    drawn: Draws,
    *,
    chance: float | None,
    seed: int,
    step_s: float,
) -> PlanChance:
    """The chance of a plan, sampled as the trajectory ``rows``; for a chance plans are made by bisection."""
    at_plan, margin, duration = _slipping(model, drawn, rows, request.contact), None, None
    if chance is not None:
        low, high = 0.0, _MOST  # shares: the chance grows with the share that a plan may use
        for _ in range(_TRIES):
            share = 0.5 * (low + high)
            try:
                tried = plan(model, way, replace(request, share=share))
                step = min(step_s, longest_step(tried))  # it may be faster than the plan
                slips = _slipping(model, drawn, trajectory(tried, step_s=step), request.contact)
            except (NoSolution, InputError):
                low = share  # a share below what constant speed, or the speed at its start, needs has no plan
                continue
            if slips <= chance:
                low, margin, duration = share, 1.0 - share, tried.duration_s
            else:
                high = share
            if high - low < _CLOSE:
                break
    return PlanChance(
        at_plan=at_plan, chance=chance, margin=margin, duration_s=duration, draws=len(drawn), seed=seed
    )


def _slipping(model: Model, drawn: Draws, rows: Trajectory, contact: Contact) -> float:
    phi = rows.pose[:, 2]
    motion = Motion(
        velocity=rotate_rows(phi, rows.velocity, inverse=True),
        heading=phi,
        position=rows.pose[:, :2],
        acceleration=rotate_rows(phi, rows.acceleration, inverse=True),
        time_s=rows.t_s,
    )
    return float(np.mean(needed_shares(model, drawn, motion, contact) > 1.0))
