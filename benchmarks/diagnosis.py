"""How well the loop finds what is missing: given sets, inventions, null sets, the whole catalogue.

    python benchmarks/diagnosis.py sets FOLDER…          data sets with or without truth.json
    python benchmarks/diagnosis.py plants [FIRST LAST]    thirty inventions that no catalogue entry holds
    python benchmarks/diagnosis.py nulls COUNT            nothing planted: false alarms
    python benchmarks/diagnosis.py catalogue COUNT        drawn effects of drawn size: confusion table

Without a word: eight null sets.  Every line is printed as it is known; ``--json FILE`` keeps them.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from planting import Plant, planted, plants

from slipmargin.diagnose.diagnosis import Diagnosis
from slipmargin.diagnose.loop import diagnose
from slipmargin.effects import Effect
from slipmargin.effects.catalogue import CATALOGUE, effect_class
from slipmargin.io.data_set import DataSet, WheelSignal, read_data_set
from slipmargin.io.robot_file import read_recipe

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
    "speed_droop": (("droop_rad_s_per_N_m", 4.0, 20.0, False),),
}
_ONE_WHEEL = ("wheel_radius", "wheel_toe")
_COMMANDED = ("motor_lag", "speed_droop")


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


def timed(data_set: DataSet) -> tuple[Diagnosis, float]:
    """A diagnosis and how long it took."""
    start = time.perf_counter()
    found = diagnose(data_set, seed=1)
    return found, time.perf_counter() - start


def sets(folders: list[str]) -> list[dict[str, Any]]:
    """Data sets from disk."""
    rows = []
    for folder in folders:
        truth_file = Path(folder) / "truth.json"
        truth = json.loads(truth_file.read_text()) if truth_file.exists() else {}
        found, seconds = timed(read_data_set(folder))
        traces = tuple(str(truth.get("traced_to") or "").split("+"))
        rows.append(show(row(Path(folder).name, truth.get("effect", "?"), traces, found, seconds)))
    return rows


def inventions(first: int, last: int) -> list[dict[str, Any]]:
    """The plants of :mod:`planting`."""
    recipe = read_recipe("ohio-kiwi")
    recipe = replace(recipe, robot=_smooth(recipe.robot))
    rows = []
    for k, plant in list(enumerate(plants()))[first:last]:
        found, seconds = timed(planted(recipe, plant, seed=100 + k))
        traces = tuple(t.value for t in plant.traces)
        rows.append(show(row(plant.name, "unnamed", traces, found, seconds)))
    good = sum(r["traced_to"][:1] != [] and r["traced_to"][0] in r["wanted_traces"] for r in rows)
    half = sum(r["chi_after"] <= 0.5 * r["chi_before"] for r in rows)
    print(f"right variable {good} of {len(rows)}, error at least halved {half} of {len(rows)}")
    return rows


def nulls(count: int) -> list[dict[str, Any]]:
    """Nothing planted, drawn noise and manoeuvres."""
    recipe = read_recipe("ohio-kiwi")
    recipe = replace(recipe, robot=_smooth(recipe.robot))
    rows = []
    for k in range(count):
        random = np.random.default_rng(k)
        data = planted(recipe, None, seed=1000 + k, rate_hz=float(random.choice([50.0, 100.0, 200.0])))
        sigma = data.sigma if k % 2 else None
        found, seconds = timed(replace(data, sigma=sigma))
        rows.append(show(row(f"null {k}", "none", (), found, seconds)))
    alarms = sum(bool(r["found"]) for r in rows)
    print(f"false alarms {alarms} of {len(rows)}")
    return rows


def catalogue(count: int) -> list[dict[str, Any]]:
    """Drawn effects of the catalogue, drawn sizes; prints the confusion table."""
    recipe = read_recipe("ohio-kiwi")
    recipe = replace(recipe, robot=_smooth(recipe.robot))
    names = [e.name for e in CATALOGUE if e.name in SIZES]
    rows = []
    for k in range(count):
        random = np.random.default_rng(5000 + k)
        name = names[k % len(names)]
        effect = drawn(name, random)
        plant = Plant(name=name, traces=(effect.traced_to,), effects=(effect,))
        data = planted(recipe, plant, seed=7000 + k)
        if name in _COMMANDED:
            data = _as_commanded(data, recipe, plant, 7000 + k)
        found, seconds = timed(data)
        rows.append(show(row(f"{name} {k}", name, (effect.traced_to.value,), found, seconds)))
    right = sum(r["found"][:1] == [r["wanted"]] for r in rows)
    traced = sum(r["traced_to"][:1] == r["wanted_traces"] for r in rows)
    print(f"right name {right} of {len(rows)}, right variable {traced} of {len(rows)}")
    for r in rows:
        if r["found"][:1] != [r["wanted"]]:
            print(f"  {r['set']}: said {r['found']} (confused with {r['confused_with']})")
    return rows


def drawn(name: str, random: np.random.Generator) -> Effect:
    """An effect of the catalogue with a drawn size."""
    effect = effect_class(name)
    assert effect is not None
    values = {p.name: p.null for p in effect.parameters}
    for key, low, high, signed in SIZES[name]:
        values[key] = random.uniform(low, high) * (random.choice([-1.0, 1.0]) if signed else 1.0)
    wheels = (str(random.choice(["1", "2", "3"])),) if name in _ONE_WHEEL else ()
    return effect.of(np.array([values[p.name] for p in effect.parameters]), wheels)


def _as_commanded(data: DataSet, recipe: Any, plant: Plant, seed: int) -> DataSet:
    from planting import commanded

    assert data.wheel_signal is WheelSignal.MEASURED
    return commanded(recipe, plant, seed)


def _smooth(robot: Any) -> Any:
    """The robot without rigid sectors and with wheels called 1, 2, 3."""
    wheels = tuple(replace(w, rigid_fraction=0.0, name=str(i + 1)) for i, w in enumerate(robot.wheels))
    return replace(robot, wheels=wheels)


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
    target = None
    if "--json" in words:
        at = words.index("--json")
        target = Path(words[at + 1])
        words = words[:at] + words[at + 2 :]
    mode, *rest = words or ["nulls", "8"]
    if mode == "sets":
        rows = sets(rest)
    elif mode == "plants":
        rows = inventions(int(rest[0]) if rest else 0, int(rest[1]) if len(rest) > 1 else 99)
    elif mode == "nulls":
        rows = nulls(int(rest[0]))
    else:
        rows = catalogue(int(rest[0]))
    if target is not None:
        target.write_text(json.dumps(rows, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
