"""What a plan would use if the robot looked a little away from where the plan has it."""

from __future__ import annotations

import math

import numpy as np

from slipmargin.paths.audit import FINER, audit
from slipmargin.paths.geometry import Geometry
from slipmargin.paths.plan import Plan

#: A heading's error that is usual while driving [rad]: 1°.
DRIFT_RAD = math.radians(1.0)


def use_off_heading(plan: Plan, angle_rad: float = DRIFT_RAD) -> float:
    """Largest share of a wheel's grip, to either side, for a heading ``angle_rad`` off all along the path.

    Straight along its wheels a robot's rollers stand; off that way they turn and drag.
    """
    fractions = np.linspace(0.0, 1.0, FINER + 1)
    seen = [
        audit(
            plan.model,
            Geometry.of(plan.model, plan.path, plan.grid, fractions, turned_rad=angle),
            plan.x,
            plan.u,
            contact=plan.request.contact,
            share=plan.request.share,
            caps=plan.request.caps,
        )
        for angle in (-angle_rad, angle_rad)
    ]
    return max(float(np.max(one.most)) for one in seen)
