"""Draw sets of pulls by a robot that may have an effect: what constants of a diagnosis by pulls are asked of.

    python benchmarks/judged/draw_pulls.py --seed 1 --out DIR

DIR then holds ``sets/NAME``, each a data set of pulls alone, and ``truth.json``, as ``draw.py`` writes them.
The robot is the paper's.  Two sets have no effect, of one of them no wheel angle is known.  The others have
one each: coefficients, loads, a tilt of the floor.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from planted_pulls import data_set, planted, pulled, robot

from slipmargin.effects.catalogue import effect_class
from slipmargin.io.data_set_write import write_data_set
from slipmargin.io.writes import write_text

#: What is planted: an effect, and the range of each of its parameters; the others do nothing.
EFFECTS: dict[str, dict[str, tuple[float, float]]] = {
    "friction_coefficients": {
        "drive_factor": (0.8, 0.95),
        "transverse_factor": (1.1, 1.4),
        "steepness_factor": (1.0, 1.0),
    },
    "wheel_loads": {"shift_x_m": (-0.01, 0.01), "shift_y_m": (0.005, 0.015), "com_share": (1.0, 1.0)},
    "floor_tilt": {"tilt_x_rad": (0.01, 0.03), "tilt_y_rad": (-0.03, -0.01)},
}
#: Noise of a pull [N].
SIGMA_N = 0.06


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args(words)
    (given.out / "sets").mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(given.seed)
    truth: dict[str, dict[str, object]] = {}
    for number, name in enumerate(["", "", *EFFECTS]):
        parameters = {key: float(random.uniform(*ends)) for key, ends in EFFECTS.get(name, {}).items()}
        kind = effect_class(name) if name else None
        real = robot().with_effects(*((planted(name, **parameters),) if kind else ()))
        pulls = pulled(real, angles=number != 1, sigma_N=SIGMA_N, seed=int(random.integers(2**31)))
        write_data_set(
            given.out / "sets" / f"set{number}", data_set(robot(), replace(pulls, sigma_N=SIGMA_N))
        )
        truth[f"set{number}"] = {
            "planted": kind is not None,
            "family": name or "none",
            "catalogue": name or None,
            "variable": kind.traced_to.value if kind else None,
            "also": [],
            "parameters": parameters,
            "instrument_at_fault": False,
        }
    text = json.dumps(
        {"kind": "development", "what": "sets of pulls", "seed": given.seed, "sets": truth}, indent=1
    )
    write_text(given.out / "truth.json", text + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
