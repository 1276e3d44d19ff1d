"""Section IV.B: the force before sliding over the robot's orientation (Fig. 8, eqs 12 to 18)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from slipmargin.checks import Array
from slipmargin.limits import Pull, sweep, wrench_set
from slipmargin.limits.sweep import limit
from slipmargin.model import nominal_model
from slipmargin.paper.published import paper_model, paper_robot
from slipmargin.paper.rows import Row, claim, number, unchecked

HEADINGS_DEG = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)


@final
@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """F_emax [m g] of Fig. 8 at :data:`HEADINGS_DEG`, equal loads, every wheel in the same contact state."""

    surface: str
    state: str
    delta_deg: float
    per_weight: Array


def fig8_curves() -> tuple[Curve, ...]:
    """F_emax over orientation for both surfaces, all wheels on rollers and all on rigid material, δ = 15°.

    The symmetric layout, δ = 30°, is added for paper and rollers.
    """
    made = []
    for surface, rigid, delta_deg in (
        ("paper", False, 15.0),
        ("paper", True, 15.0),
        ("carpet", False, 15.0),
        ("carpet", True, 15.0),
        ("paper", False, 30.0),
    ):
        robot = paper_robot(improved=False, delta_rad=math.radians(delta_deg))
        model = nominal_model(robot, surface)
        force = limit(model, np.deg2rad(HEADINGS_DEG), Pull(), np.full(3, rigid))
        made.append(
            Curve(
                surface=surface,
                state="rigid" if rigid else "rollers",
                delta_deg=delta_deg,
                per_weight=force / model.inertia.weight_N,
            )
        )
    return tuple(made)


def figure8_rows() -> list[Row]:
    """Section IV.B: the force before sliding, over the robot's orientation."""
    whole = np.deg2rad(np.arange(0.0, 360.0, 1.0))
    model = paper_model("paper", improved=True)
    found = sweep(model, whole)
    force = found.f_max_N
    turned, mirrored = np.roll(force, -180), np.roll(force[::-1], 1)
    gap = float(np.max(np.abs(np.stack([turned, mirrored]) / force - 1.0)))
    deltas = np.arange(10.0, 46.0, 1.0)
    ripple, weakest = {}, {}
    for delta in deltas:
        robot = paper_robot(improved=False, delta_rad=math.radians(float(delta)))
        at = limit(nominal_model(robot, "paper"), whole, Pull())
        ripple[float(delta)] = float(np.max(np.abs(np.roll(at, -60) / at - 1.0)))
        weakest[float(delta)] = float(at.min() / model.inertia.weight_N)
    best = min(ripple, key=lambda d: ripple[d])
    band = float(found.f_high_N[0] / found.f_low_N[0])
    strongest = found.strongest[1] / found.weakest[1]
    weight = model.inertia.weight_N
    corners = len(wrench_set(model).zonotope().vertices())
    points = "the measured points of Fig. 8 are not in the text"
    return [
        number(
            "delta_preferable",
            best,
            f"of 10° to 45° the one whose F_emax repeats best every 60°; its weakest orientation holds "
            f"{weakest[30.0]:.3f} m g, δ = 15° {weakest[15.0]:.3f} m g",
        ),
        claim("fig8_polytope", corners, corners > 0, "a bounded set with finitely many vertices"),
        claim(
            "fig8_depends_on_orientation",
            strongest,
            strongest > 1.0 + 1e-6,
            f"{found.weakest[1] / weight:.4f} to {found.strongest[1] / weight:.4f} m g",
        ),
        claim("fig8_quarter_turn_suffices", round(gap, 12), gap < 1e-9, "holds at 0 up to rounding"),
        unchecked("fig8_agreement", f"{points}; the theoretical values are in the table of Fig. 8"),
        unchecked(
            "fig8_repeatability",
            f"{points}; a wheel stands on a roller or on rigid material, so one pull needs from "
            f"{found.f_low_N[0] / weight:.3f} to {found.f_high_N[0] / weight:.3f} m g",
            band,
        ),
    ]
