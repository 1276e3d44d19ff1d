"""Run the tests with drawn examples under many random seeds, and say which seed fails.

``python tests/house/seeds.py`` runs every such test under the seeds 1 … 20; ``--seeds 3,17-19`` names
them, ``--first-failure`` stops at the first red one, and anything else is handed to pytest: paths, ``-n 2``,
``-k name``.  The same seed draws the same examples, so that a red seed can be repeated by the command
that is printed.  Exit status 1 if a seed failed.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: pytest's exit status where no test was selected.
NOTHING_SELECTED = 5


def numbers(text: str) -> list[int]:
    """The seeds of ``3,17-19``."""
    found: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        found += range(int(first), int(last or first) + 1)
    return found


def command(seed: int, rest: list[str]) -> list[str]:
    """How one seed is run."""
    flags = ["-m", "hypothesis", f"--hypothesis-seed={seed}", "-p", "no:cacheprovider"]
    return [sys.executable, "-m", "pytest", *flags, *rest]


def environment() -> dict[str, str]:
    """The caller's, without ``CI``, which would draw fixed examples whatever the seed."""
    return {name: value for name, value in os.environ.items() if name != "CI"}


def failed_tests(output: str) -> list[str]:
    """The names that pytest's summary lists as failed."""
    return re.findall(r"^(?:FAILED|ERROR) (\S+)", output, flags=re.MULTILINE)


def main(arguments: list[str] | None = None) -> int:
    """Run the seeds one after the other and print a line for each."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=numbers, default=numbers("1-20"), help="such as 3,17-19 (1-20)")
    parser.add_argument("--first-failure", action="store_true", help="stop at the first seed that fails")
    parser.add_argument("--log", type=Path, help="folder that gets the full output of each seed that fails")
    chosen, rest = parser.parse_known_args(arguments)
    red: dict[int, list[str]] = {}
    for seed in chosen.seeds:
        start = time.monotonic()
        done = subprocess.run(
            command(seed, rest), cwd=ROOT, env=environment(), capture_output=True, text=True, check=False
        )
        if done.returncode == NOTHING_SELECTED:
            print("no test with drawn examples was selected", file=sys.stderr)
            return 2
        lines = done.stdout.strip().splitlines()
        print(f"seed {seed:3d}  {time.monotonic() - start:6.1f} s  {lines[-1] if lines else ''}", flush=True)
        if done.returncode == 0:
            continue
        red[seed] = failed_tests(done.stdout)
        print("\n".join(f"          {name}" for name in red[seed]) or done.stderr, flush=True)
        if chosen.log is not None:
            chosen.log.mkdir(parents=True, exist_ok=True)
            (chosen.log / f"seed-{seed}.txt").write_text(done.stdout + done.stderr, encoding="utf-8")
        if chosen.first_failure:
            break
    for seed, names in red.items():
        print("repeat: " + " ".join(["python", *command(seed, names or rest)[1:]]))
    print(f"{len(red)} of {len(chosen.seeds)} seeds failed" if red else f"all {len(chosen.seeds)} seeds pass")
    return 1 if red else 0


if __name__ == "__main__":
    sys.exit(main())
