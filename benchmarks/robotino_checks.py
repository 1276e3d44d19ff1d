"""What no fit of the real robot has seen: motor currents against predicted drive forces; slip limits."""

from __future__ import annotations

import numpy as np
from robotino_campaign import Runs

from slipmargin.effects import Recipe
from slipmargin.limits.bounds import directions
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.sim.pack import pack

#: Wheel force per motor current of the Robotino: torque constant · gear / wheel radius [N/A], no losses.
NEWTON_PER_AMPERE = 0.0514 * 16.0 / 0.04


def currents(groups: list[Runs], recipe: Recipe) -> dict[str, float]:
    """Motor currents, which no fit has seen, against the drive forces that the model predicts.

    By wheel: I = a + b F / W + c |wheel speed|, F > 0 where the motor drives, over the steady part of all
    runs in which it turns; the level b says what the drive coefficient (1 in the model) is in truth, but
    for the gear's losses.
    """
    model = recipe.build("gray")
    weight, radius = model.inertia.weight_N, model.contacts.radius_m
    rows: list[list[tuple[float, float, float]]] = [[] for _ in model.contacts.names]
    for runs in groups:
        force = runs.batch.run(pack(model), runs.starts, tell=True, rtol=1e-4).force
        assert force is not None
        for r, record in enumerate(runs.trials):
            assert record.current is not None and record.omega is not None
            late = np.flatnonzero(record.t_s > 2.0)
            rate = np.nanmean(record.omega[late], axis=0)
            speed, drives = np.abs(rate) * radius, -np.sign(rate)  # θ̇ > 0 pushes the robot along −ŝ
            for i in np.flatnonzero(speed > 0.005):  # a current at a standing wheel holds, it drives nothing
                rows[i].append(
                    (
                        float(drives[i] * force[r, late, i, 0].mean()) / weight,
                        float(speed[i]),
                        float(np.nanmean(record.current[late, i])),
                    )
                )
    told: dict[str, float] = {}
    for name, row in zip(model.contacts.names, rows, strict=True):
        load, speed, ampere = np.array(row).T
        line = np.column_stack([np.ones(len(load)), load, speed])
        a, b, c = np.linalg.lstsq(line, ampere, rcond=None)[0]
        told[f"wheel {name}: correlation"] = float(np.corrcoef(line @ (a, b, c), ampere)[0, 1])
        told[f"wheel {name}: left over [A]"] = float(np.std(ampere - line @ (a, b, c)))
        told[f"wheel {name}: spread [A]"] = float(np.std(ampere))
        told[f"wheel {name}: drive coefficient over gear efficiency"] = float(b * NEWTON_PER_AMPERE / weight)
    return told


def limits(recipe: Recipe, steepness: float | None = None) -> dict[str, float]:
    """Slip limits of the robot in units of μ m g and μ g, μ its drive coefficient, over all directions."""
    model = recipe.build("gray")
    heading = np.deg2rad(np.arange(0.0, 360.0, 5.0))
    grip = float(model.grip.roller[0, 0])
    pull = limit(model, heading, Pull()) / model.inertia.weight_N / grip
    start = directions(model, heading).starting_m_s2 / 9.81 / grip
    told = {
        "weakest pull [μ m g]": float(pull.min()),
        "strongest pull [μ m g]": float(pull.max()),
        "least acceleration from rest [μ g]": float(start.min()),
        "greatest acceleration from rest [μ g]": float(start.max()),
    }
    if steepness is not None:  # eq. (11) in the slip ratio, solved for the ratio
        for use in (0.1, 0.3, 0.5):
            name = f"way a drive wheel loses at {100 * use:.0f} % of its grip [1]"
            told[name] = float(np.tan(np.pi * use / 2.0) / steepness)
    return told
