"""Make docs/real-robots.md from benchmarks/results/real.json, which ``run.py`` wrote.

    python benchmarks/real/page.py            print the page
    python benchmarks/real/page.py --write    write docs/real-robots.md

A test compares the page with this script's output.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

from slipmargin.report.text import two_digits

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "real.json"
PAGE = ROOT / "docs" / "real-robots.md"

#: The word for an effect that a line begins with.
EFFECT, CODE = re.compile(r"^[\w\[\]-]+"), r"`\g<0>`"

#: What each set is, in a sentence or two.
SETS = {
    "robotino-load": (
        "A Festo Robotino 2 with a payload of 1.4 kg at its front, on a carpet, commanded 0.1 m/s. Fitted: "
        "every second heading of the table, of the carpet, and of the carpet with the payload (108 runs). "
        "Judged: the other 36 headings with the payload. Models without groups are fitted to the "
        "payload's own 36 runs."
    ),
    "robotino-gray": (
        "The same robot without payload on the same carpet. Fitted: every second heading at 0.1 and at "
        "0.2 m/s (72 runs). Judged: the other 72."
    ),
    "robotino-green": (
        "The same robot on a thick carpet, on which it slips by half of the way. Fitted: every second "
        "heading at 0.1 and at 0.2 m/s (72 runs). Judged: the other 72."
    ),
    "robojackets": (
        "A RoboCup SSL robot with four omni wheels at up to 2.5 m/s, by an overhead camera that is "
        "late by an unknown delay, without time stamps. Fitted: blocks of 5 s with even numbers. "
        "Judged: those with odd numbers (8 runs of 2.5 s)."
    ),
}

HEAD = """# Real robots

How far models are off on runs that they have not seen. `python benchmarks/real/run.py DATA` measures
every row from folders that you provide, and downloads nothing; `python benchmarks/real/page.py --write`
makes this page. Splits are by whole runs and fixed by name (`benchmarks/real/sets.py`).

**Columns.** Displacement and heading are root mean squares over stretches of 0.5 s and 2 s that follow
each other, and over whole runs; displacements are vectors in the body frame, by each one's own heading,
so that a heading error is not charged twice. Their share is that of the way. Velocity is compared over
0.1 s, along the body's x and y. NLL is the negative log likelihood of the errors over 0.5 s under a
Gaussian whose covariance comes from the fitted runs, in nats a stretch: lower is better. Bold are a set's
least errors of displacement and heading.

**Rows.** *Wheels as they are*: no slip, and the camera as it is
(on the Robotino its scale is 10 % off). *Scale per axis*: one factor on each axis. *Gain, Coulomb, lag*:
v = g u − c sign u − τ u̇ on each axis, as SSL teams such as TIGERs Mannheim use it. *Neural network*:
two layers of 32 on a quarter second of wheel speeds, stopped early by whole runs. *Sparse regression*:
sequentially thresholded least squares over 19 terms. *Mean of the two runs beside it*: no model; where
the robot drove in many directions, the fitted runs to the left and right of each, which also differ
by their own headings. *slipmargin, robot as stated*: the simulator with
the robot file (made-up friction; on the Robotino the camera as calibrated on all runs of the table).
*slipmargin diagnose*: the same after `diagnose` was left alone with the fitted runs.

**A development set.** No fit sees the judged runs. But the search of `diagnose` was changed several times
after a look at these rows, so for slipmargin's last row they are what was looked at while developing, and
no test. A test would be runs that were never used here, such as your own.

Speeds are commanded: on the carpets the robot moved at about half of them. `wheel_loads` moves the centre of
the loads, and that of the mass with it unless *where stated* stands there. What the parameters mean stands
under [Effects](effects.md).
"""

FOOT = """## Add a row

Write a class with `fit(data)` and `path(record)` in `benchmarks/real/models.py`, and a line in its
`ROWS`. `fit` may use `data.own` (or all of `data.fitted`) and nothing of `data.judged`. Run the script
with `--row NAME`, and send the rows of `real.json` with your class. Losing rows are as welcome as
winning ones.
"""


def cells(row: dict[str, Any], rows: list[dict[str, Any]]) -> list[str]:
    """A row's figures, those bold that are the least of the set's ``rows``."""

    def marked(word: str, what: str, text: str) -> str:
        return f"**{text}**" if row[word][what] <= min(r[word][what] for r in rows if word in r) else text

    found = [row["model"]]
    for word in ("0.5 s", "2 s", "run"):
        e = row.get(word)
        if e is None:
            found.append("–")
            continue
        place = f"{e['displacement_mm']:.3g} mm ({100 * e['displacement_of_way']:.3g} %)"
        heading = f"{two_digits(e['heading_deg'])}°"
        found.append(f"{marked(word, 'displacement_mm', place)}, {marked(word, 'heading_deg', heading)}")
    v = row["velocity"]
    return [*found, f"{v['x_m_s']:.3f}, {v['y_m_s']:.3f} m/s", f"{row['nll']:.2f}"]


def page() -> str:
    """The page's text."""
    rows = json.loads(RESULTS.read_text(encoding="utf-8"))
    parts = [HEAD]
    for name, words in SETS.items():
        own = [row for row in rows if row["set"] == name]
        if not own:
            continue
        parts.append(f"## {name}\n\n{words}\n")
        head = ["model", "0.5 s", "2 s", "whole run", "velocity x, y", "NLL"]
        table = [head, ["---"] * len(head), *[cells(row, own) for row in own]]
        parts.append("\n".join(f"| {' | '.join(line)} |" for line in table) + "\n")
        for row in own:
            if row["said"]:
                told = "\n".join(f"- {EFFECT.sub(CODE, line)}" for line in row["said"])
                parts.append(f"*{row['model']}* found, with 95 % intervals:\n\n{told}\n")
    return "\n".join([*parts, FOOT])


if __name__ == "__main__":
    if "--write" in sys.argv:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page())
