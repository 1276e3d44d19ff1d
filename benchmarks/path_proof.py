"""The proof of the planner: drawn robots × paths, planned, then driven open loop by the simulator.

    python benchmarks/path_proof.py [COUNT] [--seed 1] [--json FILE] [--part 1/2]     a line a robot
    python benchmarks/path_proof.py table FILE…                                       what kept rows come to

Every robot has draws of its own: robot 17 is the same however many are asked for.  Sped up to 105 %, a
motion slips where a wheel uses more than 0.97 of its grip, which no admissible plan may show; grossly
above 0.985 (creep of 42 mm/s): that takes time, which motions of less than about two seconds do not have.
"""

from __future__ import annotations

import sys
from functools import partial
from typing import Any

import numpy as np
from drawn_robots import floor_of, wheel_set
from kept import Keeper, collected

from slipmargin.errors import InputError, NoSolution
from slipmargin.model import Model, nominal_model
from slipmargin.paths.path import Path, through
from slipmargin.paths.plan import Request, plan
from slipmargin.paths.sample import at_use, trajectory
from slipmargin.paths.verify import GROSS, verify
from slipmargin.robot import Body, LoadRule, Robot

#: How long a sped-up motion has to ask for 105 % of a wheel's grip [s].
HOLD_S = 0.5
#: A share that no plan may show, 0.95 and the 0.02 granted to the simulator: the wheel is lost [1].
LOST = 0.97


def drawn_robot(rng: np.random.Generator, wheels: int) -> Model:
    """A buildable machine: wheels round a body, omni or mecanum, statics for the loads, one floor."""
    while True:
        size = rng.uniform(0.1, 0.4)
        at = 2.0 * np.pi * (np.arange(wheels) + rng.uniform(-0.2, 0.2, wheels)) / wheels
        mecanum = wheels % 2 == 0 and rng.random() < 0.5
        turn = np.where(np.arange(wheels) % 2 == 0, 45.0, -45.0) if mecanum else np.zeros(wheels)
        aim = np.full(wheels, 90.0) if mecanum else np.rad2deg(at) + 90.0 + rng.uniform(-25.0, 25.0, wheels)
        place = size * np.column_stack([np.cos(at), np.sin(at)])
        mass, drive = rng.uniform(2.0, 40.0), rng.uniform(0.2, 0.8)
        floor = floor_of(drive, drive * rng.uniform(0.03, 0.35))
        try:
            robot = Robot(
                name=f"drawn-{wheels}",
                wheels=wheel_set(place, aim, turn, 0.04),
                surfaces=(floor,),
                load_rule=LoadRule.QUASI_STATIC,
                body=Body(
                    mass_kg=mass,
                    inertia_kg_m2=mass * (rng.uniform(0.5, 0.9) * size) ** 2,
                    com_m=size * rng.uniform(-0.15, 0.15, 2),
                    com_height_m=size * rng.uniform(0.0, 0.4),
                ),
            )
            model = nominal_model(robot, "floor")
        except InputError:
            continue
        along = model.wrench_maps()[0] / np.array([[1.0], [1.0], [size]])
        if np.linalg.svd(along, compute_uv=False)[-1] > 0.4:
            return model


def drawn_path(rng: np.random.Generator, arm: float) -> Path:
    """A spline through two to five drawn poses."""
    while True:
        poses = np.cumsum(rng.normal(size=(int(rng.integers(2, 6)), 3)) * np.array([0.6, 0.6, 0.8]), axis=0)
        try:
            return through(poses, arm=arm)
        except InputError:
            continue


def proof(seed: int, k: int) -> dict[str, Any]:
    """Robot ``k`` through planner and simulator: use, simulated share, and the sped-up motion."""
    rng, refused = np.random.default_rng([seed, k]), 0
    wheels = (3, 4, 6)[k % 3]
    while True:
        model = drawn_robot(rng, wheels)
        way, share = drawn_path(rng, 0.2), float(rng.uniform(0.5, 0.95))
        try:
            found = plan(model, way, Request(share=share, points=200))
            break
        except NoSolution:
            refused += 1  # even constant speed needs more than the share
    slow = trajectory(found, step_s=0.002)
    calm = verify(model, slow)
    fast = at_use(model, slow, 1.05, hold_s=HOLD_S)
    wild = verify(model, fast)
    first = int(np.argmax(np.max(wild.share, axis=1) > (GROSS if wild.slips else LOST)))
    slipping = int(np.argmax(wild.share[first]))
    near = (fast.t_s <= wild.t_s[first]) & (fast.t_s > wild.t_s[first] - 3.0 * HOLD_S)
    return {
        "wheels": wheels,
        "share": share,
        "refused": refused,
        "duration_s": found.duration_s,
        "over": found.max_use / share - 1.0,
        "excess": calm.peak - share,
        "passes": found.passes,
        "sped_up_s": fast.duration_s,
        "sped_up_share": wild.peak,
        "lost": wild.peak > LOST,
        "gross": wild.slips,
        "at_named_wheel": bool(np.max(fast.use[near, slipping]) > 1.0),
    }


def shown(seed: int, k: int) -> dict[str, Any]:
    """A robot's row, printed."""
    row = proof(seed, k)
    word = "slips grossly" if row["gross"] else "slips" if row["lost"] else "holds"
    print(
        f"{k:4d}  {row['wheels']} wheels  λ {row['share']:.3f}  use over λ {row['over']:+.1e}  simulated "
        f"{row['excess']:+.4f}  at 105 %: {word} ({row['sped_up_share']:.4f})",
        flush=True,
    )
    return row


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What the rows come to."""
    lost = [r for r in rows if r["lost"]]
    return {
        "robots": len(rows),
        "refused": sum(r["refused"] for r in rows),
        "worst_over": max(r["over"] for r in rows),
        "worst_excess": max(r["excess"] for r in rows),
        "excess_above_0.02": sum(r["excess"] > 0.02 for r in rows),
        "sped_up_slips": len(lost),
        "sped_up_slips_grossly": sum(r["gross"] for r in rows),
        "at_named_wheel": sum(r["at_named_wheel"] for r in lost),
    }


def main(words: list[str]) -> None:
    """Prove, or sum up what was proved."""
    keeper, words = Keeper.of(words, __doc__)
    if words[:1] == ["table"]:
        rows = collected(words[1:])
    else:
        seed = int(words[words.index("--seed") + 1]) if "--seed" in words else 1
        count = int(words[0]) if words[:1] and words[0].isdigit() else 200
        rows = keeper.run([(f"robot {k}", partial(shown, seed, k)) for k in range(count)])
    for name, value in summary(rows).items():
        print(f"{name:20s} {value:.3g}")


if __name__ == "__main__":
    main(sys.argv[1:])
