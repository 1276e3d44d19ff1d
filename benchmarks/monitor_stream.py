"""Hours of a 1 kHz stream through the slip monitor at full speed: memory and processor time at each tenth.

    python benchmarks/monitor_stream.py benchmarks/results/monitor_stream.json [--hours 10]

A four-wheel robot with every channel.  Lines are made on the way, so that the monitor is all that could keep
anything; making them is timed alone and taken off.
"""

from __future__ import annotations

import argparse
import gc
import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from kept import write_figures

import slipmargin as sm

RATE_HZ = 1000
HEAD = ",".join(
    [
        "t_s",
        *(f"omega{i}_rad_s" for i in range(1, 5)),
        *(f"omega{i}_cmd_rad_s" for i in range(1, 5)),
        "gyro_rad_s",
        *(f"current{i}_A" for i in range(1, 5)),
    ]
)


def lines(count: int) -> Iterator[str]:
    """A header and ``count`` samples: ten seconds of noise over and over, the time running on."""
    rng = np.random.default_rng(0)
    cells = [",".join(f"{v:.4f}" for v in row) for row in rng.normal(size=(10_000, 13))]
    yield HEAD
    for k in range(count):
        yield f"{k / RATE_HZ:.3f},{cells[k % 10_000]}"


def resident_bytes() -> int:
    """Memory of this process that is in use [bytes] (Linux)."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return 1024 * int(status.split("VmRSS:")[1].split()[0])


def streamed(hours: float) -> dict[str, Any]:
    """Rows (hours streamed, resident bytes, share of a core) at each tenth, the last over that tenth."""
    monitor = sm.SlipMonitor(
        "mecanum4", "floor", gyro=True, current=True, commanded=True, torque_per_ampere_N_m=0.5
    )
    count = round(3600.0 * RATE_HZ * hours)
    start = time.process_time()
    for _ in lines(20_000):
        pass
    making = (time.process_time() - start) / 20_000
    for _ in monitor.stream(lines(5_000)):  # what is made once is made now
        pass
    gc.collect()
    monitor.restart()
    before, part = resident_bytes(), max(count // 10, 1)
    rows, start = [], time.process_time()
    for k, _ in enumerate(monitor.stream(lines(count))):
        if k and k % part == 0:
            now = time.process_time()
            busy = ((now - start) / part - making) * RATE_HZ
            rows.append([k / RATE_HZ / 3600.0, resident_bytes(), busy])
            start = now
    return {
        "samples": count,
        "resident before [bytes]": before,
        "hours, resident bytes, share of a core": rows,
        "gained since the first tenth [bytes]": rows[-1][1] - rows[0][1],
        "largest share of a core": max(row[2] for row in rows),
    }


def main(words: list[str]) -> None:
    """Stream, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--hours", type=float, default=10.0)
    given = parser.parse_args(words)
    found = streamed(given.hours)
    write_figures(given.out, found)
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main(sys.argv[1:])
