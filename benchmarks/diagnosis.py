"""How well the loop finds what is missing: given sets, inventions, null sets, the whole catalogue.

    python benchmarks/diagnosis.py sets FOLDER…        data sets with or without truth.json
    python benchmarks/diagnosis.py plants               thirty inventions that no catalogue entry holds
    python benchmarks/diagnosis.py nulls COUNT          nothing planted: false alarms
    python benchmarks/diagnosis.py catalogue COUNT      drawn effects of drawn size: confusion table
    python benchmarks/diagnosis.py table FILE…          what kept rows come to

Without a word: eight null sets.  Every line is printed as it is known; ``--json FILE`` keeps them, and
a run that was stopped goes on from there; ``--part 1/2`` does every other set, for two processes.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from inventions import plants
from kept import Keeper, collected
from planting import Plant, commanded, planted, smooth_kiwi

from slipmargin.data.data_set import DataSet
from slipmargin.diagnosis.loop import diagnose
from slipmargin.diagnosis.result import Diagnosis
from slipmargin.effects import Effect, WheelEffect
from slipmargin.effects.catalogue import CATALOGUE, effect_class
from slipmargin.io.data_set import read_data_set

#: Typical sizes of the catalogue's effects: (parameter, smallest, largest, either sign).
SIZES: dict[str, tuple[tuple[str, float, float, bool], ...]] = {
    "friction_coefficients": (("drive_factor", 0.7, 0.85, False), ("transverse_factor", 1.2, 1.6, False)),
    "rigid_sector": (("rigid_fraction", 0.05, 0.15, False),),
    "wheel_loads": (
        ("shift_x_m", 0.005, 0.015, True),
        ("shift_y_m", 0.005, 0.015, True),
        ("com_share", 1.0, 1.0, False),
    ),
    "load_transfer": (("com_height_m", 0.04, 0.1, False), ("com_share", 1.0, 1.0, False)),
    "stribeck": (("dynamic_ratio", 0.6, 0.8, False), ("stribeck_speed_m_s", 0.02, 0.06, False)),
    "slip_ratio_friction": (("share", 1.0, 1.0, False), ("steepness", 8.0, 30.0, False)),
    "roller_coupling": (("strength", 1.0, 1.0, False),),
    "elliptic_grip": (("strength", 1.0, 1.0, False),),
    "rolling_resistance": (("coefficient", 0.01, 0.03, False), ("viscous_N_s_per_m", 0.0, 1.0, False)),
    "floor_tilt": (("tilt_x_rad", 0.004, 0.015, True), ("tilt_y_rad", 0.004, 0.015, True)),
    "floor_nap": (("nap_x", 0.1, 0.25, True), ("nap_y", 0.1, 0.25, True)),
    "tether": (
        ("stiffness_N_per_m", 0.4, 1.5, False),
        ("anchor_x_m", 0.2, 0.8, True),
        ("anchor_y_m", 0.2, 0.8, True),
    ),
    "wheel_radius": (("radius_factor", 1.01, 1.03, False),),
    "wheel_toe": (("toe_rad", 0.015, 0.05, True),),
    "motor_lag": (("lag_s", 0.04, 0.12, False),),
    "wheel_play": (("play_rad", 0.006, 0.03, False),),
    "speed_droop": (("droop_rad_s_per_N_m", 4.0, 20.0, False),),
}


def row(name: str, wanted: str, traces: tuple[str, ...], found: Diagnosis, seconds: float) -> dict[str, Any]:
    """What one diagnosis said, against what was wanted."""
    first = found.findings[0] if found.findings else None
    return {
        "set": name,
        "wanted": wanted,
        "wanted_traces": list(traces),
        "verdict": found.verdict.value,
        "found": [f.name for f in found.findings],
        "traced_to": [f.traced_to.value for f in found.findings],
        "confused_with": list(first.confused_with) if first else [],
        "chi_before": round(found.before.chi, 3),
        "chi_after": round(found.after.chi, 3),
        "rmse_before_m": found.before.rmse_position_m,
        "rmse_after_m": found.after.rmse_position_m,
        "seconds": round(seconds, 1),
    }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Job:
    """A data set that is made when its turn comes, and what a diagnosis of it should say."""

    name: str
    wanted: str
    traces: tuple[str, ...]
    make: Callable[[], DataSet]

    def run(self) -> dict[str, Any]:
        """Make it, diagnose it, print the row."""
        data = self.make()
        start = time.perf_counter()
        found = diagnose(data, seed=1)
        return show(row(self.name, self.wanted, self.traces, found, time.perf_counter() - start))


def sets(folders: list[str]) -> list[Job]:
    """Data sets from disk."""
    jobs = []
    for folder in folders:
        truth_file = Path(folder) / "truth.json"
        truth = json.loads(truth_file.read_text(encoding="utf-8")) if truth_file.exists() else {}
        traces = tuple(str(truth.get("traced_to") or "").split("+"))
        make = partial(read_data_set, folder)
        jobs.append(Job(name=Path(folder).name, wanted=truth.get("effect", "?"), traces=traces, make=make))
    return jobs


def inventions() -> list[Job]:
    """The plants of :mod:`inventions`."""
    return [
        Job(
            name=plant.name,
            wanted="unnamed",
            traces=tuple(t.value for t in plant.traces),
            make=partial(planted, smooth_kiwi(), plant, seed=100 + k),
        )
        for k, plant in enumerate(plants())
    ]


def nulls(count: int) -> list[Job]:
    """Nothing planted, drawn noise and manoeuvres; every other set does not say how noisy it is."""

    def make(k: int) -> DataSet:
        rate_hz = float(np.random.default_rng(k).choice([50.0, 100.0, 200.0]))
        data = planted(smooth_kiwi(), None, seed=1000 + k, rate_hz=rate_hz)
        return replace(data, sigma=data.sigma if k % 2 else None)

    return [Job(name=f"null {k}", wanted="none", traces=(), make=partial(make, k)) for k in range(count)]


def catalogue(count: int) -> list[Job]:
    """Drawn effects of the catalogue, drawn sizes."""
    names = [e.name for e in CATALOGUE if e.name in SIZES]
    jobs = []
    for k in range(count):
        name = names[k % len(names)]
        effect = drawn(name, np.random.default_rng(5000 + k))
        plant = Plant(name=name, traces=(effect.traced_to,), effects=(effect,))
        make = partial(commanded if effect.needs_commands else planted, smooth_kiwi(), plant, 7000 + k)
        jobs.append(Job(name=f"{name} {k}", wanted=name, traces=(effect.traced_to.value,), make=make))
    return jobs


def summary(rows: list[dict[str, Any]]) -> None:
    """What the rows come to: names, variables, errors, false alarms, who was taken for whom."""
    effects = [r for r in rows if r["wanted"] != "none"]
    empty = [r for r in rows if r["wanted"] == "none"]
    if empty:
        print(f"false alarms: {sum(bool(r['found']) for r in empty)} of {len(empty)}")
    if effects:
        named = sum(r["found"][:1] == [r["wanted"].split("+")[0]] for r in effects)
        traced = sum(bool(r["traced_to"]) and r["traced_to"][0] in r["wanted_traces"] for r in effects)
        halved = sum(r["chi_after"] <= 0.5 * r["chi_before"] for r in effects)
        print(f"right name {named}, right variable {traced}, error halved {halved}, of {len(effects)}")
    taken: dict[tuple[str, str], int] = {}
    for r in effects:
        said = " + ".join(r["found"]) or "-"
        taken[r["wanted"], said] = taken.get((r["wanted"], said), 0) + 1
    for (wanted, said), count in sorted(taken.items()):
        print(f"  {wanted:<26}{'as ' if said != wanted else ''}{said:<60}{count:4d}")


def drawn(name: str, random: np.random.Generator) -> Effect:
    """An effect of the catalogue with a drawn size."""
    effect = effect_class(name)
    assert effect is not None
    values = {p.name: p.null for p in effect.parameters}
    for key, low, high, signed in SIZES[name]:
        values[key] = random.uniform(low, high) * (random.choice([-1.0, 1.0]) if signed else 1.0)
    vector = np.array([values[p.name] for p in effect.parameters])
    if issubclass(effect, WheelEffect) and effect.one_wheel:
        return effect.of(vector, (str(random.choice(["1", "2", "3"])),))
    return effect.of(vector)


def show(line: dict[str, Any]) -> dict[str, Any]:
    """Print a row and hand it on."""
    found = ", ".join(f"{n} ({t})" for n, t in zip(line["found"], line["traced_to"], strict=True)) or "-"
    print(
        f"{line['set']:<40} {line['wanted']:<24} {found:<60} chi {line['chi_before']:8.2f} → "
        f"{line['chi_after']:6.2f}  {line['seconds']:5.0f} s",
        flush=True,
    )
    return line


def main(words: list[str]) -> None:
    """Run one mode."""
    keeper, words = Keeper.of(words, __doc__)
    mode, *rest = words or ["nulls", "8"]
    if mode == "table":
        summary(collected(rest))
        return
    if mode == "sets":
        jobs = sets(rest)
    elif mode == "plants":
        jobs = inventions()
    else:
        jobs = {"nulls": nulls, "catalogue": catalogue}[mode](int(rest[0]))
    summary(keeper.run([(job.name, job.run) for job in jobs]))


if __name__ == "__main__":
    main(sys.argv[1:])
