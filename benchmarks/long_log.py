"""Peak memory and time of ``slipmargin import csv`` on a log of ten million rows, and whether progress shows.

    python benchmarks/long_log.py benchmarks/results/long_log.json [--rows 1e7]

The log is written first (half a gigabyte).  The command runs as its own process with a terminal as stderr;
its peak is that of the operating system (``ru_maxrss``).
"""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from kept import write_figures

from slipmargin.work import FACTOR, ROWS

#: What a log of this length may take [GiB].
ALLOWED_GiB = 2.0
COLUMNS = ["--time", "t:ms", "--x", "x:mm", "--y", "y:mm", "--heading", "h:deg"]
COLUMNS += [word for i in (1, 2, 3) for word in ("--wheel", f"w{i}:rpm")]
#: Rows after which the motion begins again, the time running on.
PERIOD = 10_000


def write_log(path: Path, rows: int) -> None:
    """A log at 100 Hz: a circle of two metres that takes 100 s, again and again."""
    motion = []
    for k in range(PERIOD):
        turn = 2.0 * math.pi * k / PERIOD
        wheels = (30.0 * math.sin(turn + i) for i in range(3))
        cells = (1e3 * math.sin(turn), 1e3 * math.cos(turn), math.degrees(turn), *wheels)
        motion.append(",".join(f"{v:.3f}" for v in cells))
    with path.open("w", encoding="ascii") as file:
        file.write("t,x,y,h,w1,w2,w3\n")
        for first in range(0, rows, PERIOD):
            file.writelines(f"{10 * (first + k)},{motion[k]}\n" for k in range(min(PERIOD, rows - first)))


def imported(folder: Path, rows: int) -> dict[str, Any]:
    """Import the log; exit status, peak memory, times, and how many steps of progress were shown."""
    words = [sys.executable, "-m", "slipmargin", "import", "csv", "l.csv", "--out", "o", *COLUMNS]
    words += ["--robot", "ohio-kiwi", "--surface", "paper"]
    terminal, end = os.openpty()
    start = time.monotonic()
    child = os.fork()
    if child == 0:
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.dup2(end, 2)
        raised = {FACTOR: str(max(1, math.ceil(rows / ROWS))), "TERM": "xterm"}
        os.execve(words[0], words, os.environ | raised)
    os.close(end)
    shown = b""
    while part := _read(terminal):
        shown += part
    _, state, use = os.wait4(child, 0)
    peak = use.ru_maxrss / 2**20  # kB on Linux
    steps = {int(n) for n in re.findall(rb"(\d+)%", shown)}
    written = sum(p.stat().st_size for p in (folder / "o").rglob("*") if p.is_file())
    if os.waitstatus_to_exitcode(state):
        sys.stderr.write(shown.decode(errors="replace")[-600:])
    return {
        "rows": rows,
        "log_MB": round((folder / "l.csv").stat().st_size / 1e6),
        "status": os.waitstatus_to_exitcode(state),
        "peak_GiB": round(peak, 3),
        "cpu_s": round(use.ru_utime + use.ru_stime, 1),
        "wall_s": round(time.monotonic() - start, 1),
        "percentages_shown": len(steps),
        "data_set_MB": round(written / 1e6),
    }


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 1 << 16)
    except OSError:  # the other end is closed
        return b""


def main(words: list[str]) -> int:
    """Write the log, import it, print and keep the figures; 1 where it fails or takes too much."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, nargs="?", help="where the figures are kept (JSON)")
    parser.add_argument("--rows", type=float, default=1e7)
    given = parser.parse_args(words)
    rows = int(given.rows)
    with tempfile.TemporaryDirectory() as name:
        write_log(Path(name) / "l.csv", rows)
        found = imported(Path(name), rows)
    print(", ".join(f"{name} {value}" for name, value in found.items()))
    write_figures(given.out, found)
    return int(found["status"] != 0 or found["peak_GiB"] > ALLOWED_GiB)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
