"""Drive forces of three wheels straight from the balance of forces: the second road to what motion needs."""

from __future__ import annotations

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits.motion_external import external_in_motion
from slipmargin.limits.motion_friction import friction_in_motion
from slipmargin.limits.motion_state import Motion
from slipmargin.model import Model
from slipmargin.physics.kinematics import com_acceleration


def drive_shares(model: Model, motion: Motion) -> Array:
    """Signed share (M, 3) of each wheel's drive grip at constant speed, all on rollers; positive along ĝ."""
    friction = friction_in_motion(model, motion)
    a = com_acceleration(model.inertia.com_m, motion.velocity, np.zeros((motion.count, 3)))
    wrench, load = external_in_motion(model, motion).middle(a)
    along, across = model.wrench_maps()
    drag = 0.5 * (friction.drag_low + friction.drag_high)[0] * load
    asked = a * model.inertia.diagonal - wrench + drag @ across.T
    return np.asarray(np.linalg.solve(along, asked.T).T / (friction.drive[0] * load))
