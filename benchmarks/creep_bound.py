"""How far a wheel creeps below its limit: simulated ramps against two bounds (docs/theory.md, section 4).

    python benchmarks/creep_bound.py benchmarks/results/creep_bound.json

Drawn robots of three to five wheels (omni and mecanum, centre of mass anywhere near the middle) speed up from
rest along drawn headings, open loop, with an acceleration that asks no wheel for more than the share λ of its
grip.
The script searches for a creep above σ⁻¹(λ)/k, the creep at the share asked, and above the proven bound.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from kept import with_file, write_figures

import slipmargin as sm
from slipmargin.errors import NoSolution
from slipmargin.limits.bounds import directions
from slipmargin.limits.creep_bound import proven_creep
from slipmargin.model import nominal_model
from slipmargin.physics.friction_laws import ATAN, law_inverse, law_share
from slipmargin.robot import Body, Coefficients, LoadRule, Robot, Surface, Wheel

SHARES = (0.5, 0.8, 0.9, 0.95)
ROBOTS, TOP_M_S, STEP_S = 60, 0.5, 1e-3


def drawn(rng: np.random.Generator) -> Robot:
    """A robot with its wheels about evenly round a circle, or four mecanum wheels."""
    count = int(rng.integers(3, 6))
    mecanum = count == 4 and rng.random() < 0.5
    angle = 2.0 * np.pi * (np.arange(count) + rng.uniform(-0.12, 0.12, count)) / count
    place = rng.uniform(0.08, 0.25) * np.column_stack([np.cos(angle), np.sin(angle)])
    turn = np.rad2deg(angle) + 90.0 + rng.uniform(-10.0, 10.0, count)
    roller = np.zeros(count)
    if mecanum:
        place = np.array([[0.15, 0.2], [-0.15, 0.2], [-0.15, -0.2], [0.15, -0.2]])
        turn, roller = np.full(4, 90.0), np.array([45.0, -45.0, 45.0, -45.0])
    mass, reach = float(rng.uniform(2.0, 20.0)), float(np.max(np.hypot(*place.T)))
    mu = float(rng.uniform(0.25, 0.8))
    pair = Coefficients(drive=mu, transverse=float(rng.uniform(0.02, 0.3)) * mu)
    return Robot(
        name="drawn",
        body=Body(
            mass_kg=mass,
            inertia_kg_m2=float(rng.uniform(0.3, 1.0)) * mass * reach**2,
            com_m=rng.uniform(-0.1, 0.1, 2) * reach,
        ),
        wheels=tuple(
            Wheel(name=f"w{i}", position_m=p, drive_direction_deg=float(t), radius_m=0.03, roller_angle_deg=r)
            for i, (p, t, r) in enumerate(zip(place, turn, map(float, roller), strict=True))
        ),
        surfaces=(Surface(name="floor", roller=pair, rigid=pair),),
        load_rule=LoadRule.STATIC,
    )


def ramp(robot: Robot, heading: float, share: float) -> dict[str, float] | None:
    """One ramp: the share that the fastest creep stands for, and the creep over both bounds."""
    model = nominal_model(robot, "floor")
    limit = float(directions(model, np.array([heading]), share=share, motor=False).starting_m_s2[0])
    if limit <= 0.05:
        return None
    time = np.linspace(0.0, TOP_M_S / limit, 201)
    twist = np.zeros((time.size, 3))
    twist[:, :2] = np.outer(limit * time, [np.cos(heading), np.sin(heading)])
    omega = model.geometry.wheel_speeds(twist)
    found = sm.simulate(robot, "floor", np.column_stack([time, omega]), linear=True, step_s=STEP_S)
    k = model.grip.k_s_per_m
    creep = found.peak_slip_m_s
    proven = proven_creep(model, share, speed_m_s=TOP_M_S)
    return {
        "share": share,
        "used": float(law_share(ATAN, k * creep)),
        "over_the_share_asked": creep * k / float(law_inverse(ATAN, share)),
        "over_the_proven": creep / float(np.max(proven)),
    }


def search(robots: int, seed: int) -> dict[str, Any]:
    """The largest creep of all ramps over each bound."""
    rng, runs = np.random.default_rng(seed), []
    for _ in range(robots):
        robot = drawn(rng)
        for share in SHARES:
            try:
                one = ramp(robot, float(rng.uniform(0.0, 2.0 * np.pi)), share)
            except NoSolution:
                continue
            runs += [one] if one else []
    by_share = {}
    for share in SHARES:
        mine = [r for r in runs if r["share"] == share]
        by_share[f"{share:g}"] = {
            "runs": len(mine),
            "largest_excess_of_share": max(r["used"] - share for r in mine),
            "largest_over_the_share_asked": max(r["over_the_share_asked"] for r in mine),
            "largest_over_the_proven": max(r["over_the_proven"] for r in mine),
        }
    return {"seed": seed, "robots": robots, "top_m_s": TOP_M_S, "by_share": by_share}


if __name__ == "__main__":
    file = with_file(__doc__).parse_args().file
    result = search(ROBOTS, 0)
    write_figures(file, result)
    print(json.dumps(result, indent=1))
