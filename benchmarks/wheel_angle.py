"""The paper's claim tested: where is δ = 30° best, for what, by how much over 15°, and when is it not?

Run: ``python benchmarks/wheel_angle.py [--laps] [FILE.json]``.  Prints the tables that the README quotes.
``--laps`` adds the time over the benchmark paths (half a second a design).
"""

from __future__ import annotations

import math

import numpy as np
from kept import with_file

from slipmargin.io.json_text import json_text
from slipmargin.io.robot_file import read_recipe
from slipmargin.study.laps import lap_time
from slipmargin.study.objectives import BY_NAME, Kind, objective
from slipmargin.study.optimum import optimum
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.study import DesignProblem, Study, study
from slipmargin.study.vary import applied, parse_vary, quantity_of

SHOWN = (
    "f_worst",
    "f_mean",
    "f_best",
    "isotropy",
    "yaw_moment_N_m",
    "f_rigid_worst",
    "start_worst_m_s2",
    "start_mean_m_s2",
    "brake_worst_m_s2",
    "brake_mean_m_s2",
    "corner_m_s",
    "spin_rad_s2",
    "slip_share",
    "slip_share_rigid",
    "steady_use_unknown",
)
#: Objectives whose optimum is sought between the grid's angles.
SHARP = ("f_worst", "f_mean", "isotropy", "f_rigid_worst")
LAP_ANGLES = (0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0)


def angle_study(surface: str, loads: str) -> Study:
    """δ from 0° to 60° in half degrees on one surface under one load model."""
    design = RobotOnSurface(recipe=read_recipe("ohio-kiwi"), surface=surface)
    design = applied(design, [quantity_of("load_model")], [loads])
    return study(
        DesignProblem(
            base=design, grids=(parse_vary("delta_deg=0:60:0.5"),), kinds=(Kind.STATIC, Kind.MOTION)
        )
    )


def angle_rows(surface: str, loads: str) -> list[dict[str, object]]:
    """For each objective: best δ, its value, the values at 15° and 30°, and whether 30° is best."""
    found = angle_study(surface, loads)
    at = {v[0]: i for i, v in enumerate(found.values)}
    rows = []
    for name in SHOWN:
        column, goal = found.columns[name], BY_NAME[name]
        if np.all(np.isnan(column)):
            continue
        tied = [float(found.values[i][0]) for i in found.ties(name)]
        best = found.best(name)
        delta, value = float(found.values[best][0]), float(column[best])
        if name in SHARP and len(tied) == 1:
            between = optimum(found, objective(name))
            delta, value = float(between.values[0]), between.value
        rows.append(
            {
                "surface": surface,
                "loads": loads,
                "objective": name,
                "unit": goal.unit,
                "best_delta_deg": delta,
                "ties_deg": [min(tied), max(tied)],
                "best": value,
                "at_15": float(column[at[15.0]]),
                "at_30": float(column[at[30.0]]),
                "thirty_is_best": abs(float(column[at[30.0]]) - value) <= 1e-6 * abs(value),
            }
        )
    return rows


def lap_rows(surface: str, loads: str) -> dict[float, float]:
    """Time over the benchmark paths by δ [s]; infinite where one of them must slip."""
    design = applied(
        RobotOnSurface(recipe=read_recipe("ohio-kiwi"), surface=surface), [quantity_of("load_model")], [loads]
    )
    return {d: lap_time(applied(design, [quantity_of("delta_deg")], [d]).build()) for d in LAP_ANGLES}


def wheel_rows() -> list[dict[str, object]]:
    """Omni and mecanum, three to six wheels, one body, floor and wheel: the layout alone differs.

    ``ring``: wheels round the body, drives tangential; ``rows``: a mecanum car on the same circle.
    """
    start = RobotOnSurface(recipe=read_recipe("omni4"), surface="floor")
    cases = [("omni ring", ("wheels", "roller_angle_deg"), (n, 0.0)) for n in (3, 4, 5, 6)]
    cases += [("mecanum ring", ("wheels", "roller_angle_deg"), (n, 45.0)) for n in (3, 4, 5, 6)]
    cases += [("mecanum rows", ("wheels_in_rows", "roller_angle_deg"), (n, 45.0)) for n in (4, 6)]
    rows = []
    for kind, keys, values in cases:
        design = applied(start, [quantity_of(k) for k in (*keys, "circle_radius_m")], (*values, 0.2))
        found = study(
            DesignProblem(base=design, grids=(parse_vary("surface=floor"),), kinds=(Kind.STATIC, Kind.MOTION))
        )
        rows.append({"layout": kind, "wheels": values[0], **found.own})
    return rows


def main() -> None:
    """Print the tables; write JSON where a file is named."""
    parser = with_file(__doc__)
    parser.add_argument(
        "--laps", action="store_true", help="times over the benchmark paths too, which is slow"
    )
    given = parser.parse_args()
    angles = [
        row
        for surface in ("paper", "carpet")
        for loads in ("equal", "static")
        for row in angle_rows(surface, loads)
    ]
    print(
        f"{'surface':<8}{'loads':<8}{'objective':<20}{'unit':<8}{'best δ':>14}{'best':>10}{'at 15°':>10}"
        f"{'at 30°':>10}{'30° over 15°':>14}  30° best?"
    )
    for r in angles:
        low, high = r["ties_deg"]  # type: ignore[misc]
        where = f"{r['best_delta_deg']:.1f}" if low == high else f"{low:g} to {high:g}"
        print(
            f"{r['surface']:<8}{r['loads']:<8}{r['objective']:<20}{r['unit']:<8}{where:>14}{_n(r['best']):>10}"
            f"{_n(r['at_15']):>10}{_n(r['at_30']):>10}{_gain(r['at_30'], r['at_15']):>14}  "
            f"{'yes' if r['thirty_is_best'] else 'no'}"
        )
    out: dict[str, object] = {"angles": angles}
    if given.laps:
        laps = {f"{s} {w}": lap_rows(s, w) for s in ("paper", "carpet") for w in ("equal", "static")}
        print("\nTime over the benchmark paths [s] by δ [deg], 10 % margin, – where one must slip")
        print(" " * 16 + "".join(f"{d:>8g}" for d in LAP_ANGLES))
        for name, times in laps.items():
            cells = ("–" if math.isinf(t) else f"{t:.2f}" for t in times.values())
            print(f"{name:<16}" + "".join(f"{cell:>8}" for cell in cells))
        out["laps"] = laps
    wheels = wheel_rows()
    shown = (
        "f_worst",
        "f_mean",
        "f_best",
        "isotropy",
        "yaw_moment_N_m",
        "start_worst_m_s2",
        "brake_worst_m_s2",
        "spin_rad_s2",
        "slip_share_rigid",
    )
    print("\nomni4's body, wheels on a circle of 0.2 m, drive 0.4 and transverse as in its file")
    print(f"{'layout':<14}{'wheels':>7}" + "".join(f"{name:>18}" for name in shown))
    for r in wheels:
        print(f"{r['layout']:<14}{r['wheels']:>7}" + "".join(f"{_n(r[name]):>18}" for name in shown))
    out["wheels"] = wheels
    if given.file is not None:
        given.file.write_text(json_text(out), encoding="utf-8")


def _n(value: object) -> str:
    number = float(value)  # type: ignore[arg-type]
    return "–" if math.isnan(number) else f"{number:.4g}"


def _gain(new: object, old: object) -> str:
    a, b = float(new), float(old)  # type: ignore[arg-type]
    if math.isnan(a) or math.isnan(b):
        return "–"
    percent = round(100.0 * (a / b - 1.0), 1) if b > 0.0 else math.nan
    return f"{percent + 0.0:+.1f} %" if b > 0.0 else f"{a - b:+.3g}"


if __name__ == "__main__":
    main()
