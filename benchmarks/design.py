"""A δ study as one array against a linear program for each point: δ 0–60° × 721 headings × both surfaces.

Run: ``python benchmarks/design.py [FILE.json]``.  The naive road, cvxpy with the problem of eqs 12–18 rebuilt
at each point, is timed on a few points of the same run and multiplied: extrapolated, not run.  All answers
of the sample are compared.
"""

from __future__ import annotations

import statistics
import time

import numpy as np
from kept import with_file

from slipmargin.checks import Array
from slipmargin.io.json_text import json_text
from slipmargin.io.robot_file import read_recipe
from slipmargin.model import Model
from slipmargin.study.batch import batches
from slipmargin.study.columns import static_columns
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.statics import headings, on_rollers
from slipmargin.study.vary import applied, parse_vary, product

GRIDS = ("surface=paper,carpet", "delta_deg=0:60:0.5")
#: What was promised [s].
PROMISED_S = 0.1


def designs() -> list[RobotOnSurface]:
    """242 machines: 121 angles on two surfaces."""
    start = RobotOnSurface(recipe=read_recipe("ohio-kiwi"), surface="paper")
    grids = [parse_vary(text) for text in GRIDS]
    return [applied(start, [g.quantity for g in grids], values) for values in product(start, grids)]


def vectorised() -> Array:
    """F_emax / (m g) of every design at 721 headings, (242, 721): from the grids to the numbers."""
    machines = designs()
    (batch,), _ = batches(machines)
    return on_rollers(batch, headings(), machines)


def every_static_column() -> float:
    """All static columns: also the band, rigid material, equal and static loads side by side."""
    return float(np.min(static_columns(list(designs()))[0]["f_worst"]))


def naive(model: Model, phi_rad: float) -> float:
    """One point as written in the paper: 2N forces, three balances, solved by cvxpy [m g]."""
    import cvxpy as cp

    along, across = model.wrench_maps()
    push, slide, force = cp.Variable(model.count), cp.Variable(model.count), cp.Variable()
    pull = np.array([np.cos(phi_rad), -np.sin(phi_rad), 0.0])
    load = model.loads.rest_N / model.inertia.weight_N
    problem = cp.Problem(
        cp.Maximize(force),
        [
            along @ push + across @ slide + force * pull == 0.0,
            cp.abs(push) <= model.grip.roller[:, 0] * load,
            cp.abs(slide) <= model.grip.roller[:, 1] * load,
        ],
    )
    problem.solve(solver="CLARABEL")
    return float(force.value)


def measure(repeats: int = 15, points: int = 40) -> dict[str, float]:
    """Median and best time of the study [s], a naive point [s], the ratio, the largest disagreement [1]."""
    force = vectorised()
    times, all_times = [], []
    for _ in range(repeats):
        start = time.perf_counter()
        vectorised()
        times.append(time.perf_counter() - start)
        start = time.perf_counter()
        every_static_column()
        all_times.append(time.perf_counter() - start)
    machines, phi, rng = designs(), headings(), np.random.default_rng(7)
    rows, columns = rng.integers(len(machines), size=points), rng.integers(len(phi), size=points)
    naive(machines[0].build(), 0.0)  # imports and the first compilation are not counted
    each, gap = [], 0.0
    for d, m in zip(rows.tolist(), columns.tolist(), strict=True):
        model = machines[d].build()
        start = time.perf_counter()
        value = naive(model, float(phi[m]))
        each.append(time.perf_counter() - start)
        gap = max(gap, abs(value / force[d, m] - 1.0))
    total = statistics.median(each) * force.size
    return {
        "points": float(force.size),
        "study_median_s": statistics.median(times),
        "study_best_s": min(times),
        "every_static_column_median_s": statistics.median(all_times),
        "naive_point_median_s": statistics.median(each),
        "naive_extrapolated_s": total,
        "ratio": total / statistics.median(times),
        "worst_disagreement": gap,
    }


def main() -> None:
    """Print the table; write JSON where a file is named."""
    file = with_file(__doc__).parse_args().file
    found = measure()
    print(f"δ 0–60° in 0.5° steps × 721 headings × 2 surfaces: {found['points']:.0f} limits")
    print(
        f"  one array                {found['study_median_s']:9.4f} s median, "
        f"{found['study_best_s']:.4f} s best   promised {PROMISED_S:g} s"
    )
    print(f"  every static column      {found['every_static_column_median_s']:9.4f} s median")
    print(
        f"  cvxpy, point by point    {found['naive_extrapolated_s'] / 60.0:9.1f} min, extrapolated from "
        f"{1e3 * found['naive_point_median_s']:.2f} ms each"
    )
    print(
        f"  ratio {found['ratio']:.0f}; largest disagreement on the sample {found['worst_disagreement']:.1e}"
    )
    if file is not None:
        file.write_text(json_text(found), encoding="utf-8")


if __name__ == "__main__":
    main()
