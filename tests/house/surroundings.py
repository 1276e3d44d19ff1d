"""Run tests in surroundings that a user may have (``make test-surroundings``).

Warnings as errors (``python -W error``), assertions removed (``-O``: those of the tests stay, since pytest
rewrites them), one core, and a locale that is not UTF-8.  ``--only one-core`` picks one; anything else is
handed to pytest: paths, ``-k name``.  Without paths the rooms are run that touch the machine.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Files, streams, text, arguments and numbers: what depends on where it runs.
USUAL = ("io", "cli", "robot", "report", "physics", "data", "sets", "test_work.py")
#: pytest's own word under -O; it is about assertions outside tests.
QUIET = "ignore:assertions not in test modules"


@dataclass(frozen=True)
class Surrounding:
    """How the interpreter is called, with which variables, and under which program."""

    python: tuple[str, ...] = ()
    environment: dict[str, str] = field(default_factory=dict)
    under: tuple[str, ...] = ()


SURROUNDINGS = {
    "warnings": Surrounding(python=("-W", "error")),
    "optimised": Surrounding(python=("-O",)),
    "one-core": Surrounding(under=("taskset", "-c", "0")),
    "locale": Surrounding(
        environment={"LC_ALL": "C", "LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    ),
}


def command(one: Surrounding, rest: list[str]) -> list[str]:
    """How the tests are run there."""
    paths = [word for word in rest if not word.startswith("-")]
    usual = [] if paths else [str(ROOT / "tests" / "rooms" / name) for name in USUAL]
    words = [*one.under, sys.executable, *one.python, "-m", "pytest", "-p", "no:cacheprovider"]
    return [*words, "-W", QUIET, *rest, *usual]


def main(arguments: list[str] | None = None) -> int:
    """Run the tests in each of them and print a line for each; 1 where one is red."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", choices=sorted(SURROUNDINGS), help="one of them")
    chosen, rest = parser.parse_known_args(arguments)
    red = 0
    for name, one in SURROUNDINGS.items():
        if chosen.only not in (None, name):
            continue
        if one.under and shutil.which(one.under[0]) is None:
            print(f"{name:<10} left out: there is no {one.under[0]} here")
            continue
        start = time.monotonic()
        done = subprocess.run(
            command(one, rest), cwd=ROOT, env=os.environ | one.environment, capture_output=True,
            encoding="utf-8", errors="replace", check=False,
        )  # fmt: skip
        lines = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
        last = "".join((done.stdout.strip() or done.stderr.strip()).splitlines()[-1:])
        spent = f"{time.monotonic() - start:6.0f} s"
        print(f"{name:<10} {spent}  status {done.returncode}: {last}", *lines, sep="\n  ", flush=True)
        red |= done.returncode
    return int(red != 0)


if __name__ == "__main__":
    sys.exit(main())
