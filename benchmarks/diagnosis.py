"""What the loop finds in data sets with a known answer.

    python benchmarks/diagnosis.py FOLDER… [--json FILE]

Each folder is a data set; a ``truth.json`` in it says what was planted, by the names ``effect`` and
``traced_to`` (several joined by ``+``).  Every line is printed as it is known; ``--json FILE`` keeps them,
and a run that was stopped goes on from there; ``--part 1/2`` does every other set, for two processes.
Sets that nobody has tuned on are those of ``benchmarks/judged``.
"""

from __future__ import annotations

import json
import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

from kept import Keeper

from slipmargin.diagnosis.loop import diagnose
from slipmargin.io.data_set import read_data_set


def diagnosed(folder: str) -> dict[str, Any]:
    """What one diagnosis says, against what was planted; printed and handed on."""
    truth_file = Path(folder) / "truth.json"
    truth = json.loads(truth_file.read_text(encoding="utf-8")) if truth_file.exists() else {}
    data = read_data_set(folder)
    start = time.perf_counter()
    found = diagnose(data, seed=1)
    row = {
        "set": Path(folder).name,
        "wanted": truth.get("effect", "?"),
        "wanted_traces": str(truth.get("traced_to") or "").split("+"),
        "verdict": found.verdict.value,
        "found": [f.name for f in found.findings],
        "traced_to": [f.traced_to.value for f in found.findings],
        "confused_with": list(found.findings[0].confused_with) if found.findings else [],
        "chi_before": round(found.before.chi, 3),
        "chi_after": round(found.after.chi, 3),
        "rmse_before_m": found.before.rmse_position_m,
        "rmse_after_m": found.after.rmse_position_m,
        "seconds": round(time.perf_counter() - start, 1),
    }
    names = ", ".join(f"{n} ({t})" for n, t in zip(row["found"], row["traced_to"], strict=True)) or "-"
    print(
        f"{row['set']:<40} {row['wanted']:<24} {names:<60} chi {row['chi_before']:8.2f} → "
        f"{row['chi_after']:6.2f}  {row['seconds']:5.0f} s",
        flush=True,
    )
    return row


def main(words: list[str]) -> None:
    """Diagnose every folder, and say how many answers are right."""
    keeper, folders = Keeper.of(words, __doc__)
    rows = keeper.run([(Path(folder).name, partial(diagnosed, folder)) for folder in folders])
    planted = [r for r in rows if r["wanted"] != "none"]
    named = sum(r["found"] == r["wanted"].split("+") for r in planted)
    quiet = sum(not r["found"] for r in rows if r["wanted"] == "none")
    print(f"right names {named} of {len(planted)}, nothing found in {quiet} of {len(rows) - len(planted)}")


if __name__ == "__main__":
    main(sys.argv[1:])
