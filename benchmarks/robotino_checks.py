"""What no fit of the real robot has seen: motor currents, standing wheels, what comes round; slip limits."""

from __future__ import annotations

import numpy as np
from robotino_campaign import SIGMA, Campaign, Runs

from slipmargin.diagnosis.order_analysis import order_analysis
from slipmargin.diagnosis.prepare import clean
from slipmargin.diagnosis.problem import Problem
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
    runs in which it turns; b says what the drive coefficient is in truth, but for losses of the gear.
    """
    model = recipe.build("gray")
    weight, radius = model.inertia.weight_N, model.geometry.radius_m
    along = np.sign(np.sum(model.geometry.drive * model.geometry.grip, axis=1))  # forces are along ĝ
    rows: list[list[tuple[float, float, float]]] = [[] for _ in model.geometry.names]
    for runs in groups:
        force = runs.batch.run(pack(model), runs.starts, tell=True, rtol=1e-4).force
        assert force is not None
        for r, record in enumerate(runs.trials):
            assert record.current is not None and record.omega is not None
            late = np.flatnonzero(record.t_s > 2.0)
            rate = np.nanmean(record.omega[late], axis=0)
            speed, drives = np.abs(rate) * radius, -np.sign(rate) * along  # θ̇ > 0 pushes the robot along −ŝ
            for i in np.flatnonzero(speed > 0.005):  # a current at a standing wheel holds, it drives nothing
                rows[i].append(
                    (
                        float(drives[i] * force[r, late, i, 0].mean()) / weight,
                        float(speed[i]),
                        float(np.nanmean(record.current[late, i])),
                    )
                )
    told: dict[str, float] = {}
    for name, row in zip(model.geometry.names, rows, strict=True):
        load, speed, ampere = np.array(row).T
        line = np.column_stack([np.ones(len(load)), load, speed])
        a, b, c = np.linalg.lstsq(line, ampere, rcond=None)[0]
        told[f"wheel {name}: correlation"] = float(np.corrcoef(line @ (a, b, c), ampere)[0, 1])
        told[f"wheel {name}: left over [A]"] = float(np.std(ampere - line @ (a, b, c)))
        told[f"wheel {name}: spread [A]"] = float(np.std(ampere))
        told[f"wheel {name}: drive coefficient over gear efficiency"] = float(
            b * NEWTON_PER_AMPERE / weight * model.grip.roller[0, 0]
        )
    return told


def standing(groups: dict[str, Runs], recipe: Recipe) -> dict[str, dict[str, float]]:
    """Runs in which the heavy wheel 2 hardly turns: the way predicted too much, the current of the others.

    Such a wheel drags its rollers, or what lies between them, all the way at one angle that no log holds.
    """
    told = {}
    for speed, runs in groups.items():
        error = np.sum(runs.errors([recipe], "gray")[0][:, :2] * runs.direction, axis=1)
        beside = 50.0 * (np.roll(error, 1) + np.roll(error, -1))
        for name, record, along, next_to in zip(runs.names, runs.trials, error, beside, strict=True):
            assert record.theta is not None and record.current is not None
            if np.ptp(record.theta[:, 1]) < 0.5 * 2.0 * np.pi / 6.0:
                late = record.t_s > 2.0
                told[f"{speed} {name}"] = {
                    "predicted too far [%]": 100.0 * float(along),
                    "the headings beside it, mean [%]": float(next_to),
                    "current of wheels 1 and 3 [A]": float(np.nanmean(record.current[late][:, [0, 2]]) * 2.0),
                }
    return told


def turning(groups: dict[str, Runs], recipe: Recipe) -> dict[str, list[str]]:
    """Counts a turn at which what is left comes round with a wheel."""
    told = {}
    for speed, runs in groups.items():
        trials = tuple(clean(record, SIGMA) for record in runs.trials)
        problem = Problem.of(recipe, "gray", trials, SIGMA, False)
        predicted = problem.predict([()], [np.arange(len(trials), dtype=np.int64)])[0]
        told[speed] = [
            f"{r.per_turn} times a turn of wheels {', '.join(r.wheels)} (p ≤ {r.p_value:.3f})"
            for r in order_analysis(problem, problem.residual_rates(predicted), seed=0)
        ]
    return told


def floor(campaign: Campaign, recipe: Recipe, harmonics: int = 5) -> dict[str, float]:
    """What harmonics of the heading leave of the held-out runs, fitted to the errors of all runs of a speed.

    The rest is corrected for their number.
    """
    left = []
    for runs, rows in (
        (campaign.slow, np.setdiff1d(np.arange(len(campaign.slow.names)), campaign.seen)),
        (campaign.fast, np.arange(len(campaign.fast.names))),
    ):
        along = runs.direction
        across = np.column_stack([-along[:, 1], along[:, 0]])
        error = runs.errors([recipe], "gray")[0][:, :2]
        both = np.column_stack([np.sum(error * along, axis=1), np.sum(error * across, axis=1)])
        heading = np.arctan2(along[:, 1], along[:, 0])[:, None] * np.arange(1, harmonics + 1)
        waves = np.concatenate([np.ones((len(both), 1)), np.cos(heading), np.sin(heading)], axis=1)
        rest = both - waves @ np.linalg.lstsq(waves, both, rcond=None)[0]
        left.append(np.sum(rest[rows] ** 2, axis=1) * len(both) / (len(both) - waves.shape[1]))
    return {
        f"left by {harmonics} harmonics fitted to the errors of all runs [%]": 100.0
        * float(np.sqrt(np.concatenate(left).mean()))
    }


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
