"""Do three proposed runs separate what ten standard runs cannot?

    python benchmarks/next_run.py benchmarks/results/next_run.json [--only NAME] [--seed N]

A robot drives ten standard runs with an effect that its file does not mention.  `diagnose` finds an
explanation and names others that fit as well.  `next-run` proposes three runs of at most the same length;
the simulator drives them with the true effect, from a start that is off by a centimetre or so, with the same
noise; `diagnose` sees ten and three.  Beside it: ten standard runs and three more of them.  Development sets:
they were looked at while `next-run` was built.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from planting import SIGMA, smooth_kiwi

import slipmargin as sm
from slipmargin.data.data_set import DataSet, WheelSignal
from slipmargin.data.record import Record
from slipmargin.diagnosis.sense import measure
from slipmargin.effects import AnyEffect
from slipmargin.effects.floor_tilt import FloorTilt
from slipmargin.effects.recipe import with_effects
from slipmargin.effects.wheel_radius import WheelRadius
from slipmargin.effects.wheel_toe import WheelToe
from slipmargin.io.writes import write_text
from slipmargin.model import nominal_model
from slipmargin.sim.batch import Batch
from slipmargin.sim.pack import pack
from slipmargin.sim.signal import hermite

OUT = Path(__file__).resolve().parent / "results" / "next_run.json"
#: Length [s] and rate [Hz] of a run, standard runs of a set, runs that are added, the floor [m].
LENGTH_S, RATE_HZ, STANDARD, ADDED, SPACE_M = 4.0, 100.0, 10, 3, (3.0, 2.0)
#: How well a robot is put at the start of a run: 1 s.d. [m, m, rad].
PLACED = np.array([0.01, 0.01, 0.02])


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A true effect, and standard runs that leave others possible: run number → top twist and ramp [s]."""

    name: str
    words: str
    truth: tuple[AnyEffect, ...]
    standard: Callable[[int], tuple[tuple[float, float, float], float]]


def forwards(k: int) -> tuple[tuple[float, float, float], float]:
    """Straight ahead at ten speeds."""
    return (0.0, 0.10 + 0.02 * (k % 10), 0.0), 0.4


def small_area(k: int) -> tuple[tuple[float, float, float], float]:
    """Slowly, a few centimetres in ten directions."""
    way = 2.0 * np.pi * k / 10.0
    return (0.05 * np.cos(way), 0.05 * np.sin(way), 0.0), 0.3


CASES = (
    Case(
        name="radius",
        words="straight ahead at ten speeds",
        truth=(WheelRadius(radius_factor=1.02, wheels=("1",)),),
        standard=forwards,
    ),
    Case(
        name="toe",
        words="straight ahead at ten speeds",
        truth=(WheelToe(toe_rad=0.02, wheels=("1",)),),
        standard=forwards,
    ),
    Case(
        name="tilt",
        words="slowly, 15 cm in ten directions",
        truth=(FloorTilt(tilt_x_rad=0.01, tilt_y_rad=0.0),),
        standard=small_area,
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven:
    """A run to drive: times, wheel speeds, and where the robot is put."""

    name: str
    t_s: np.ndarray
    omega: np.ndarray
    start: np.ndarray


def standard_runs(case: Case, numbers: range) -> list[Driven]:
    """Standard runs by number: rest, ramp, steady, ramp, rest."""
    t = np.arange(0.0, LENGTH_S + 0.5 / RATE_HZ, 1.0 / RATE_HZ)
    model = smooth_kiwi().build("paper")
    made = []
    for k in numbers:
        top, ramp = case.standard(k)
        share = np.clip((t - 0.2) / ramp, 0.0, 1.0) * np.clip((t[-1] - 0.3 - t) / ramp, 0.0, 1.0)
        omega = model.geometry.wheel_speeds(np.outer(share, top))
        made.append(Driven(name=f"run{k:02d}", t_s=t, omega=omega, start=np.zeros(3)))
    return made


def logged(case: Case, runs: list[Driven], seed: int) -> tuple[Record, ...]:
    """What camera and encoders see of the runs with the true effect."""
    rng = np.random.default_rng(seed)
    recipe = smooth_kiwi()
    model = with_effects(nominal_model(recipe.robot, "paper"), (*recipe.effects, *case.truth))
    signals, thetas = [], []
    for run in runs:
        turned = np.cumsum(0.5 * (run.omega[1:] + run.omega[:-1]) * np.diff(run.t_s)[:, None], axis=0)
        theta = rng.uniform(0.0, 0.8, run.omega.shape[1]) + np.vstack([np.zeros(run.omega.shape[1]), turned])
        thetas.append(theta)
        signals.append(hermite(run.t_s, theta, run.omega))
    start = np.array([run.start + PLACED * rng.standard_normal(3) for run in runs])
    pose = Batch(signals, [r.t_s for r in runs]).at_clock(model.measurement.clock)
    poses = pose.run(pack(model), start, rtol=1e-8).pose
    made = []
    for run, theta, one in zip(runs, thetas, poses, strict=True):
        seen = measure(model.measurement, [run.t_s], one[None, : len(run.t_s)])[0]
        seen = seen + SIGMA * rng.standard_normal(seen.shape)
        made.append(Record(name=run.name, t_s=run.t_s, pose=seen, omega=run.omega, theta=theta))
    return tuple(made)


def data_set(records: tuple[Record, ...]) -> DataSet:
    """A data set of the robot as its file describes it."""
    return DataSet(
        name="standard",
        recipe=smooth_kiwi(),
        surface="paper",
        trials=records,
        sigma=SIGMA,
        wheel_signal=WheelSignal.MEASURED,
    )


def told(records: tuple[Record, ...]) -> dict[str, Any]:
    """What ``diagnose`` answers: names found, and names that it cannot tell from them."""
    found = sm.diagnose(data_set(records)).diagnosis
    return {
        "verdict": found.verdict.value,
        "found": [f.label for f in found.findings],
        "confused_with": sorted({name for f in found.findings for name in f.confused_with}),
        "chi": found.after.chi,
    }


def row(case: Case, seed: int) -> dict[str, Any]:
    """One case: before, what is proposed, after, and with three more standard runs instead."""
    before = logged(case, standard_runs(case, range(STANDARD)), seed)
    proposed = sm.next_run(data_set(before), space_m=SPACE_M, runs=ADDED, longest_s=LENGTH_S).next_runs
    ahead = [
        Driven(
            name=f"run{10 + k}", t_s=r.trajectory.t_s, omega=r.trajectory.omega, start=r.trajectory.pose[0]
        )
        for k, r in enumerate(proposed.runs)
    ]
    weakest = proposed.weakest
    more = standard_runs(case, range(STANDARD, STANDARD + ADDED))
    return {
        "name": case.name,
        "standard": case.words,
        "truth": [effect.name for effect in case.truth],
        "seed": seed,
        "before": told(before),
        "explanations": list(proposed.explanations),
        "proposed": [r.words for r in proposed.runs],
        "seconds": [r.trajectory.duration_s for r in proposed.runs],
        "today": None if weakest is None else weakest.today,
        "expected": None if weakest is None else weakest.expected,
        "after": told((*before, *logged(case, ahead, seed + 1000))),
        "after_standard": told((*before, *logged(case, more, seed + 2000))),
    }


def alone(answer: dict[str, Any], truth: list[str]) -> bool:
    """Whether the right names stand, and nothing is confused with them."""
    names = [label.split("[")[0].split(" ")[0] for label in answer["found"]]
    return names == truth and not answer["confused_with"]


def main() -> None:
    """Measure every case, or some, and write what is new into the file."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    words.add_argument("out", type=Path, nargs="?", default=OUT)
    words.add_argument("--only", action="append")
    words.add_argument("--seed", type=int, default=1)
    asked = words.parse_args()
    rows = json.loads(asked.out.read_text(encoding="utf-8")) if asked.out.exists() else []
    for case in CASES:
        if asked.only and case.name not in asked.only:
            continue
        made = row(case, asked.seed)
        rows = [r for r in rows if r["name"] != case.name] + [made]
        rows.sort(key=lambda r: [c.name for c in CASES].index(r["name"]))
        write_text(asked.out, json.dumps(rows, indent=1) + "\n")
        print(case.name, made["before"], made["after"], made["after_standard"], flush=True)


if __name__ == "__main__":
    main()
