"""How long a command takes as a whole process, beside a bare interpreter and a bare import of cvxpy.

Run: ``python benchmarks/startup.py [FILE.json]``.  Best and median of several runs of each, interleaved.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from kept import with_file, write_figures

SLIPMARGIN = str(Path(sys.executable).with_name("slipmargin"))
COMMANDS = {
    "python -c pass": [sys.executable, "-c", "pass"],
    "slipmargin --help": [SLIPMARGIN, "--help"],
    "slipmargin sweep --help": [SLIPMARGIN, "sweep", "--help"],
    "slipmargin robots show": [SLIPMARGIN, "robots", "show", "ohio-kiwi"],
    "slipmargin sweep": [SLIPMARGIN, "sweep", "ohio-kiwi", "--surface", "paper"],
    "slipmargin sweep --out": [SLIPMARGIN, "sweep", "ohio-kiwi", "--surface", "paper", "--out", "f.csv"],
    "slipmargin polytope": [SLIPMARGIN, "polytope", "ohio-kiwi", "--surface", "paper"],
    "slipmargin sweep --plot": [SLIPMARGIN, "sweep", "ohio-kiwi", "--surface", "paper", "--plot", "f.png"],
    "import cvxpy": [sys.executable, "-c", "import cvxpy"],
}
#: What was promised, whole process [s].
PROMISED = {"slipmargin --help": 0.3, "slipmargin sweep": 1.0}


def measure(repeats: int = 7) -> dict[str, dict[str, float]]:
    """Best and median wall time [s] of each command."""
    times: dict[str, list[float]] = {name: [] for name in COMMANDS}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats + 1):
            for name, words in COMMANDS.items():
                start = time.perf_counter()
                subprocess.run(words, cwd=folder, capture_output=True, check=True, timeout=120)
                times[name].append(time.perf_counter() - start)
    return {name: {"best_s": min(t[1:]), "median_s": statistics.median(t[1:])} for name, t in times.items()}


def main() -> None:
    """Print the table; write JSON where a file is named."""
    file = with_file(__doc__).parse_args().file
    found = measure()
    for name, row in found.items():
        promise = f"   promised {PROMISED[name]:.1f} s" if name in PROMISED else ""
        print(f"{name:<26}{row['best_s']:8.3f} s best{row['median_s']:8.3f} s median{promise}")
    write_figures(file, found)


if __name__ == "__main__":
    main()
