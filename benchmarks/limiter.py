"""The limiter against Python, against clipping, in a closed loop, and what a call costs.

    python benchmarks/limiter.py benchmarks/results/limiter.json [--robots 50] [--states 5000]

Each part needs what it names: a C compiler, QEMU with a Cortex-M4 compiler, MuJoCo; without it the part is
left out and said so.
"""

from __future__ import annotations

import argparse
import copy
import dataclasses
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cortex_m4
import driving
import numpy as np
from c_limiter import CompiledLimiter, compilers
from drawn_robots import drawn_robot
from kept import write_figures

import slipmargin as sm
from slipmargin.model import Model

BUILT_IN = (("ohio-kiwi", "paper"), ("ohio-kiwi-symmetric", "carpet"), ("robotino", "gray"))
BUILT_IN += (("omni4", "floor"), ("mecanum4", "floor"))
MARGIN = 0.2


class ModelLimiter(sm.Limiter):
    """A limiter of a model that no robot file describes."""

    def __init__(self, model: Model, margin: float) -> None:
        from slipmargin.onboard.table import limit_table, steady_warnings

        self._margin, self._hash, self._command = margin, "drawn", "none makes it again"
        self.table, self.warnings = limit_table(model, margin), steady_warnings(model, margin)


def machines(count: int) -> list[tuple[str, Model]]:
    """The built-in robots on rollers, then drawn ones that can drive within the margin."""
    out = [
        (name, sm.read_robot(name, rigid_sectors=False).build(surface)) for name, surface in BUILT_IN[:count]
    ]
    k = 0
    while len(out) < count:
        model = driving.on_rollers(drawn_robot(np.random.default_rng([7, k])))
        k += 1
        if not ModelLimiter(model, MARGIN).warnings:
            out.append((f"drawn {k - 1}", model))
    return out


def drawn_states(limiter: sm.Limiter, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Twists now and wanted, time steps, headings, accelerations."""
    size = 1.0 / np.array([1.0, 1.0, np.mean(np.abs(limiter.table.along[2]))])
    now = rng.normal(size=(count, 3)) * size * rng.choice([0.02, 0.3, 1.0], size=(count, 1))
    step = rng.normal(size=(count, 3)) * size * rng.choice([0.01, 0.3, 2.0], size=(count, 1))
    wanted = np.where(rng.uniform(size=(count, 1)) < 0.2, 0.0, now + step)
    pull = rng.normal(size=(count, 3)) * size * limiter.table.pull_m_s2
    return [now, wanted, rng.choice([0.001, 0.01, 0.05], size=count), rng.uniform(-4.0, 4.0, count), pull]


#: Two to minus 24: half of what the last digit of a number in single precision is worth, of its size.
HALF_DIGIT = 2.0**-24
#: Differences up to this one need no reason.
WORTH_SHAKING = 1e-6


def compared(limiter: sm.Limiter, c: CompiledLimiter, states: list[np.ndarray]) -> np.ndarray:
    """Differences (3, M) of twist, acceleration and share between C and Python, of the inputs' size."""
    exact = answers(limiter, states)
    now, wanted, dt, heading, pull = states
    theirs = (
        c.limit_twist(now, wanted, dt, heading)[0],
        c.limit_acceleration(now, pull, heading)[0],
        c.margin(now, pull, heading)[0],
    )
    return apart(limiter, states, exact, theirs)


def answers(limiter: sm.Limiter, states: list[np.ndarray]) -> tuple[np.ndarray, ...]:
    """Twists, accelerations and shares by Python."""
    now, wanted, dt, heading, pull = states
    return (
        limiter.limit_twist(now, wanted, dt, heading)[0],
        limiter.limit_acceleration(now, pull, heading)[0],
        limiter.margin(now, pull, heading)[0],
    )


def apart(
    limiter: sm.Limiter,
    states: list[np.ndarray],
    one: tuple[np.ndarray, ...],
    other: tuple[np.ndarray, ...],
) -> np.ndarray:
    """How far two answers are from one another, (3, M)."""
    size = np.array([1.0, 1.0, np.mean(np.abs(limiter.table.along[2]))])
    now, wanted, _, _, pull = (x * size if x.ndim == 2 else x for x in states)
    return np.stack(
        [
            np.max(np.abs(one[0] - other[0]) * size, axis=1)
            / np.maximum(np.max(np.abs(np.stack([now, wanted])), axis=(0, 2)), 1e-30),
            np.max(np.abs(one[1] - other[1]) * size, axis=1)
            / np.maximum(np.max(np.abs(pull), axis=1), 1e-30),
            np.abs(one[2] - other[2]) / np.maximum(one[2], 1e-3),
        ]
    )


def conditioned(limiter: sm.Limiter, states: list[np.ndarray]) -> np.ndarray:
    """How far the exact answers (3, M) move at most where inputs and tables are off by half their last digit.

    No program in single precision can be expected to be nearer: its tables and inputs are that far off.  The
    most, to first order: the movements by each number alone, added up.
    """
    exact, moved = answers(limiter, states), np.zeros((3, len(states[0])))
    for inputs in _each_off(states):
        moved += apart(limiter, states, exact, answers(limiter, inputs))
    shaken = copy.copy(limiter)
    fields = [field.name for field in dataclasses.fields(limiter.table)]
    names = [name for name in fields if isinstance(getattr(limiter.table, name), np.ndarray)]
    for name in names:
        values = getattr(limiter.table, name)
        for at in np.argwhere(values):
            other = values.copy()
            other[tuple(at)] *= 1.0 + HALF_DIGIT
            shaken.table = dataclasses.replace(limiter.table, **{name: other})
            moved += apart(limiter, states, exact, answers(shaken, states))
    return moved


def _each_off(states: list[np.ndarray]) -> Iterator[list[np.ndarray]]:
    """The states with one column after the other off by half its last digit."""
    for k, values in enumerate(states):
        for column in range(values[0].size):
            other = values.copy()
            other.reshape(len(values), -1)[:, column] *= 1.0 + HALF_DIGIT
            yield [*states[:k], other, *states[k + 1 :]]


def against_python(count: int) -> dict[str, Any]:
    """Differences from Python, of the inputs' size, over 20 robots; and microseconds a call.

    In single precision also what the states themselves allow: how far half a digit moves the exact answer.
    """
    found = compilers()
    if not found:
        return {"left out": "no C compiler (gcc or clang)"}
    largest, clear, ratio, over = {"double": 0.0, "float": 0.0}, 0.0, 0.0, [0, 0]
    cost: dict[str, dict[str, float]] = {}
    robots = machines(20)
    with tempfile.TemporaryDirectory() as folder:
        for name, model in robots:
            limiter = ModelLimiter(model, MARGIN)
            for kind in largest:
                c = CompiledLimiter(limiter, Path(folder, name), found[0], double=kind == "double")
                states = drawn_states(limiter, count, np.random.default_rng(1))
                states = [x.astype(c.dtype).astype(float) for x in states]
                off = compared(limiter, c, states)
                largest[kind] = max(largest[kind], float(off.max()))
                if kind == "float":
                    some = np.flatnonzero(off.max(axis=0) > WORTH_SHAKING)
                    moved = conditioned(limiter, [x[some] for x in states])
                    ratio = max(
                        ratio, float(np.max(off[:, some] / np.maximum(moved, HALF_DIGIT), initial=0.0))
                    )
                    fine = moved <= 1e-5
                    clear = max(clear, float(np.max(off[:, some][fine], initial=WORTH_SHAKING)))
                    over[0] += int(np.sum(off > 1e-5))
                    over[1] += int(np.sum((off[:, some] > 1e-5) & fine))
                if name in ("ohio-kiwi", "mecanum4"):
                    cost[f"{name}, {kind}"] = speed(c, *states)
    return {
        "states": count * len(robots),
        "compilers": found,
        "largest difference": largest,
        "single precision": {
            "answers": 3 * count * len(robots),
            "over 1e-5": over[0],
            "of them where half a digit of inputs and tables moves the exact answer by less": over[1],
            "largest there": clear,
            "largest, in such movements": ratio,
        },
        "microseconds a call": cost,
    }


def speed(c: CompiledLimiter, *states: np.ndarray) -> dict[str, float]:
    """Microseconds of processor time a call, the least of 25 rounds over states it need not brake from.

    The C loop alone is timed, over numbers that have its type already.
    """
    now, wanted, dt, heading, pull = states
    usual = c.limit_twist(now, wanted, dt, heading)[1] <= 1
    now, wanted, dt, heading, pull = (x[usual] for x in states)
    calls = {
        "sm_limit_twist": c.prepared("twists", [now, wanted, dt, heading], 3)[0],
        "sm_limit_acceleration": c.prepared("accelerations", [now, pull, heading], 3)[0],
        "sm_margin": c.prepared("margins", [now, pull, heading], 1)[0],
    }
    out = {}
    for name, call in calls.items():
        rounds = []
        for _ in range(25):
            start = time.process_time()
            call()
            rounds.append(time.process_time() - start)
        out[name] = 1e6 * min(rounds) / len(now)
    return out


def on_a_cortex_m4() -> dict[str, Any]:
    """Instructions a call."""
    if cortex_m4.missing():
        return {"left out": f"needs {', '.join(cortex_m4.missing())}"}
    out = {}
    for name, surface in BUILT_IN[:1] + BUILT_IN[-1:]:
        limiter = sm.Limiter(name, surface, margin=MARGIN)
        now, wanted, *_ = drawn_states(limiter, 60, np.random.default_rng(2))
        with tempfile.TemporaryDirectory() as folder:
            out[name] = cortex_m4.instructions(limiter, np.hstack([now, wanted]), Path(folder))
    return out


def manoeuvres(limiter: sm.Limiter) -> dict[str, list[np.ndarray]]:
    """Ten manoeuvres: wanted body twists, each held for 0.6 s."""
    v, w = 1.0, 1.0 / float(np.mean(np.abs(limiter.table.along[2])))
    stop = np.zeros(3)
    return {
        "start to the front": [np.array([0.0, v, 0.0])],
        "start to the side": [np.array([v, 0.0, 0.0])],
        "start diagonally": [np.array([0.8 * v, 0.5 * v, 0.0])],
        "start at 20 degrees": [np.array([0.34 * v, 0.94 * v, 0.0])],
        "start and stop": [np.array([0.6 * v, 0.8 * v, 0.0]), stop],
        "reverse": [np.array([0.5 * v, 0.5 * v, 0.0]), np.array([-0.5 * v, -0.5 * v, 0.0])],
        "a right angle": [np.array([0.0, 0.7 * v, 0.0]), np.array([0.7 * v, 0.0, 0.0])],
        "go and turn": [np.array([0.0, 0.6 * v, 0.3 * w])],
        "turn on the spot": [np.array([0.0, 0.0, 0.6 * w]), stop],
        "swerve": [np.array([0.3 * v, 0.6 * v, 0.0]), np.array([-0.3 * v, 0.6 * v, 0.0])],
    }


def strengths(limiter: sm.Limiter) -> tuple[np.ndarray, np.ndarray]:
    """Per-axis limits and ellipsoid semi-axes as they are set: what each axis alone can do."""
    each = []
    for axis in np.eye(3):
        ask = np.concatenate([axis, -axis]).reshape(2, 3) * 1e3
        crawl = np.sign(ask) * np.array([0.05, 0.05, 0.5])
        got, _ = limiter.limit_acceleration(crawl, ask)
        each.append(float(np.min(np.linalg.norm(got, axis=1))))
    return np.array(each), np.array(each)


def against_clipping() -> dict[str, Any]:
    """Ten manoeuvres: distance lost to what was wanted, largest share of the grip, turn of the direction."""
    out: dict[str, Any] = {}
    for name, surface in (BUILT_IN[0], BUILT_IN[2], BUILT_IN[4]):
        model = sm.read_robot(name, rigid_sectors=False).build(surface)
        limiter = sm.Limiter(sm.read_robot(name, rigid_sectors=False), surface, margin=MARGIN)
        axes, ellipse = strengths(limiter)
        limits = {
            "limiter": driving.slip_limit(limiter),
            "per axis": driving.axis_limit(axes),
            "ellipse": driving.ellipse_limit(ellipse),
        }
        rows: dict[str, list[tuple[float, float, float]]] = {kind: [] for kind in limits}
        for wishes in manoeuvres(limiter).values():
            wanted = np.repeat(wishes, 60, axis=0)
            for kind, limit in limits.items():
                twists = driving.commanded(limit, wanted)
                lost = float(np.sum(np.linalg.norm((wanted - twists[1:])[:, :2], axis=1)) * driving.TICK_S)
                rows[kind].append((lost, driving.peak(model, twists), turned(twists, wanted)))
        out[name] = {
            kind: {
                "distance lost [m]": float(np.sum([r[0] for r in found])),
                "largest share of the grip": float(np.max([r[1] for r in found])),
                "manoeuvres over the margin": int(np.sum([r[1] > 1.0 - MARGIN + 0.02 for r in found])),
                "largest turn of the direction [deg]": float(np.max([r[2] for r in found])),
            }
            for kind, found in rows.items()
        }
    return out


def turned(twists: np.ndarray, wanted: np.ndarray) -> float:
    """Largest angle [deg] between the change of velocity and the wanted change."""
    step, asked = np.diff(twists, axis=0)[:, :2], (wanted - twists[:-1])[:, :2]
    size = np.linalg.norm(step, axis=1) * np.linalg.norm(asked, axis=1)
    on = size > 1e-8
    if not np.any(on):
        return 0.0
    cosine = np.sum(step * asked, axis=1)[on] / size[on]
    return float(np.rad2deg(np.max(np.arccos(np.clip(cosine, -1.0, 1.0)))))


def closed_loop(count: int) -> dict[str, Any]:
    """Random aggressive commands: largest share with the limiter, and with per-axis clipping as strong."""
    rows = []
    for k, (name, model) in enumerate(machines(count)):
        rows.append({"robot": name, **driving.compared(model, ModelLimiter(model, MARGIN), k, 100)})
    mine, other = (np.array([row[kind] for row in rows]) for kind in ("limiter", "per axis"))
    return {
        "robots": len(rows),
        "allowed": 1.0 - MARGIN,
        "largest share, limiter": float(mine.max()),
        "largest share, per axis": float(other[np.isfinite(other)].max()),
        "robots over the margin by 0.02, limiter": int(np.sum(mine > 1.0 - MARGIN + 0.02)),
        "robots over the margin by 0.02, per axis": int(np.sum(other > 1.0 - MARGIN + 0.02)),
        "rows": rows,
    }


def main(words: list[str]) -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--robots", type=int, default=50)
    parser.add_argument("--states", type=int, default=5000)
    given = parser.parse_args(words)
    parts = {
        "closed loop": lambda: closed_loop(given.robots),
        "cortex-m4, instructions a call": on_a_cortex_m4,
        "ten manoeuvres": against_clipping,
        "against python": lambda: against_python(given.states),
    }
    found: dict[str, Any] = {}
    for name, part in parts.items():
        found[name] = part()
        write_figures(given.out, found)
        print(json.dumps({k: v for k, v in found[name].items() if k != "rows"}, indent=1), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
