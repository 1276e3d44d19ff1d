"""Diagnose every set of a drawn collection as ``slipmargin diagnose`` does, one process a set, no pictures.

    python benchmarks/judged/run.py DIR --out results.json [--jobs 2] [--budget 300]

What is known is kept after every set: a run that was stopped goes on where it was.  Nothing of the truth is
opened here.  The row of a set holds its verdict, errors before and after, effects, leads and time.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import partial
from pathlib import Path
from typing import Any

_FIRST_LEADS = 3
#: The search stops at the budget; judgement, tables and pages may take as long again and this [s].
_AFTERWARDS_S = 60.0
#: What each process runs: report.json on its output, or one line of error and the command's exit status.
_DIAGNOSE = """
import sys
import slipmargin as sm
from slipmargin.errors import InputError
try:
    print(sm.diagnose(sys.argv[1], budget_s=float(sys.argv[2])).to_json())
except InputError as fault:
    print(f"error: {fault}", file=sys.stderr)
    sys.exit(2)
"""


def short(report: dict[str, Any]) -> dict[str, Any]:
    """What the score needs of a report.json, by the contract's keys."""
    effects = [
        {
            "name": e["name"],
            "traced_to": e["traced_to"],
            "wheels": e.get("wheels", []),
            "parameters": {
                key: [p.get("value"), p.get("low"), p.get("high")]
                for key, p in e.get("parameters", {}).items()
            },
            "confused_with": e.get("evidence", {}).get("confused_with", []),
        }
        for e in report["effects"]
    ]
    leads = [
        {k: lead.get(k) for k in ("traced_to", "name")}
        for lead in report.get("leads") or []
        if isinstance(lead, dict)
    ]
    errors = ("rmse_position_m", "rmse_heading_rad", "chi")
    return {
        "verdict": report["verdict"],
        "before": {k: report["before"].get(k) for k in errors},
        "after": {k: report["after"].get(k) for k in errors},
        "effects": effects,
        "leads": leads[:_FIRST_LEADS],
    }


def judge(folder: Path, budget_s: float, command: Sequence[str], also: Sequence[str] = ()) -> dict[str, Any]:
    """The row of one set: its report in short, with what it holds under ``also``, or why there is none."""
    began = time.monotonic()
    words = [*command, str(folder), f"{budget_s:g}"]
    latest_s = 2.0 * budget_s + _AFTERWARDS_S
    try:
        done = subprocess.run(
            words, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=latest_s, check=False
        )
    except subprocess.TimeoutExpired:
        return {"verdict": "out-of-time", "seconds": round(time.monotonic() - began, 1)}
    seconds = round(time.monotonic() - began, 1)
    if done.returncode != 0:
        said = (done.stderr.strip().splitlines() or ["no word"])[-1][:300]
        verdict = "refused" if done.returncode == 2 else "failed"
        return {"verdict": verdict, "status": done.returncode, "said": said, "seconds": seconds}
    report = json.loads(done.stdout)
    return short(report) | {"seconds": seconds} | {key: report[key] for key in also}


def keep(path: Path, held: dict[str, Any]) -> None:
    """Write the results whole: a kill leaves the file as it was."""
    rows = ",\n".join(f" {json.dumps(n)}: {json.dumps(row)}" for n, row in sorted(held["sets"].items()))
    head = json.dumps({k: v for k, v in held.items() if k != "sets"})[1:-1]
    new = path.with_name(path.name + ".new")
    new.write_text("{" + head + ',\n"sets": {\n' + rows + "\n}}\n", encoding="utf-8")
    os.replace(new, path)


def answer(
    asked: dict[str, Callable[[], dict[str, Any]]], held: dict[str, Any], out: Path, jobs: int
) -> bool:
    """Put the row of every name asked for beside those held, ``jobs`` at once; whether all are there.

    What is held is kept after every row: the same call goes on where Ctrl-C stopped it.
    """
    left = {name: make for name, make in asked.items() if name not in held["sets"]}
    began = time.monotonic()
    pool = ThreadPoolExecutor(jobs)
    try:
        names = {pool.submit(make): name for name, make in left.items()}
        for done, job in enumerate(as_completed(names), 1):
            held["sets"][names[job]] = job.result()
            keep(out, held)
            share = 100 * (len(asked) - len(left) + done) // len(asked)
            rest_min = (time.monotonic() - began) / done * (len(left) - done) / 60.0
            said = f"\r{share:3d} %  {done} of {len(left)}, {rest_min:.0f} min left "
            print(said, end="", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        print("\nstopped; the same command goes on from here", file=sys.stderr)
        return False
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        print(file=sys.stderr)
    return True


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--budget", type=float, default=600.0, help="seconds that a search may take")
    parser.add_argument("--only", default="", help="names of sets, with commas")
    given = parser.parse_args(words)
    sets = sorted(path for path in (given.folder / "sets").glob("*") if path.is_dir())
    sets = [path for path in sets if not given.only or path.name in given.only.split(",")]
    if not sets:
        print(f"error: {given.folder}: holds no sets; draw them with draw.py", file=sys.stderr)
        return 2
    held: dict[str, Any] = {"collection": str(given.folder.resolve()), "budget_s": given.budget, "sets": {}}
    if given.out.exists():
        held["sets"] = json.loads(given.out.read_text(encoding="utf-8"))["sets"]
    command = [sys.executable, "-c", _DIAGNOSE]
    asked = {path.name: partial(judge, path, given.budget, command) for path in sets}
    if not answer(asked, held, given.out, given.jobs):
        return 130
    print(f"{len(held['sets'])} sets in {given.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
