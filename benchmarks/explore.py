"""How fast the page of ``slipmargin explore`` follows its sliders, for docs/how-to/explore.md.

    python benchmarks/explore.py benchmarks/results/explore.json

Every slider of four robots goes through its range, each position once, the mass in the middle and off it.
Measured is the processor time of one answer, the least of three tries, since other work on the machine slows
some of them.  Beside it stands that of ``bounds`` (all that the command computes) in the same process:
milliseconds mean something on one machine only, ratios on any.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from kept import with_file, write_figures

import slipmargin as sm
from slipmargin.errors import SlipmarginError

ROBOTS = {"ohio-kiwi": "paper", "robotino": "floor", "mecanum4": "floor", "omni4": "floor"}
#: Positions of each slider: shares of its range, none of them an end or the middle.
POSITIONS = np.linspace(0.07, 0.93, 9)
#: How far off the middle the mass is put, as a share of where its sliders end.
OFF = 0.35
#: How often an answer is asked for; what the page keeps of the last one is forgotten each time.
TRIES = 3
KINDS: dict[str, Callable[..., Any]] = {
    "picture": lambda page, values: page.picture(**values),
    "file": lambda page, values: page.export("nav2", **values),
    "JSON": lambda page, values: page.export("json", **values),
}


def spent(work: Callable[[], Any]) -> float:
    """Processor time of some work [s]."""
    start = time.process_time()
    work()
    return time.process_time() - start


def least(page: Any, work: Callable[[], Any]) -> float:
    """Least processor time of some work of a page that has forgotten its last answer [s]."""
    found = []
    for _ in range(TRIES):
        page.kept.clear()
        found.append(spent(work))
    return min(found)


def robot_row(name: str, floor: str) -> dict[str, Any]:
    """Median and greatest time [ms] by kind of answer, mass in the middle and off it."""
    page = sm.explore(name, floor)
    sliders = {s.key: s for s in page.sliders}
    off = {key: OFF * sliders[key].high for key in ("com_x_m", "com_y_m") if key in sliders}
    whole = min(spent(lambda: sm.bounds(name, floor)) for _ in range(4))
    row: dict[str, Any] = {"wheels": len(page.design.robot.wheels), "bounds_ms": 1e3 * whole}
    for place, base in (("mass as in the file", {}), ("mass off the middle", off)):
        for kind, work in KINDS.items():
            times, refused = [], 0
            for slider in sliders.values():
                for share in POSITIONS[:: 4 if kind == "JSON" else 1]:
                    values = base | {slider.key: slider.low + share * (slider.high - slider.low)}
                    try:
                        times.append(1e3 * least(page, lambda work=work, values=values: work(page, values)))
                    except SlipmarginError:  # told in a sentence: no acceleration is safe there
                        refused += 1
            first = times.pop(0)  # what is loaded once
            row[f"{kind}, {place}"] = {
                "positions": len(times),
                "refused": refused,
                "first_ms": first,
                "median_ms": statistics.median(times),
                "most_ms": max(times),
                "median over bounds": statistics.median(times) / (1e3 * whole),
            }
    return row


def main() -> None:
    """Print the table; write JSON where a file is named."""
    file = with_file(__doc__).parse_args().file
    found = {name: robot_row(name, floor) for name, floor in ROBOTS.items()}
    for name, row in found.items():
        print(f"{name}: {row['wheels']} wheels, bounds {row['bounds_ms']:.0f} ms")
        for kind, times in row.items():
            if isinstance(times, dict):
                print(
                    f"  {kind:<28}{times['median_ms']:6.1f} ms median{times['most_ms']:8.1f} most"
                    f"{times['median over bounds']:7.2f} of bounds ({times['positions']} positions)"
                )
    write_figures(file, found)


if __name__ == "__main__":
    main()
