"""Why there is no admissible motion: where, which wheel, why, and what would make it possible."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import rounded_down
from slipmargin.errors import InputError, NoSolution
from slipmargin.limits.motion_realised import realised
from slipmargin.limits.motion_state import Contact, Motion
from slipmargin.model import Model
from slipmargin.paths.along import Rows
from slipmargin.paths.geometry import Geometry

#: A steady speed at which the drag is full, to say what steady motion needs [m/s].
STEADY_M_S = 0.5


def stuck(
    model: Model,
    geometry: Geometry,
    rows: Rows,
    interval: int,
    one: int,
    two: int,
    share: float,
    contact: Contact,
) -> NoSolution:
    """The error for an interval without admissible motion; ``one`` and ``two`` are the rows in conflict."""
    pose, s = geometry.pose[interval, 0], geometry.s[interval, 0]
    where = (
        f"no admissible motion at s = {s:.4g} m (x {pose[0]:.4g} m, y {pose[1]:.4g} m, phi {pose[2]:.4g} rad)"
    )
    count = rows.a.shape[2]
    kinds = sorted({rows.names[r % count] for r in (one, two) if 0 <= r < 2 * count})
    twist = geometry.twist[interval, :1]
    size = float(np.max(np.abs(twist @ np.diag([1.0, 1.0, 0.1]).T)))
    steady = Motion(
        velocity=twist / size * STEADY_M_S,
        acceleration=np.zeros((1, 3)),
        heading=pose[2:3],
        position=pose[None, :2],
    )
    use = realised(model, steady, contact=contact).use[0]
    worst = int(np.argmax(use))
    name = model.geometry.names[worst]
    if use[worst] > share and "motor torque" not in kinds:
        why = (
            f"even at constant speed wheel {name} needs {use[worst]:.3g} of its grip, "
            f"more than the {share:.3g} allowed"
        )
        return NoSolution(where, why, _cure(model, use[worst], contact), evidence=rows)
    held = [
        model.geometry.names[i]
        for r in (one, two)
        if 0 <= r < 2 * count
        for i in np.flatnonzero(rows.wheels[r % count])
    ]
    who = ", ".join(dict.fromkeys(held)) or name
    what = " and ".join(kinds) or "the speed cap and the rest of the path"
    return NoSolution(
        where,
        f"{what} of wheel {who} leaves no acceleration along the path",
        "use a smaller margin, a stronger motor, or another heading there",
        evidence=rows,
    )


def _cure(model: Model, use: float, contact: Contact) -> str:
    if use < 1.0:
        return f"use a margin below {np.floor(100.0 * (1.0 - use)) / 100.0:g}"
    if contact is not Contact.ROLLERS and np.any(model.grip.rigid_fraction > 0.0):
        return (
            "plan for wheels on rollers only, fit wheels without rigid sectors, or turn the heading "
            "so that fewer wheels slide sideways"
        )
    return "turn the heading so that fewer wheels slide sideways, or lower the roller friction"


def too_fast(speed_m_s: float, start: bool, most: float, geometry: Geometry, reach_m: float) -> InputError:
    """The error for a start or end speed that the path does not allow; ``most`` is the largest ṡ² there."""
    place = "start speed" if start else "end speed"
    pose = geometry.pose[0, 0] if start else geometry.pose[-1, -1]
    limit = rounded_down(float(np.sqrt(max(most, 0.0)) * geometry.floor_rates(reach_m)[0 if start else 1]))
    return InputError(
        place,
        f"is {speed_m_s:g} m/s at x {pose[0]:.4g} m, y {pose[1]:.4g} m, "
        f"but the path allows at most {limit:g} m/s there",
        "give a lower speed",
    )
