"""Diagnose again and again in one process: memory must stay flat (``flat_memory.py --count 1000``).

The data are pulls alone, with every tenth time three short runs.  After a few rounds that load libraries,
the resident memory is fitted by a line; its slope is printed in kilobytes a diagnosis.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
#: Rounds that load libraries and fill caches, and the growth that is noise [kB a diagnosis].
FIRST, NOISE_KB = 20, 20.0
#: Every so many times it is runs.
EVERY = 10
RESULTS = ROOT / "benchmarks" / "results" / "flat_memory.json"


def resident_kb() -> float:
    """Memory of this process that is in use now [kB]."""
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * resource.getpagesize() / 1024.0


def data_set(folder: Path, kind: str) -> Path:
    """A data set of the rig: some of its pulls, or its runs cut short."""
    rig = ROOT / "tests" / "data" / "rig" / "a-null"
    folder.mkdir()
    for name in ("robot.toml", "dataset.toml"):
        (folder / name).write_bytes((rig / name).read_bytes())
    if kind == "pulls":
        (folder / "pulls.csv").write_text((rig / "pulls.csv").read_text(encoding="utf-8"), encoding="utf-8")
        return folder
    (folder / "trials").mkdir()
    for file in sorted((rig / "trials").glob("*.csv"))[:3]:
        lines = file.read_text(encoding="utf-8").split("\n")[:40]
        (folder / "trials" / file.name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder


def main() -> int:
    """Diagnose, print the memory now and then and its slope at the end; 1 where it grows."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--count", type=int, default=1000)
    words.add_argument("--data", choices=("pulls", "runs", "both"), default="both")
    words.add_argument("--budget", type=float, default=0.3, help="seconds a search may take")
    words.add_argument("--minutes", type=float, default=1e9, help="stop after this time")
    words.add_argument("--json", type=Path, default=RESULTS, help="where the figures are kept")
    asked = words.parse_args()
    import slipmargin as sm

    kept: list[float] = []
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        sets = {kind: data_set(Path(name) / kind, kind) for kind in ("pulls", "runs")}
        while len(kept) < asked.count and time.monotonic() - start < 60.0 * asked.minutes:
            kind = "runs" if len(kept) % EVERY == EVERY - 1 else "pulls"
            found = sm.diagnose(sets[kind if asked.data == "both" else asked.data], budget_s=asked.budget)
            found.to_json()
            kept.append(resident_kb())
            if len(kept) % 50 == 0:
                print(f"{len(kept)} diagnoses, {kept[-1] / 1024.0:.1f} MB", flush=True)
    rest = np.array(kept[FIRST:])
    least, most = rest.min() / 1024.0, rest.max() / 1024.0
    slope = float(np.polyfit(np.arange(len(rest)), rest, 1)[0]) if len(rest) > 2 else float("nan")
    print(f"{len(kept)} diagnoses: {least:.1f} to {most:.1f} MB, {slope:+.1f} kB a diagnosis")
    figures = {
        "diagnoses": len(kept),
        "least_MB": round(least, 1),
        "most_MB": round(most, 1),
        "kB_a_diagnosis": round(slope, 2),
        "cpu_s": round(time.process_time(), 0),
    }
    asked.json.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    return int(not slope <= NOISE_KB)


if __name__ == "__main__":
    sys.exit(main())
