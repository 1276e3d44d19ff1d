"""What the paths room promises, measured: speed, optimality, gain and dense check.

    python benchmarks/paths.py [--json FILE]     a table; the same figures as JSON

All ratios are of one run on one machine, times the least of several.  The proof by simulation is
``path_proof.py``.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from kept import Keeper

from slipmargin.io.robot_file import read_recipe
from slipmargin.limits.bounds import directions, headings
from slipmargin.limits.bounds_inside import inside
from slipmargin.model import Model
from slipmargin.model.parts import Drives
from slipmargin.paths import core
from slipmargin.paths.along import Rows
from slipmargin.paths.convex import Ellipsoids, convex_profile
from slipmargin.paths.geometry import Geometry
from slipmargin.paths.grid import Grid, grid_of
from slipmargin.paths.path import Path, corners, through
from slipmargin.paths.plan import Plan, Request, duration, plan
from slipmargin.paths.verify import on_rollers


def benchmark_paths() -> dict[str, Path]:
    """Straight, diagonal, slalom, figure of eight, turn while translating."""
    t = np.linspace(0.0, 2.0 * np.pi, 33)
    s = np.linspace(0.0, 3.0, 9)
    return {
        "straight": corners(np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])),
        "diagonal": corners(np.array([[0.0, 0.0, 0.0], [1.5, 1.5, 0.0]])),
        "slalom": through(np.column_stack([s, 0.25 * np.sin(2.0 * np.pi * s / 1.5), 0.0 * s])),
        "figure of eight": through(np.column_stack([np.sin(t), 0.5 * np.sin(2.0 * t), 0.0 * t])),
        "turn while translating": corners(np.array([[0.0, 0.0, 0.0], [2.0, 0.5, np.pi]])),
    }


def kiwi() -> Model:
    """The paper's robot on paper, all wheels on rollers."""
    return on_rollers(read_recipe("ohio-kiwi").build("paper"))


def facet_rows(way: Path, grid: Grid, count: int = 22, seed: int = 0) -> Rows:
    """``count`` drawn facets on the pose's acceleration: a planner's load without a robot."""
    normals = np.random.default_rng(seed).normal(size=(count // 2, 3))
    normals = np.vstack([normals, -normals]) / np.tile(np.linalg.norm(normals, axis=1), 2)[:, None]
    jets = [way.at(s, grid.piece) for s in (grid.s[:-1], grid.s[1:])]
    return Rows(
        a=np.stack([j[1] @ normals.T for j in jets]),
        b=np.stack([j[2] @ normals.T for j in jets]),
        c=np.ones((2, len(grid.step), count)),
        cap=np.full(len(grid.s), np.inf),
        names=("facet",) * count,
        wheels=np.ones((count, 1), dtype=bool),
    )


def solve(rows: Rows, step: Any) -> tuple[Any, Any]:
    """One backward and forward pass from rest to rest."""
    n = len(step)
    x, u, highest = np.zeros(n + 1), np.zeros(n), np.zeros(n + 1)
    status = core.profile(
        step,
        rows.a[0],
        rows.b[0],
        rows.c[0],
        rows.a[1],
        rows.b[1],
        rows.c[1],
        rows.cap,
        0.0,
        0.0,
        x,
        u,
        highest,
    )
    assert status[0] == core.OK, status
    return x, u


def clock(action: Callable[[], object], times: int) -> float:
    """Least time of a call [ms], after one call to warm up: whatever else a machine does only adds to it."""
    action()
    spent = []
    for _ in range(times):
        start = time.perf_counter()
        action()
        spent.append(1e3 * (time.perf_counter() - start))
    return min(spent)


def speed() -> dict[str, Any]:
    """1 000 grid points × 22 facets, and bounds for 360 headings, of four wheels at 0.9 of the grip too."""
    way = benchmark_paths()["figure of eight"]
    s = np.linspace(0.0, way.length, 1001)
    grid = Grid(s=s, piece=np.zeros(1000, dtype=np.int64))
    rows, model, around = facet_rows(way, grid), kiwi(), headings(1.0)
    four = on_rollers(read_recipe("mecanum4").build("carpet"))
    out: dict[str, Any] = {
        "profile_1000x22_ms": clock(lambda: solve(rows, grid.step), 300),
        "bounds_360_ms": clock(lambda: directions(model, around), 300),
        "bounds_360_four_wheels_ms": clock(lambda: directions(four, around, share=0.9), 300),
        "whole_plan_ms": clock(lambda: plan(model, way, Request(points=400)), 10),
    }
    mine = duration(grid.step, solve(rows, grid.step)[0])
    out["cvxpy_ms"] = clock(lambda: convex_profile(grid.step, rows), 5)
    out["cvxpy_duration_ratio"] = convex_profile(grid.step, rows).duration_s / mine
    with_toppra = toppra_run(way, s, 22)
    if with_toppra is not None:
        out |= {
            "toppra_ms": with_toppra["ms"],
            "toppra_duration_ratio": with_toppra["duration_s"] / mine,
            "toppra_default_worst_use": with_toppra["worst_use"],
            "own_worst_use_before_tightening": worst_between(way, grid, solve(rows, grid.step)),
        }
    return out


def worst_between(way: Path, grid: Grid, profile: tuple[Any, Any], count: int = 22) -> float:
    """Largest facet value of our profile, 20 times finer than the grid (limit 1)."""
    normals = np.random.default_rng(0).normal(size=(count // 2, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    x, u = profile
    part = np.linspace(0.0, 1.0, 21)
    s, piece = grid.inside(part)
    _, first, second = (a.reshape(*s.shape, 3) for a in way.at(s.ravel(), piece.ravel()))
    sq = x[:-1, None] + part * np.diff(x)[:, None]
    return float(np.max(np.abs((first * u[:, None, None] + second * sq[..., None]) @ normals.T)))


def toppra_run(way: Path, s: Any, count: int) -> dict[str, float] | None:
    """toppra on the same facets: interpolation scheme, and its default output sampled finely."""
    try:
        import toppra as ta
        import toppra.constraint as tc
    except ImportError:
        return None
    ta.setup_logging("ERROR")
    normals = np.random.default_rng(0).normal(size=(count // 2, 3))
    normals = np.vstack([normals, -normals]) / np.tile(np.linalg.norm(normals, axis=1), 2)[:, None]
    spline = ta.SplineInterpolator(s, way.pose(s))
    limit = tc.SecondOrderConstraint(lambda q, v, a: a, lambda q: normals, lambda q: np.ones(count), 3)
    limit.set_discretization_type(1)
    made: list[Any] = []

    def go() -> None:
        run = ta.algorithm.TOPPRA(
            [limit], spline, gridpoints=s, solver_wrapper="seidel", parametrizer="ParametrizeSpline"
        )
        made.append(run.compute_trajectory(0.0, 0.0))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spent = clock(go, 30)
    times = np.linspace(0.0, made[-1].duration, 20 * len(s))
    return {
        "ms": spent,
        "duration_s": float(made[-1].duration),
        "worst_use": float(np.max(made[-1](times, 2) @ normals.T)),
    }


def box_rows(model: Model, way: Path, grid: Grid, half: Any) -> Rows:
    """Rows |a_j| ≤ half_j on the body's acceleration."""
    shape = Geometry.of(model, way, grid, np.array([0.0, 1.0]))
    sides = np.vstack([np.eye(3), -np.eye(3)]) / np.tile(half, 2)[:, None]
    push, bend = shape.push, shape.bend  # the paper's robot has its centre of mass at the origin
    return Rows(
        a=np.stack([push[:, e] @ sides.T for e in (0, 1)]),
        b=np.stack([bend[:, e] @ sides.T for e in (0, 1)]),
        c=np.ones((2, len(grid.step), 6)),
        cap=np.full(len(grid.s), np.inf),
        names=("box",) * 6,
        wheels=np.ones((6, model.count), dtype=bool),
    )


def gains(share: float = 0.9) -> dict[str, Any]:
    """How much faster than the best safe box and the best safe ellipsoid on the benchmark paths."""
    model = kiwi()
    sets = inside(model, share=share)
    out = {}
    for name, way in benchmark_paths().items():
        grid = grid_of(way, 300)
        own: Plan = plan(model, way, Request(share=share), grid=grid)
        box = duration(grid.step, solve(box_rows(model, way, grid, sets.even), grid.step)[0])
        shape = Geometry.of(model, way, grid, np.array([0.0, 1.0]))
        free = replace(box_rows(model, way, grid, sets.even), c=np.full((2, len(grid.step), 6), 1e9))
        round_ = convex_profile(
            grid.step,
            free,
            ellipsoids=Ellipsoids(
                Q=np.linalg.inv(sets.ellipsoid),
                push=np.swapaxes(shape.push, 0, 1),
                bend=np.swapaxes(shape.bend, 0, 1),
            ),
        )
        circle = (
            convex_profile(
                grid.step,
                free,
                ellipsoids=Ellipsoids(
                    Q=np.diag([1.0, 1.0, 0.0]) / sets.circle_m_s2,
                    push=np.swapaxes(shape.push, 0, 1),
                    bend=np.swapaxes(shape.bend, 0, 1),
                ),
            )
            if name != "turn while translating"
            else round_
        )
        same = convex_profile(grid.step, own.rows)
        best = min(box, round_.duration_s, circle.duration_s)
        out[name] = {
            "own_s": own.duration_s,
            "box_s": box,
            "ellipsoid_s": round_.duration_s,
            "circle_s": circle.duration_s,
            "gain_over_best": best / own.duration_s - 1.0,
            "convex_ratio": same.duration_s / own.duration_s,
            "max_use": own.max_use,
        }
    return out


def motors() -> dict[str, Any]:
    """What the grid changes where the motors' torque–speed line limits: times on grids of 25 to 800 points.

    A row of the line is steep over a long interval; a planner that then takes the fastest start of each
    interval stops in mid-path.
    """
    strong = on_rollers(read_recipe("ohio-kiwi").build("paper"))
    drives = Drives(stall_torque_N_m=0.09, max_speed_rad_s=35.0)
    model = replace(strong, drives=drives)
    out: dict[str, Any] = {}
    for name, way in {
        "10 m straight ahead": corners(np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])),
        "5 m and a bend": through(np.array([[0.0, 0.0, 0.0], [0.0, 5.0, 0.0], [-5.0, 5.0, 3.0]])),
        **benchmark_paths(),
    }.items():
        times = {
            n: plan(model, way, Request(points=n, share=0.9)).duration_s for n in (25, 50, 100, 200, 400, 800)
        }
        out[name] = {f"{n}_points_s": t for n, t in times.items()}
        out[name]["longest_over_finest"] = max(times.values()) / times[800]
    return out


def main(words: list[str]) -> None:
    """Measure and print."""
    keeper, _ = Keeper.of(words, __doc__)
    rows = keeper.run([("speed", speed), ("gains", gains), ("motors", motors)])
    for row in rows:
        for name, value in row.items():
            if isinstance(value, dict):
                print(f"{name:24s} " + "  ".join(f"{k} {v:.5g}" for k, v in value.items()))
            elif name != "set":
                print(f"{name:34s} {value:10.4g}")


if __name__ == "__main__":
    main(sys.argv[1:])
