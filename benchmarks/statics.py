"""F_emax and wrench sets: our roads beside the alternatives, measured in one run.

Run: ``python benchmarks/statics.py [FILE.json] [--quick]``.  Medians of several repeats.
The alternatives are written as their own documentation shows: a problem built in cvxpy for each heading,
one cvxpy problem with parameters (DPP), SciPy's HiGHS, pycapacity's two polytope algorithms.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from kept import write_figures

from slipmargin.limits import Pull, isotropic, sweep, wrench_set
from slipmargin.limits.cones import limit_family
from slipmargin.limits.friction import coefficients
from slipmargin.limits.rows import facet_rows, largest, pull_geometry
from slipmargin.model import Model, nominal_model
from slipmargin.robot import Body, Coefficients, Robot, Surface, Wheel
from slipmargin.sets.facets import batch_ray_exit, ray_exit
from slipmargin.sets.zonotope import Zonotope

HEADINGS = np.linspace(0.0, 2.0 * np.pi, 721)
#: What was promised: name -> (value, unit).
PROMISED = {
    "facets, from the model": (1000.0, "µs a sweep"),
    "cvxpy, one block problem": (120.0, "µs a heading"),
    "Clarabel, updated": (70.0, "µs a heading"),
    "zonotope, 20 generators": (2.0, "ms"),
    "121 wheel angles × 721 headings": (50.0, "ms"),
}


def robot(delta_deg: float = 15.0) -> Robot:
    """The paper's robot (docs/theory.md, section 1) on its paper surface."""
    axle = np.deg2rad([delta_deg, 180.0 - delta_deg, -90.0])
    wheels = tuple(
        Wheel(
            name=str(i + 1),
            position_m=0.095 * np.array([np.cos(a), np.sin(a)]),
            radius_m=0.0254,
            drive_direction_deg=float(np.rad2deg(a)) + 90.0,
            rigid_fraction=0.1,
        )
        for i, a in enumerate(axle)
    )
    paper = Surface(
        name="paper",
        roller=Coefficients(drive=0.26, transverse=0.09),
        rigid=Coefficients(drive=0.47, transverse=0.47),
    )
    return Robot(
        name="paper robot", body=Body(mass_kg=3.0, inertia_kg_m2=0.027), wheels=wheels, surfaces=(paper,)
    )


def median_s(run: Callable[[], object], repeats: int) -> float:
    """Median wall time [s]; one run first to warm up."""
    run()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def box_problem(model: Model) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """B (3, n), limits (n,) and rays (M, 3): all that the alternatives are given."""
    found = wrench_set(model)
    limits = (found.coefficients[..., 1] * found.load_N[:, None]).ravel()
    return found.maps.reshape(3, -1), limits, Pull().rays(model, HEADINGS)


def naive_cvxpy(b: np.ndarray, limits: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """A new problem for each heading."""
    import cvxpy as cp

    out = []
    for ray in rays:
        f, reach = cp.Variable(len(limits)), cp.Variable()
        problem = cp.Problem(cp.Maximize(reach), [b @ f == reach * ray, cp.abs(f) <= limits])
        problem.solve(solver=cp.CLARABEL)
        out.append(reach.value)
    return np.array(out, dtype=float)


def parameter_cvxpy(b: np.ndarray, limits: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """One problem whose direction is a parameter (disciplined parametrised programming)."""
    import cvxpy as cp

    f, reach, ray = cp.Variable(len(limits)), cp.Variable(), cp.Parameter(3)
    problem = cp.Problem(cp.Maximize(reach), [b @ f == reach * ray, cp.abs(f) <= limits])
    out = []
    for value in rays:
        ray.value = value
        problem.solve(solver=cp.CLARABEL)
        out.append(reach.value)
    return np.array(out, dtype=float)


def scipy_highs(b: np.ndarray, limits: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """scipy.optimize.linprog with method highs, for each heading."""
    from scipy.optimize import linprog

    cost = np.append(np.zeros(len(limits)), -1.0)
    bounds = [(-m, m) for m in limits] + [(0.0, None)]
    return np.array(
        [
            -linprog(
                cost, A_eq=np.column_stack([b, -ray]), b_eq=np.zeros(3), bounds=bounds, method="highs"
            ).fun
            for ray in rays
        ]
    )


def sweeps(quick: bool) -> dict[str, dict[str, float]]:
    """Seconds a heading of every road over the 721 headings, and the worst disagreement."""
    from slipmargin.solve import clarabel_, cvxpy_

    model = nominal_model(robot(), "paper")
    b, limits, rays = box_problem(model)
    reference = sweep(model, HEADINGS, with_band=False).f_max_N
    state, geometry = np.zeros(3, dtype=bool), pull_geometry(model, HEADINGS, Pull())
    half = geometry.normals[: len(geometry.normals) // 2]
    height = np.abs(half @ (b * limits)).sum(axis=1)

    def cached() -> np.ndarray:
        return ray_exit(half, height, rays)

    def cached_rows() -> np.ndarray:
        return largest(*facet_rows(geometry, coefficients(model, state, HEADINGS)))

    def direct() -> np.ndarray:
        return clarabel_.solve_family(limit_family(model, HEADINGS))[0][:, 0] * model.inertia.weight_N

    few = 60 if quick else 721
    step = slice(None, None, 721 // few)
    roads: dict[str, tuple[Callable[[], np.ndarray], slice, int]] = {
        "facets, from the model": (lambda: sweep(model, HEADINGS, with_band=False).f_max_N, slice(None), 200),
        "facets and band": (lambda: sweep(model, HEADINGS).f_max_N, slice(None), 200),
        "facets, geometry cached": (cached_rows, slice(None), 200),
        "facets, set cached": (cached, slice(None), 500),
        "Clarabel, updated": (direct, slice(None), 9),
        "cvxpy, one block problem": (lambda: cvxpy_.block_box(b, limits, rays), slice(None), 9),
        "SciPy HiGHS": (lambda: scipy_highs(b, limits, rays[step]), step, 3),
        "cvxpy, parameter (DPP)": (lambda: parameter_cvxpy(b, limits, rays[step]), step, 3),
        "cvxpy, new problem each": (lambda: naive_cvxpy(b, limits, rays[step]), step, 1 if not quick else 2),
    }
    out = {}
    for name, (run, part, repeats) in roads.items():
        seconds = median_s(run, repeats)
        off = float(np.max(np.abs(run() / reference[part] - 1.0)))
        out[name] = {
            "us_per_heading": 1e6 * seconds / len(reference[part]),
            "us_per_sweep": 1e6 * seconds * len(reference) / len(reference[part]),
            "worst_relative_difference": off,
        }
    slowest = out["cvxpy, new problem each"]["us_per_heading"]
    for row in out.values():
        row["times_faster_than_naive"] = slowest / row["us_per_heading"]
    return out


def zonotopes(quick: bool) -> dict[str, dict[str, float]]:
    """Facets and vertices of random zonotopes, ours and pycapacity's [ms]."""
    out = {}
    for n in (6, 12, 20):
        generators = np.random.default_rng(n).normal(size=(3, n))

        def ours(g: np.ndarray = generators) -> object:
            return Zonotope(generators=g).vertices()

        out[f"zonotope, {n} generators"] = {"ms": 1e3 * median_s(ours, 50), "vertices": float(len(ours()))}
        if importlib.util.find_spec("pycapacity") is None:
            continue
        from pycapacity.algorithms import hyper_plane_shift_method, iterative_convex_hull_method

        top = np.ones(n)
        out[f"pycapacity hyper-plane shifting (facets only), {n}"] = {
            "ms": 1e3 * median_s(lambda g=generators, t=top: hyper_plane_shift_method(g, -t, t), 3)
        }
        if n < 20 or not quick:
            out[f"pycapacity iterative hull, {n}"] = {
                "ms": 1e3
                * median_s(
                    lambda g=generators, t=top: iterative_convex_hull_method(np.eye(3), g, -t, t, tol=1e-6), 1
                )
            }
    return out


def design() -> dict[str, dict[str, float]]:
    """121 wheel angles × 721 headings as one expression [ms]."""
    models = [nominal_model(robot(delta), "paper") for delta in np.linspace(0.0, 60.0, 121)]
    generators = np.stack([wrench_set(m).generators for m in models])
    rays = Pull().rays(models[0], HEADINGS)
    got = batch_ray_exit(generators, rays)
    want = np.stack([sweep(m, HEADINGS, with_band=False).f_max_N for m in models])
    return {
        "121 wheel angles × 721 headings": {
            "ms": 1e3 * median_s(lambda: batch_ray_exit(generators, rays), 20),
            "worst_relative_difference": float(np.max(np.abs(got / want - 1.0))),
        }
    }


def overstated() -> dict[str, dict[str, float]]:
    """By how much μ m g overstates F_emax of the paper's robot over all headings [%]."""
    found = sweep(nominal_model(robot(), "paper"), HEADINGS, with_band=False)
    percent = 100.0 * (isotropic(found.model).force_N / found.f_max_N - 1.0)
    return {
        "μ m g over F_emax": {"least_percent": float(percent.min()), "most_percent": float(percent.max())}
    }


def measure(quick: bool = False) -> dict[str, dict[str, dict[str, float]]]:
    """Everything."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the alternatives' own
        return {
            "sweep": sweeps(quick),
            "zonotope": zonotopes(quick),
            "design": design(),
            "isotropic": overstated(),
        }


def main() -> None:
    """Print the tables; write JSON where a file is named."""
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("file", nargs="?", type=Path)
    words.add_argument("--quick", action="store_true", help="fewer headings for the slow alternatives")
    asked = words.parse_args()
    found = measure(asked.quick)
    print(f"{'sweep of 721 headings':<28}{'µs/heading':>12}{'µs/sweep':>12}{'× naive':>11}{'difference':>12}")
    for name, row in found["sweep"].items():
        print(
            f"{name:<28}{row['us_per_heading']:12.3f}{row['us_per_sweep']:12.0f}"
            f"{row['times_faster_than_naive']:11.0f}{row['worst_relative_difference']:12.1e}{_promise(name)}"
        )
    for part in ("zonotope", "design"):
        for name, row in found[part].items():
            print(f"{name:<52}{row['ms']:12.3f} ms{_promise(name)}")
    for name, row in found["isotropic"].items():
        print(f"{name:<52}{row['least_percent']:6.1f} to {row['most_percent']:.1f} % too much")
    write_figures(asked.file, found)


def _promise(name: str) -> str:
    if name not in PROMISED:
        return ""
    value, unit = PROMISED[name]
    return f"   promised ≤ {value:g} {unit}"


if __name__ == "__main__":
    main()
