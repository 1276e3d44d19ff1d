"""Processor time of bounds, sweep, polytope and plan of robots with 24 wheels.

    python benchmarks/many_wheels.py benchmarks/results/many_wheels.json

Each command runs in this process after a first one that compiles, at its default settings.  Times are those
of the processor, so that other work on the machine counts little.  Plain: omnidirectional and mecanum wheels,
no two at the same radius.  With effects: those that change the grip, the loads and the drag at once.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from kept import write_figures

import slipmargin as sm

#: What a command on an accepted robot may take [s].
ALLOWED_S = 10.0
WHEELS = 24
EFFECTS = """
[[effect]]
name = "stribeck"
dynamic_ratio = 0.8
stribeck_speed_m_s = 0.05
transverse_ratio = 1.0
[[effect]]
name = "rolling_resistance"
coefficient = 0.02
viscous_N_s_per_m = 1.0
yaw_share = 1.0
[[effect]]
name = "floor_nap"
nap_x = 0.1
nap_y = -0.05
[[effect]]
name = "load_transfer"
com_height_m = 0.05
com_share = 0.0
"""
WAYS = "x_m,y_m,phi_rad\n0,0,0\n1,0,0.5\n1,1,1\n0,1,2\n"


def robot(kind: str, *, effects: str = "") -> str:
    """The file of a robot with a ring of wheels that are no two alike."""
    wheels = []
    for i in range(WHEELS):
        at, reach = 2.0 * math.pi * i / WHEELS, 0.3 * (1.0 + 0.02 * i)
        drive = 90.0 if kind == "mecanum" else math.degrees(at) + 90.0
        roller = 45.0 * (-1) ** i if kind == "mecanum" else 0.0
        wheels.append(
            f'[[wheel]]\nname = "w{i}"\n'
            f"position_m = [{reach * math.cos(at):.6f}, {reach * math.sin(at):.6f}]\n"
            f"drive_direction_deg = {drive:.6f}\nradius_m = 0.05\nroller_angle_deg = {roller}\nrollers = 8\n"
            "rigid_fraction = 0.0\n"
        )
    return (
        'schema = 1\nname = "many"\n[body]\nmass_kg = 20.0\ninertia_kg_m2 = 1.2\ncom_m = [0.01, 0.02]\n'
        'com_height_m = 0.1\n[loads]\nmodel = "quasi-static"\n[friction]\nlaw = "atan"\nk_s_per_m = 300.0\n'
        'grip = "box"\n[motor]\nmax_speed_rad_s = 40.0\nstall_torque_N_m = 1.0\n'
        + "".join(wheels)
        + "[surface.floor.roller]\ndrive = 0.5\ntransverse = 0.05\n"
        "[surface.floor.rigid]\ndrive = 0.5\ntransverse = 0.5\n" + effects
    )


def commands(folder: Path) -> dict[str, Callable[[str], object]]:
    """Command → what runs it on a robot file, all at their defaults."""
    (folder / "w.csv").write_text(WAYS, encoding="utf-8")
    return {
        "sweep": lambda file: sm.sweep(file, "floor"),
        "polytope": lambda file: sm.polytope(file, "floor"),
        "bounds": lambda file: sm.bounds(file, "floor"),
        "plan": lambda file: sm.plan(file, "floor", folder / "w.csv"),
        "stop": lambda file: sm.stop(file, "floor"),
    }


def measured(only: str | None = None) -> list[dict[str, object]]:
    """Rows with robot, command and processor time [s]."""
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for command, run in commands(folder).items():
            if only not in (None, command):
                continue
            run("mecanum4")  # compiles
            for kind in ("omni", "mecanum"):
                for effects in ("", EFFECTS):
                    file = folder / f"{kind}{len(effects)}.toml"
                    file.write_text(robot(kind, effects=effects), encoding="utf-8")
                    start = time.process_time()
                    run(str(file))
                    used = time.process_time() - start
                    label = kind + (" with effects" if effects else "")
                    rows.append({"command": command, "robot": label, "cpu_s": round(used, 2)})
                    print(f"{command:<10}{label:<22}{used:7.2f} s", flush=True)
    return rows


def main(words: list[str]) -> int:
    """Run, print and keep; 1 where a command takes longer than is allowed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, nargs="?", help="where the rows are kept (JSON)")
    parser.add_argument("--command", help="this one only")
    given = parser.parse_args(words)
    rows = measured(given.command)
    write_figures(given.out, rows)
    return int(any(row["cpu_s"] > ALLOWED_S for row in rows))  # type: ignore[operator]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
