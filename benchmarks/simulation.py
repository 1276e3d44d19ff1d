"""How fast the slip simulator is, beside what one would otherwise use; all ratios from this one run.

python benchmarks/simulation.py [--json FILE]
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from kept import write_figures

from slipmargin.paper.published import DURATION_S, FOUND, command, paper_model, spread, wheel_rates
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import hermite

_FIRST = """
import time; t = time.perf_counter()
import numpy as np
from slipmargin.paper.published import straight_line
straight_line("paper", improved=True, samples=10)
print(time.perf_counter() - t)
"""


def best(work: Callable[[], Any], repeats: int) -> float:
    """Shortest of several timings [s]."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def paper_case() -> dict[str, float]:
    """The paper's 3.5 s (improved model): our time and error, SciPy's LSODA on a NumPy and a compiled RHS."""
    model = paper_model("paper", improved=True)
    packed = pack(model)
    times = np.linspace(0.0, DURATION_S, 36)
    batch = Batch([command(FOUND.angles_rad)], [times])
    exact = batch.run(packed, np.zeros(3), rtol=1e-12).pose[0]
    out: dict[str, float] = {}
    for rtol in (1e-5, 1e-6):
        outcome = batch.run(packed, np.zeros(3), rtol=rtol)
        out[f"ours_rtol_{rtol:g}_s"] = best(lambda rtol=rtol: batch.run(packed, np.zeros(3), rtol=rtol), 30)
        out[f"ours_rtol_{rtol:g}_error"] = float(
            np.max(np.abs(outcome.pose[0] - exact).max(axis=0) / np.abs(exact).max(axis=0))
        )
    others = {  # left to itself LSODA steps over whole sectors: see its error
        "lsoda_numpy": lsoda_numpy(times, 0.0),
        "lsoda_numpy_10ms": lsoda_numpy(times, 0.01),
        "lsoda_compiled": lsoda_compiled(times, 0.0),
        "lsoda_compiled_10ms": lsoda_compiled(times, 0.01),
    }
    for name, (seconds, pose) in others.items():
        out[f"{name}_s"] = seconds
        out[f"{name}_error"] = float(np.max(np.abs(pose - exact).max(axis=0) / np.abs(exact).max(axis=0)))
    return out


def lsoda_numpy(times: np.ndarray, longest_s: float) -> tuple[float, np.ndarray]:
    """SciPy's odeint, vectorised NumPy right-hand side, no care for switches."""
    from scipy.integrate import odeint

    rhs = _paper_rhs(np)

    def run() -> np.ndarray:
        return odeint(rhs, np.zeros(6), times, rtol=1e-6, atol=1e-8, mxstep=50000, hmax=longest_s)[:, :3]

    pose = run()
    return best(run, 3), pose


def lsoda_compiled(times: np.ndarray, longest_s: float) -> tuple[float, np.ndarray]:
    """The same with the right-hand side compiled by numba."""
    import numba
    from scipy.integrate import odeint

    rhs = numba.njit(_paper_rhs_loops())

    def run() -> np.ndarray:
        return odeint(rhs, np.zeros(6), times, rtol=1e-6, atol=1e-8, mxstep=50000, hmax=longest_s)[:, :3]

    pose = run()
    return best(run, 5), pose


def _constants() -> tuple[np.ndarray, ...]:
    model = paper_model("paper", improved=True)
    c, g = model.geometry, model.grip
    return c.position_m, c.grip, c.free, wheel_rates(), FOUND.angles_rad, g.roller, g.rigid


def _paper_rhs(xp: Any) -> Callable[..., np.ndarray]:
    place, drive, free, rates, angles, roller, rigid = _constants()
    pitch, mass = 2.0 * np.pi / 8, 3.0
    inertia, load = mass * 0.095**2, mass * 9.81 / 3.0

    def rhs(y: np.ndarray, t: float) -> np.ndarray:
        phi, v, w = y[2], y[3:5], y[5]
        u = v + w * np.column_stack([-place[:, 1], place[:, 0]]) + 0.0254 * rates[:, None] * drive
        on = np.mod(angles + rates * t, pitch) >= 0.9 * pitch
        mu = np.where(on[:, None], rigid, roller)
        fw = -load * mu[:, 0] * (2 / np.pi) * np.arctan(1000.0 * np.sum(u * drive, axis=1))
        ft = -load * mu[:, 1] * (2 / np.pi) * np.arctan(1000.0 * np.sum(u * free, axis=1))
        f = fw[:, None] * drive + ft[:, None] * free
        total = f.sum(axis=0)
        moment = np.sum(place[:, 0] * f[:, 1] - place[:, 1] * f[:, 0])
        c, s = np.cos(phi), np.sin(phi)
        return xp.array(
            [
                c * v[0] - s * v[1],
                s * v[0] + c * v[1],
                w,
                total[0] / mass + w * v[1],
                total[1] / mass - w * v[0],
                moment / inertia,
            ]
        )

    return rhs


def _paper_rhs_loops() -> Callable[..., np.ndarray]:
    place, drive, free, rates, angles, roller, rigid = _constants()
    pitch, mass = 2.0 * np.pi / 8, 3.0
    inertia, load = mass * 0.095**2, mass * 9.81 / 3.0

    def rhs(y, t):  # type: ignore[no-untyped-def]
        fx, fy, mz = 0.0, 0.0, 0.0
        for i in range(3):
            ux = y[3] - y[5] * place[i, 1] + 0.0254 * rates[i] * drive[i, 0]
            uy = y[4] + y[5] * place[i, 0] + 0.0254 * rates[i] * drive[i, 1]
            mu = rigid[i] if (angles[i] + rates[i] * t) % pitch >= 0.9 * pitch else roller[i]
            a = -load * mu[0] * (2 / np.pi) * np.arctan(1000.0 * (ux * drive[i, 0] + uy * drive[i, 1]))
            b = -load * mu[1] * (2 / np.pi) * np.arctan(1000.0 * (ux * free[i, 0] + uy * free[i, 1]))
            x, z = a * drive[i, 0] + b * free[i, 0], a * drive[i, 1] + b * free[i, 1]
            fx += x
            fy += z
            mz += place[i, 0] * z - place[i, 1] * x
        c, s = np.cos(y[2]), np.sin(y[2])
        return np.array(
            [
                c * y[3] - s * y[4],
                s * y[3] + c * y[4],
                y[5],
                fx / mass + y[5] * y[4],
                fy / mass - y[5] * y[3],
                mz / inertia,
            ]
        )

    return rhs


def mujoco_case() -> dict[str, float]:
    """3.5 s of a sliding body on three feet (no rollers) in MuJoCo at 1 ms, if it is installed."""
    try:
        import mujoco
    except ModuleNotFoundError:
        return {}
    feet = "".join(
        f'<geom type="sphere" size="0.005" pos="{x} {y} -0.045"/>'
        for x, y in paper_model("paper", improved=False).geometry.position_m
    )
    world = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.001" cone="elliptic"/><worldbody><geom type="plane" size="9 9 1"/>'
        f'<body pos="0 0 0.05"><freejoint/>{feet}</body></worldbody></mujoco>'
    )
    data = mujoco.MjData(world)

    def run() -> None:
        mujoco.mj_resetData(world, data)
        data.qvel[0] = 0.1
        for _ in range(3500):
            mujoco.mj_step(world, data)

    return {"mujoco_three_feet_s": best(run, 3)}


def log_case() -> dict[str, float]:
    """Ten trials of 3.5 s logged at 200 Hz (Hermite knots every 5 ms), as a fit simulates them."""
    t = np.arange(0.0, 3.5001, 0.005)
    batch = Batch([hermite(t, *_sway(t, k)) for k in range(10)], [t] * 10)
    packed = pack(paper_model("paper", improved=False))
    batch.run(packed, np.zeros(3))
    return {
        f"ten_logs_rtol_{r:g}_s": best(lambda r=r: batch.run(packed, np.zeros(3), rtol=r), 10)
        for r in (1e-4, 1e-5, 1e-6)
    }


def _sway(t: np.ndarray, k: int) -> tuple[np.ndarray, np.ndarray]:
    rate = 1.0 + 0.2 * k
    scale = wheel_rates() * (1.0 + 0.1 * k)
    return (scale * (1.0 - np.cos(rate * t))[:, None] / rate, scale * np.sin(rate * t)[:, None])


def first_call() -> float:
    """Import, compile and run with an empty cache [s], in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-c", _FIRST],
            capture_output=True,
            text=True,
            check=True,
            env={**__import__("os").environ, "NUMBA_CACHE_DIR": folder},
        )
    return float(done.stdout)


def cached_call() -> float:
    """The same with the cache filled [s]."""
    done = subprocess.run([sys.executable, "-c", _FIRST], capture_output=True, text=True, check=True)
    return float(done.stdout)


def measure() -> dict[str, float]:
    """Everything."""
    out = paper_case() | mujoco_case() | log_case()
    out["thousand_random_rotor_angles_s"] = best(lambda: spread("paper", runs=1000), 2)
    out["first_call_s"], out["cached_call_s"] = first_call(), cached_call()
    ours = out["ours_rtol_1e-06_s"]
    for name in (
        "lsoda_numpy_s",
        "lsoda_numpy_10ms_s",
        "lsoda_compiled_s",
        "lsoda_compiled_10ms_s",
        "mujoco_three_feet_s",
    ):
        if name in out:
            out[f"ratio_{name[:-2]}"] = out[name] / ours
    return out


def main() -> None:
    """Print a table; write JSON where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    target = parser.parse_args().json
    found = measure()
    for name, value in found.items():
        print(f"{name:36s} {value:12.6g}")
    write_figures(target, found)


if __name__ == "__main__":
    main()
