"""What `diagnose` finds on a rig with real rollers, and what its pulls, which no fit saw, say of it.

    python benchmarks/rig.py RIG --json benchmarks/results/rig.json     about five minutes

RIG holds the folders ``a-null`` (loads levelled: nothing is missing but what real rollers do) and
``b-natural-loads``: the format is in tests/data/rig/README.md, which has a part of them.  Development sets.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

from kept import Keeper

import slipmargin as sm
from slipmargin.api.diagnose import DiagnosisResult

SETS = ("a-null", "b-natural-loads")


def row(folder: Path) -> dict[str, Any]:
    """A set's verdict, names, errors on unseen runs, loads and pulls, before and after."""
    began = time.monotonic()
    result = sm.diagnose(folder)
    if not isinstance(result, DiagnosisResult):
        raise TypeError(f"{folder} has pulls alone")
    found, pulls = result.diagnosis, result.change.pulls
    if pulls is None:
        raise ValueError(f"{folder} has no pulls")
    rest_N = found.corrected.build(found.surface).loads.rest_N
    return {
        "verdict": found.verdict.value,
        "found": [finding.name for finding in found.findings],
        "leads": [lead.traced_to.value for lead in found.leads],
        "rmse_mm": [1e3 * found.before.rmse_position_m, 1e3 * found.after.rmse_position_m],
        "chi": [found.before.chi, found.after.chi],
        "load_shares": (rest_N / rest_N.sum()).tolist(),
        "pulls": pulls.count,
        "pulls_rms_N": [pulls.rms_before_N, pulls.rms_after_N],
        "seconds": round(time.monotonic() - began, 1),
    }


def main(words: list[str]) -> None:
    """Measure both sets."""
    keeper, left = Keeper.of(words, __doc__)
    rig = Path(left[0]) if left else None
    if rig is None:
        raise SystemExit("rig.py: give the folder that holds a-null and b-natural-loads")
    for found in keeper.run([(name, partial(row, rig / name)) for name in SETS]):
        print(found)


if __name__ == "__main__":
    main(sys.argv[1:])
