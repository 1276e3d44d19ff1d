"""The words of a simulation."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from slipmargin.checks import Array
from slipmargin.errors import MotionStopped
from slipmargin.limits.motion_realised import growth_per_s
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.sim.run import Run

#: A slip that grows more slowly takes longer than most motions last [1/s].
_GROWS = 1.0


def run_lines(run: Run, model: Model, work_J: float, planned_end: Array | None) -> list[str]:
    """End pose, largest drive slip, energy lost to sliding, and the distance from the planned end."""
    x, y, phi = np.round(run.pose[-1], 4) + 0.0  # no minus zero
    slip = np.abs(run.slip[..., 0])
    when, wheel = np.unravel_index(int(np.argmax(slip)), slip.shape)
    lines = [
        f"ends at x {x:.4f} m, y {y:.4f} m, φ {phi:.4f} rad after {run.duration_s:.3g} s "
        f"({model.robot} on {model.surface})",
        f"largest drive slip {slip[when, wheel]:.4g} m/s, "
        f"wheel {run.wheels[wheel]} at {run.t_s[when]:.2f} s; "
        f"sliding takes {-work_J:.3g} J",
    ]
    if run.lifts_s is not None:
        lines.append(in_air(run.wheels, run.in_air_s, run.lifts_s))
    if planned_end is not None:
        miss = run.pose[-1] - planned_end
        lines.append(f"misses the planned end by {1e3 * math.hypot(*miss[:2]):.2f} mm and {miss[2]:.4f} rad")
    return lines


def unsteady(
    model: Model,
    motion: Motion,
    contact: Contact = Contact.ROLLERS,
    *,
    looked_at: str = "the places looked at",
) -> tuple[str, ...]:
    """A sentence where small slips of a motion grow, since loads follow the acceleration; else none.

    ``looked_at`` says what its states are.
    """
    grows = growth_per_s(model, motion, contact=contact) if motion.count else np.zeros(0)
    if not np.any(grows > _GROWS):
        return ()
    where = 100.0 * float(np.mean(grows > _GROWS))
    return (
        f"stability: loads that follow the acceleration let a small slip grow in {where:.2g} % of "
        f"{looked_at}, {math.e:.3g}-fold in {1.0 / np.max(grows):.2g} s: a wheel may lift although none "
        "uses more than its share; take a larger margin, or lower the centre of mass",
    )


def ended(stopped: MotionStopped) -> str:
    """When and why a simulation ended early."""
    return f"t = {stopped.time_s:.4g} s: {stopped.why}"


def in_air(wheels: Sequence[str], in_air_s: Array, lifts_s: float) -> str:
    """Which wheels hang in the air, for how long and from when on."""
    order = np.argsort(-in_air_s, kind="stable")
    told = [f"wheel {wheels[i]} for {in_air_s[i]:.3g} s" for i in order if in_air_s[i] > 0.0]
    if not told:
        return f"a wheel lifts off, first at {lifts_s:.2f} s"
    return (
        f"wheels hang in the air: {', '.join(told)}, first at {lifts_s:.2f} s; the others carry their share"
    )
