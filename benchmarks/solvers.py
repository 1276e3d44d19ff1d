"""The pull limit against foreign solvers on drawn robots of 3 to 24 wheels, degenerate ones among them.

The programs are written here from the robot file's numbers alone and share no code with slipmargin's facets
or cone programs: SciPy's HiGHS solves the linear program of the box grip, CVXOPT's ``conelp`` the cone
programs of the elliptic and the disc-strip grip.

Run: ``python benchmarks/solvers.py [FILE.json] [--robots 2000]``.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from kept import write_figures
from scipy.optimize import linprog

import slipmargin as sm
from slipmargin.api.robots import model_of
from slipmargin.errors import SlipmarginError
from slipmargin.limits.pull import Pull
from slipmargin.limits.sweep import limit
from slipmargin.physics.constants import GRAVITY_M_S2

RESULTS = Path(__file__).parent / "results" / "solvers.json"
#: Orientations of a robot.
HEADINGS = 3
GRIPS = ("box", "box", "ellipse", "disc-strip")


def drawn(random: Random) -> dict[str, Any]:
    """A robot of 3 to 24 wheels; many are degenerate: parallel wheels, wheels in one place, no drag, thin."""
    count, size = random.randint(3, 24), 10.0 ** random.uniform(-1.5, 0.7)
    mecanum, odd = (
        random.random() < 0.4,
        random.choice(("", "", "", "parallel", "together", "no drag", "thin")),
    )
    wheels = []
    for i in range(count):
        at = 2.0 * math.pi * i / count + random.gauss(0.0, 0.1)
        reach = size * random.uniform(0.7, 1.3)
        x, y = reach * math.cos(at), reach * math.sin(at)
        if odd == "thin":
            y *= 1e-3
        if odd == "together" and i >= 3:
            x, y = wheels[i % 3]["position_m"]
        drive = 90.0 if mecanum else math.degrees(at) + 90.0
        if odd == "parallel" and i >= 3:
            drive = wheels[i % 3]["drive_direction_deg"]
        wheels.append(
            {
                "name": f"w{i}",
                "position_m": [x, y],
                "drive_direction_deg": drive,
                "radius_m": 0.3 * size,
                "roller_angle_deg": 45.0 * (-1.0) ** i if mecanum else 0.0,
            }
        )
    mass = 10.0 ** random.uniform(-1.0, 3.0)
    transverse = 0.0 if odd == "no drag" else random.uniform(0.0, 0.6)
    return {
        "schema": 1,
        "name": odd or "drawn",
        "body": {"mass_kg": mass, "inertia_kg_m2": 0.5 * mass * size**2},
        "loads": {"model": "equal"},
        "friction": {"law": "atan", "k_s_per_m": 1000.0, "grip": random.choice(GRIPS)},
        "wheel": wheels,
        "surface": {"floor": {"roller": {"drive": random.uniform(0.05, 1.2), "transverse": transverse},
                              "rigid": {"drive": 1.0, "transverse": 1.0}}},
    }  # fmt: skip


def program(robot: dict[str, Any], phi_rad: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Wrenches (3, 2N) of forces along and across the rollers, the pull's (3,), coefficients and m g / N."""
    wheels, mu = robot["wheel"], robot["surface"]["floor"]["roller"]
    place = np.array([w["position_m"] for w in wheels])
    angle = np.deg2rad([w["drive_direction_deg"] + w["roller_angle_deg"] for w in wheels])
    ways = [np.stack([np.cos(a), np.sin(a)], axis=1) for a in (angle, angle + 0.5 * np.pi)]
    maps = [np.vstack([w.T, place[:, 0] * w[:, 1] - place[:, 1] * w[:, 0]]) for w in ways]
    maps_of_all = np.hstack(maps) / np.array([1.0, 1.0, np.max(np.abs(place))])[:, None]
    pull = np.array([math.cos(phi_rad), -math.sin(phi_rad), 0.0])
    load = robot["body"]["mass_kg"] * GRAVITY_M_S2 / len(wheels)
    return maps_of_all, pull, np.array([mu["drive"], mu["transverse"]]), load


def foreign(robot: dict[str, Any], phi_rad: float) -> float:
    """The largest pull [N] by a solver that slipmargin does not use; not a number where it gives up."""
    maps, pull, mu, load = program(robot, phi_rad)
    count = maps.shape[1] // 2
    cost = np.append(np.zeros(2 * count), -1.0)
    balance = np.column_stack([maps, pull])
    sizes = np.repeat(mu, count)
    if robot["friction"]["grip"] == "box":
        bounds = [*((-s, s) for s in sizes), (0.0, None)]
        found = linprog(cost, A_eq=balance, b_eq=np.zeros(3), bounds=bounds, method="highs")
        return -found.fun * load if found.status == 0 else math.nan
    return load * _cone(cost, balance, mu, count, robot["friction"]["grip"])


def _cone(cost: np.ndarray, balance: np.ndarray, mu: np.ndarray, count: int, grip: str) -> float:
    from cvxopt import matrix, solvers

    solvers.options.update(show_progress=False, abstol=1e-10, reltol=1e-9, feastol=1e-9, maxiters=100)
    strip, rows, right = np.zeros((0, 2 * count + 1)), [], []
    if grip == "disc-strip":
        across = np.hstack([np.zeros((count, count)), np.eye(count), np.zeros((count, 1))])
        strip = np.vstack([across, -across])
    for i in range(count):
        cone = np.zeros((3, 2 * count + 1))
        cone[1, i] = -1.0 / mu[0]
        cone[2, count + i] = -1.0 / (mu[1] if grip == "ellipse" and mu[1] > 0.0 else mu[0])
        rows.append(cone)
        right.append([1.0, 0.0, 0.0])
    if grip == "ellipse" and mu[1] == 0.0:  # the ellipse is a line
        balance = balance.copy()
        balance[:, count : 2 * count] = 0.0
    try:
        found = solvers.conelp(
            matrix(cost),
            matrix(np.vstack([strip, *rows])),
            matrix(np.concatenate([np.full(len(strip), mu[1]), np.ravel(right)])),
            {"l": len(strip), "q": [3] * count, "s": []},
            matrix(balance),
            matrix(np.zeros(3)),
        )
    except (ValueError, ArithmeticError):
        return math.nan
    fine = found["status"] == "optimal" or (found["relative gap"] or 1.0) < 1e-9
    return -found["primal objective"] if fine else math.nan


def compare(count: int, seed: int) -> dict[str, Any]:
    """Worst relative difference for each grip, and how many robots and programs were compared."""
    random = Random(seed)
    rows: dict[str, dict[str, Any]] = {
        g: {"robots": 0, "programs": 0, "not_solved_by_the_other": 0, "worst": 0.0}
        for g in dict.fromkeys(GRIPS)
    }
    refused, robots = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "r.toml")
        while robots < count:
            robot = drawn(random)
            file.write_text(_toml(robot), encoding="utf-8")
            try:
                model, _ = model_of(sm.read_robot(file), "floor")
            except SlipmarginError:
                refused += 1
                continue
            robots += 1
            row = rows[robot["friction"]["grip"]]
            row["robots"] += 1
            for phi in (random.uniform(-math.pi, math.pi) for _ in range(HEADINGS)):
                ours, other = float(limit(model, np.array([phi]), Pull())[0]), foreign(robot, phi)
                if math.isnan(other):
                    row["not_solved_by_the_other"] += 1
                    continue
                row["programs"] += 1
                off = abs(ours - other) / max(abs(other), 1e-9 * model.inertia.weight_N)
                if off > row["worst"]:
                    row |= {"worst": off, "worst_wheels": model.count, "worst_kind": robot["name"]}
    return {"seed": seed, "robots": robots, "refused": refused, "grips": rows}


def _toml(robot: dict[str, Any]) -> str:
    import sys

    sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))
    from fuzz.mutate import toml

    return toml(robot)


def main() -> None:
    """Compare, print the table and keep it."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("file", nargs="?", type=Path, default=RESULTS)
    words.add_argument("--robots", type=int, default=2000)
    words.add_argument("--seed", type=int, default=1)
    asked = words.parse_args()
    found = compare(asked.robots, asked.seed)
    print(f"{'grip':<12}{'robots':>8}{'programs':>10}{'other gave up':>15}{'worst relative difference':>27}")
    for grip, row in found["grips"].items():
        print(
            f"{grip:<12}{row['robots']:>8}{row['programs']:>10}{row['not_solved_by_the_other']:>15}{row['worst']:>27.1e}"
        )
    write_figures(asked.file, found)


if __name__ == "__main__":
    main()
