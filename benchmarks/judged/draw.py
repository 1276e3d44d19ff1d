"""Draw measured data sets with and without an undeclared effect, with the truth kept apart from them.

    python benchmarks/judged/draw.py --seed S --out DIR                         100 effects and 100 without
    python benchmarks/judged/draw.py --seed S --out DIR --kind dev --effects 24 --nulls 16
    python benchmarks/judged/draw.py --seed S --out DIR --kind coverage --count 200

DIR/sets/NAME is a data set as ``slipmargin diagnose`` reads it; DIR/truth.json says what was planted.
The same seed draws the same bytes.  README.md says what is a test and what is for development.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from judged.camera import BESIDE_WHITE, NULL_KINDS, Instrument, draw_instrument, noisy, seen_rows, stamps
from judged.families import CATALOGUE_FAMILIES, INVENTIONS, Apply, Draw, Family, Planted
from judged.motions import RunPlan, draw_run
from judged.robots import Robot, Wishes, draw_robot
from judged.simulator import Array, march

KINDS = ("test", "dev", "coverage")
SIGMAS_M = (0.0001, 0.0005, 0.002)
HEADING_PER_M = 4.0  #: noise of the heading [rad] per noise of the position [m]
RATES_HZ = (30, 60, 200)
#: How far the model without the effect is off, root mean square over noise: drawn evenly in its logarithm.
CHI_LOW, CHI_HIGH = 2.0, 40.0
_TRIES = 60


class _AgainError(Exception):
    """This draw cannot be used: another one is made."""


def tracks(planted: Planted, runs: Sequence[RunPlan], tool: Instrument | None = None) -> list[Array]:
    """Noise-free poses at the rows of each run, as the camera reports them."""
    out = []
    for run in runs:
        tables = planted.tables(run) if planted.tables else run.tables
        fine, least = march(
            planted.machine, planted.physics, run.start, tables.theta, tables.omega, run.h, run.every
        )
        if not np.isfinite(fine).all() or least <= 0.02 * float(np.min(planted.machine.rest)):
            raise _AgainError("a wheel lifts off")
        if np.abs(fine[:, :2] - run.start[:2]).max() > 4.0:
            raise _AgainError("it drives out of the picture")
        rows = seen_rows(tool, run.rows_s) if tool else run.rows_s
        out.append(planted.camera(run.fine_s, fine, rows))
    return out


def started_at(track: Array, pose: Array) -> Array:
    """The same motion from another start: the models that are declared know no place and no direction."""
    turn = pose[2] - track[0, 2]
    c, s = np.cos(turn), np.sin(turn)
    off = track[:, :2] - track[0, :2]
    x, y = pose[0] + c * off[:, 0] - s * off[:, 1], pose[1] + s * off[:, 0] + c * off[:, 1]
    return np.column_stack([x, y, track[:, 2] + turn])


def gaps(plain: Sequence[Array], real: Sequence[Array]) -> Array:
    """Pose (., 3) without the effect minus pose with it, row by row, both begun where the camera says."""
    return np.concatenate([started_at(a, b[0]) - b for a, b in zip(plain, real, strict=True)])


def misfit(plain: Sequence[Array], real: Sequence[Array], sigma: Array) -> float:
    """Root mean square of the difference over the noise."""
    return float(np.sqrt(np.mean((gaps(plain, real) / sigma) ** 2)))


def size_for(apply: Apply, runs: Sequence[RunPlan], sigma: Array, wanted: float) -> float:
    """The size at which the model without the effect is off by ``wanted`` noises, on at most four runs."""
    few = runs[:4]
    plain = tracks(apply(0.0), few)
    low, high, size = 1e-4, 1.0, 0.15
    for _ in range(7):
        try:
            off = misfit(plain, tracks(apply(size), few), sigma)
        except _AgainError:
            high, size = size, np.sqrt(low * size)
            continue
        if 0.85 < off / wanted < 1.18:
            break
        low, high = (size, high) if off < wanted else (low, size)
        guess = size * np.clip(wanted / max(off, 1e-9), 0.05, 20.0)
        if low >= 1.0:
            break
        size = float(guess) if low < guess < high else float(np.sqrt(low * high))
        if guess >= 1.0 and high >= 1.0:
            size = 1.0
    return float(size)


def _scene(
    rng: np.random.Generator,
    wishes: Wishes,
    *,
    commanded: bool,
    spread: bool,
    theta: bool,
    hardest: float,
    most: int = 20,
) -> tuple[Robot, list[RunPlan], int, str]:
    robot = draw_robot(rng, wishes)
    rate = int(rng.choice(RATES_HZ))
    wheels = "commanded"
    if not commanded:
        wheels = str(rng.choice(["both", "both", "both", "speeds", "angles"]))
        # straight lines between speeds that are logged slowly would be an error of the log itself
        hidden = theta or robot.machine.rigid_fraction[0] > 0.0
        if rate < 60 or (wheels == "speeds" and (hidden or rate < 200)):
            wheels = "both"
    spread = spread or bool(rng.random() < 0.5)
    count = min(most, int(rng.integers(6, 21)))
    runs = [
        draw_run(rng, robot.machine, rate, spread=spread, commanded=commanded, hardest=hardest)
        for _ in range(count)
    ]
    return robot, runs, rate, wheels


def _sigma(rng: np.random.Generator) -> Array:
    s = float(rng.choice(SIGMAS_M))
    return np.array([s, s, HEADING_PER_M * s])


def _finish(
    rng: np.random.Generator,
    robot: Robot,
    runs: list[RunPlan],
    wheels: str,
    tool: Instrument,
    poses: list[Array],
) -> tuple[dict[str, str], dict[str, Any]]:
    """The files of a set and what is true of every kind of set."""
    stated = bool(rng.random() < 0.6)
    signal = "commanded" if wheels == "commanded" else "measured"
    lines = ["schema = 1", 'robot = "robot.toml"', 'surface = "floor"', f'wheel_signal = "{signal}"']
    if stated:
        lines += ["", "[sigma]"]
        lines += [f"{k} = {v:.6g}" for k, v in zip(("x_m", "y_m", "phi_rad"), tool.sigma, strict=True)]
    files = {"robot.toml": robot.text, "dataset.toml": "\n".join([*lines, ""])}
    for j, (run, pose) in enumerate(zip(runs, poses, strict=True)):
        columns = {"t_s": stamps(rng, tool, run.rows_s)}
        seen = noisy(rng, tool, pose)
        columns |= {name: seen[:, c] for c, name in enumerate(("x_m", "y_m", "phi_rad"))}
        n = run.command.shape[1]
        if wheels == "commanded":
            columns |= {f"omega{i + 1}_cmd_rad_s": run.command[:, i] for i in range(n)}
        if wheels in ("both", "speeds"):
            columns |= {f"omega{i + 1}_rad_s": run.log_omega[:, i] for i in range(n)}
        if wheels in ("both", "angles"):
            columns |= {f"theta{i + 1}_rad": run.log_theta[:, i] for i in range(n)}
        body = np.column_stack(list(columns.values()))
        rows = [",".join("" if np.isnan(v) else f"{v:.6f}" for v in row) for row in body]
        files[f"trials/trial{j:02d}.csv"] = "\n".join([",".join(columns), *rows, ""])
    truth = {
        "robot": robot.kind,
        "runs": len(runs),
        "rate_Hz": tool.rate,
        "sigma_m": float(tool.sigma[0]),
        "sigma_stated": stated,
        "wheels_logged": wheels,
        "noise": tool.kind,
        "noise_numbers": tool.numbers,
    }
    return files, truth


def effect_set(
    seed: Sequence[int], family: Family, *, white: bool = False, most: int = 20
) -> tuple[dict[str, str], dict[str, Any]]:
    """The files and the truth of a set with one effect of a family; ``most``: of so many runs at most."""
    for again in range(_TRIES):
        rng = np.random.default_rng([*seed, again])
        try:
            return _one_effect(rng, family, white=white, most=most)
        except _AgainError:
            continue
    raise RuntimeError(f"{family.name}: {_TRIES} draws in a row were of no use")


def _one_effect(
    rng: np.random.Generator, family: Family, *, white: bool, most: int
) -> tuple[dict[str, str], dict[str, Any]]:
    robot, runs, rate, wheels = _scene(
        rng,
        family.wishes,
        commanded=family.commanded,
        spread=family.spread,
        theta=family.theta,
        hardest=family.hardest,
        most=most,
    )
    sigma = _sigma(rng)
    kind = "white" if white or rng.random() < 0.75 else str(rng.choice(BESIDE_WHITE))
    tool = draw_instrument(rng, kind, sigma, rate)
    wanted = float(np.exp(rng.uniform(np.log(CHI_LOW), np.log(CHI_HIGH))))
    apply = family.draws(Draw(rng=rng, machine=robot.machine, runs=runs))
    planted = apply(size_for(apply, runs, sigma, wanted))
    plain, real = tracks(apply(0.0), runs), tracks(planted, runs)
    off = misfit(plain, real, sigma)
    if not CHI_LOW * 0.8 <= off <= CHI_HIGH * 1.5:
        raise _AgainError("too small or too large")
    files, truth = _finish(rng, robot, runs, wheels, tool, real)
    gap = gaps(plain, real)
    truth = {
        "planted": True,
        "family": family.name,
        "catalogue": family.catalogue,
        "variable": family.variable,
        "also": list(family.also),
        "wheels": list(planted.wheels),
        "parameters": planted.parameters,
        "chi": round(float(np.hypot(1.0, off)), 3),
        "error_mm": round(1e3 * float(np.sqrt(np.mean(np.sum(gap[:, :2] ** 2, axis=1)))), 4),
        "error_rad": round(float(np.sqrt(np.mean(gap[:, 2] ** 2))), 6),
    } | truth
    return files, truth


def null_set(seed: Sequence[int], kind: str, *, most: int = 20) -> tuple[dict[str, str], dict[str, Any]]:
    """The files and the truth of a set whose robot file declares everything."""
    for again in range(_TRIES):
        rng = np.random.default_rng([*seed, again])
        commanded = bool(rng.random() < 0.2) and kind != "clock_rate_all"
        wishes = Wishes(no_motor=commanded, no_rigid=commanded)
        try:
            robot, runs, rate, wheels = _scene(
                rng,
                wishes,
                commanded=commanded,
                spread=False,
                theta=kind == "clock_rate_all",
                hardest=1.0,
                most=most,
            )
            if kind.startswith("camera_") and rate == 30:
                continue
            tool = draw_instrument(rng, kind, _sigma(rng), rate)
            files, truth = _finish(
                rng, robot, runs, wheels, tool, tracks(Planted(machine=robot.machine), runs, tool)
            )
        except _AgainError:
            continue
        at_fault = NULL_KINDS[kind][1]
        return files, {"planted": False, "family": kind, "instrument_at_fault": at_fault} | truth
    raise RuntimeError(f"{kind}: {_TRIES} draws in a row were of no use")


def families(kind: str) -> tuple[Family, ...]:
    """The families that a kind of collection draws from."""
    if kind == "coverage":
        return tuple(f for f in CATALOGUE_FAMILIES if f.covered)
    both = CATALOGUE_FAMILIES + INVENTIONS
    return tuple(f for f in both if not (kind == "dev" and f.held_back))


def null_kinds(kind: str) -> tuple[str, ...]:
    """The kinds of sets without an effect that a kind of collection draws from."""
    return tuple(name for name, (held, _) in NULL_KINDS.items() if not (kind == "dev" and held))


def jobs_of(
    kind: str, seed: int, effects: int, nulls: int
) -> list[tuple[str, tuple[int, int, int], str, bool]]:
    """(name, seed, family or kind of null, has an effect) of each set; names do not tell which is which."""
    code = KINDS.index(kind)
    rng = np.random.default_rng([seed, code])
    chosen: list[tuple[str, bool]] = []
    if kind == "coverage":
        pools = [([f.name for f in families(kind)], effects)]
    else:  # as many of the catalogue's as of the others
        half = (effects + 1) // 2
        known = [f.name for f in families(kind) if f.catalogue]
        new = [f.name for f in families(kind) if not f.catalogue]
        pools = [(known, half), (new, effects - half)]
    for pool, count in pools:
        order: list[str] = []
        while len(order) < count:
            order += [pool[i] for i in rng.permutation(len(pool))]
        chosen += [(name, True) for name in order[:count]]
    kinds = null_kinds(kind)
    chosen += [(kinds[i % len(kinds)], False) for i in range(nulls)]
    places = rng.permutation(len(chosen))
    return [(f"set{j:03d}", (seed, code, int(j)), *chosen[int(place)]) for j, place in enumerate(places)]


def make(
    job: tuple[str, tuple[int, int, int], str, bool], kind: str, out: Path
) -> tuple[str, dict[str, Any]]:
    """Write one set; returns its name and its truth."""
    name, seed, what, planted = job
    if planted:
        family = next(f for f in CATALOGUE_FAMILIES + INVENTIONS if f.name == what)
        if kind == "coverage":  # the truth must lie in the stated model: nothing but white noise beside it
            family = replace(family, spread=True)
        files, truth = effect_set(seed, family, white=kind == "coverage")
    else:
        files, truth = null_set(seed, what)
    folder = out / "sets" / name
    (folder / "trials").mkdir(parents=True, exist_ok=True)
    for path, text in files.items():
        (folder / path).write_text(text, encoding="utf-8")
    return name, truth


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--kind", choices=KINDS, default="test")
    parser.add_argument("--effects", type=int, help="sets with an effect, 100 by default")
    parser.add_argument("--nulls", type=int, help="sets without one, 100 by default")
    parser.add_argument("--count", type=int, help="sets of a coverage collection, 200 by default")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    given = parser.parse_args(words)
    if given.out.exists() and any(given.out.iterdir()):
        print(f"error: {given.out}: is not empty; name a new folder", file=sys.stderr)
        return 2
    idle = ("effects", "nulls") if given.kind == "coverage" else ("count",)
    for name in idle:
        if getattr(given, name) is not None:
            print(f"error: --{name}: has no effect on --kind {given.kind}; leave it out", file=sys.stderr)
            return 2
    effects, nulls = (200 if given.count is None else given.count, 0)
    if given.kind != "coverage":
        effects, nulls = (100 if n is None else n for n in (given.effects, given.nulls))
    jobs = jobs_of(given.kind, given.seed, effects, nulls)
    truth: dict[str, Any] = {}
    task = partial(make, kind=given.kind, out=given.out)
    with ProcessPoolExecutor(given.jobs) if given.jobs > 1 else nullcontext() as pool:
        for done, (name, true) in enumerate(pool.map(task, jobs) if pool else map(task, jobs), 1):
            truth[name] = true
            print(
                f"\r{100 * done // len(jobs):3d} %  {done} of {len(jobs)}",
                end="",
                file=sys.stderr,
                flush=True,
            )
    print(file=sys.stderr)
    text = json.dumps({"kind": given.kind, "seed": given.seed, "sets": truth}, indent=1) + "\n"
    (given.out / "truth.json").write_text(text, encoding="utf-8")
    print(f"{len(jobs)} sets in {given.out / 'sets'}, the truth in {given.out / 'truth.json'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
