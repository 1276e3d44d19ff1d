"""Run mutated input through every command and count what came of it: ``python -m fuzz --count 20000``.

One warm process forks a child a case, which calls the entry of the command line under a limit of memory and
of processor time.  Cases are drawn from the seed and their number: any one can be run again (``--case N``).
"""

from __future__ import annotations

import argparse
import faulthandler
import gc
import json
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import json_schemas

from fuzz.cases import BUILT_IN, Case, draw
from fuzz.judge import BAD, judge
from fuzz.page import answer_requests

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "fuzz.json"
#: Processor time of a case [s]; how long it may sleep, without any processor time, until it waits for what
#: does not come [s]; memory beside the warm process's [B].  Wall time alone judges nothing: a machine that
#: does other work makes it long.
CPU_S, SLEEP_S, MEMORY_B = 20, 120, 2 << 30
#: Commands that compute little: what they need is loaded at once.
LIGHT = ("import", "explore", "robots", "measure", "export", "other")
MIXED_WORDS = ("ok", "refused", *BAD)


def warm(command: str | None = None) -> None:
    """Import and compile what the commands, or one of them, need: a case then costs tens of milliseconds."""
    from slipmargin_cli.main import status

    good = Path(tempfile.mkdtemp(prefix="fuzz"))
    here = os.getcwd()
    os.chdir(good)
    (good / "w.csv").write_text("x_m,y_m,phi_rad\n0,0,0\n1,0,0.5\n1,1,1\n", encoding="utf-8")
    speeds = ",".join(f"omega{i}_rad_s" for i in range(1, 5))
    (good / "l.csv").write_text(f"t_s,{speeds}\n0,1,1,1,1\n0.1,1,1,1,1\n", encoding="utf-8")
    quiet, loud = os.dup(1), os.dup(2)
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    try:
        for name in BUILT_IN if command not in LIGHT else ():
            surface = "paper" if name.startswith("ohio") else "floor"
            status(["sweep", name, "--surface", surface, "--step", "45"])
            status(
                [
                    "sweep",
                    name,
                    "--surface",
                    surface,
                    "--step",
                    "45",
                    "--method",
                    "clarabel",
                    "--grip",
                    "ellipse",
                ]
            )
            status(
                ["bounds", name, "--surface", surface, "--step", "45", "--plot", "o.svg", "--json", "o.json"]
            )
            status(["polytope", name, "--surface", surface, "--json", "-"])
            status(
                ["plan", name, "w.csv", "--surface", surface, "--out", "t.csv", "--points", "40", "--verify"]
            )
            status(["check", name, "t.csv", "--surface", surface])
            status(["stop", name, "--surface", surface, "--step", "90"])
            status(["export", "c", name, "--surface", surface, "--out", "o.h"])
            status(["simulate", name, "t.csv", "--surface", surface])
            status(["design", name, "--surface", surface, "--vary", "mass_kg=1,2"])
            status(["design", name, "--surface", surface, "--vary", "mass_kg=1,2", "--static"])
            status(["monitor", name, "l.csv", "--surface", surface, "--false-alarms", "0.5"])
        status(["design", "omni4", "mecanum4", "--surface", "floor"])
        if command not in LIGHT:
            _warm_data_sets()
        status(["export", "c", "ohio-kiwi", "--surface", "paper", "--out", "o.h"])
        import numpy as np  # noqa: F401
        import scipy.optimize
        import scipy.spatial  # noqa: F401
        from slipmargin_cli import import_logs, measure  # noqa: F401

        from slipmargin.io import urdf_file  # noqa: F401
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os.dup2(quiet, 1)
        os.dup2(loud, 2)
        os.chdir(here)
        shutil.rmtree(good)
    for name in filter(None, json_schemas.SCHEMAS.values()):
        json_schemas.validator(name)
    gc.collect()
    gc.freeze()


def _warm_data_sets() -> None:
    """Diagnose pulls and runs and train a monitor on them, in the folder that the process is in."""
    from random import Random

    from slipmargin_cli.main import status

    from fuzz.cases import rig_data
    from fuzz.foreign import campaign

    for trials in (0, 3):
        for number in range(40):  # until a draw spoils nothing
            files: dict[str, bytes] = {}
            rig_data(Random(number), files, trials=trials, rows=40)
            _fill(Path(), files)
            if status(["diagnose", "d", "--out", "o", "--budget", "0.2"]) == 0:
                break
    surface = ["--surface", "floor", "--false-alarms", "0.5"]
    status(["monitor", "d/robot.toml", "l.csv", *surface, "--train", "d"])
    words, files = campaign(Random(0))
    _fill(Path(), files)
    status(words)


def _fill(folder: Path, files: dict[str, bytes]) -> None:
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)


def run(case: Case, base: Path | None = None, keep: Path | None = None) -> tuple[str, str, float]:
    """Run a case in a child; its word, what shows it, and its processor time [s]."""
    folder = Path(tempfile.mkdtemp(prefix="case", dir=base))
    work = keep or folder / "w"
    work.mkdir(exist_ok=True, parents=True)
    _fill(work, case.files)
    before = {str(p.relative_to(work)) for p in work.rglob("*") if p.is_file()}
    out, err = folder / "out", folder / "err"
    try:
        child = os.fork()
        if child == 0:
            _child(case.words, work, out, err)
        code, used, why = _wait(child)
        said = [p.read_text(encoding="utf-8", errors="replace") if p.exists() else "" for p in (out, err)]
        if why:
            return why, f"status {code}: {_where(said[1])}", used
        stream = case.words[:1] == ["monitor"] and "-" in case.words
        text = b"".join(case.files.values()).decode("utf-8", errors="replace")
        names = {*case.words, *re.findall(r'"(\w+)"', text)}  # a file or a wheel may be called so
        return *judge(code, *said, work, before, stream=stream, names=names), used
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _child(words: list[str], work: Path, out: Path, err: Path) -> None:
    code = 99
    try:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.setsid()
        for stream, path in ((1, out), (2, err)):
            os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), stream)
        fed = work / "stdin"
        os.dup2(os.open(fed if fed.exists() else os.devnull, os.O_RDONLY), 0)
        os.chdir(work)
        if words[:1] == ["explore"]:
            answer_requests(work)
        pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[0])
        most = pages * resource.getpagesize() + MEMORY_B
        resource.setrlimit(resource.RLIMIT_AS, (most, most))
        resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S + 2))
        resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        faulthandler.register(signal.SIGXCPU, chain=True)  # says where it hangs
        warnings.simplefilter("ignore")
        from slipmargin_cli.main import status

        with json_schemas.checked():  # what does not keep its schema is told as a defect
            code = status(words)
        sys.stdout.flush()
        sys.stderr.flush()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except BaseException:
        import traceback

        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _where(err: str) -> str:
    """The innermost of our own lines in what the fault handler wrote."""
    ours = [line.strip().replace(f"{ROOT}/", "") for line in err.splitlines() if "/slipmargin/" in line]
    return " < ".join(ours[:3]) or err[-200:]


def _wait(child: int) -> tuple[int, float, str]:
    """Exit status, processor time and, where it was ended, why."""
    pause, looked, awake, spent = 0.002, 0.0, time.monotonic(), -1.0
    while True:
        pid, state, use = os.wait4(child, os.WNOHANG)
        if pid:
            break
        now = time.monotonic()
        if now - looked > 1.0:
            looked, (asleep, so_far) = now, _sleeps(child)
            if not asleep or so_far > spent:
                awake, spent = now, so_far
        if now - awake > SLEEP_S:
            os.killpg(child, signal.SIGKILL)
            _, state, use = os.wait4(child, 0)
            return -1, use.ru_utime + use.ru_stime, "hang"
        time.sleep(pause)
        pause = min(0.02, 1.3 * pause)
    used = use.ru_utime + use.ru_stime
    if os.WIFSIGNALED(state):
        return (
            -os.WTERMSIG(state),
            used,
            "hang" if os.WTERMSIG(state) in (signal.SIGXCPU, signal.SIGKILL) else "killed",
        )
    return os.WEXITSTATUS(state), used, ""


def _sleeps(child: int) -> tuple[bool, float]:
    """Whether a process waits for something, and its processor time so far [ticks]."""
    words = Path(f"/proc/{child}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return words[0] == "S", float(words[11]) + float(words[12])


def table(rows: dict[str, dict[str, int]], cpu_s: dict[str, float]) -> list[str]:
    """The counts, and the mean processor time of a case, as lines of text."""
    width = max(len(w) for w in MIXED_WORDS) + 2
    lines = [f"{'command':<12}{'cases':>8}" + "".join(f"{w:>{width}}" for w in MIXED_WORDS) + "  s a case"]
    seconds = cpu_s | {"all": sum(cpu_s.values())}
    total: Counter[str] = Counter()
    for command, counts in [*sorted(rows.items()), ("all", total)]:
        if command != "all":
            total.update(counts)
        cases = sum(counts.values())
        words = "".join(f"{counts.get(w, 0):>{width}}" for w in MIXED_WORDS)
        lines.append(f"{command:<12}{cases:>8}{words}{seconds.get(command, 0.0) / max(1, cases):>10.2f}")
    return lines


def main() -> int:
    """Run the cases that are left, keep the summary, print the table; 1 where anything bad came of one."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--first", type=int, default=0, help="number of the first case")
    words.add_argument("--count", type=int, default=2000, help="number of cases in all")
    words.add_argument("--minutes", type=float, default=1e9, help="stop after this time; run again to go on")
    words.add_argument("--json", type=Path, default=RESULTS, help="summary, from which the next run goes on")
    words.add_argument("--command", help="cases of this command only")
    words.add_argument("--case", type=int, help="run one case in a folder that is kept, and show it")
    asked = words.parse_args()
    warm(asked.command)
    if asked.case is not None:
        return _show(asked.seed, asked.case)
    known: dict[str, Any] = {"seed": asked.seed, "next": asked.first, "counts": {}, "bad": []}
    if asked.json.exists():
        kept = json.loads(asked.json.read_text(encoding="utf-8"))
        known = kept if kept["seed"] == asked.seed else known
    start, base = time.monotonic(), Path("/dev/shm") if Path("/dev/shm").is_dir() else None
    while known["next"] < asked.first + asked.count and time.monotonic() - start < 60.0 * asked.minutes:
        number = known["next"]
        known["next"] += 1
        case = draw(asked.seed, number)
        if asked.command not in (None, case.command):
            continue
        word, shows, used = run(case, base)
        counts = known["counts"].setdefault(case.command, {})
        counts[word] = counts.get(word, 0) + 1
        spent = known.setdefault("cpu_s", {})
        spent[case.command] = round(spent.get(case.command, 0.0) + used, 2)
        if word in BAD:
            known["bad"].append({"case": number, "what": word, "words": case.words[:12], "shows": shows})
            print(
                f"case {number}: {word} ({used:.1f} s): {' '.join(case.words)[:160]!r}: {shows[:300]}",
                flush=True,
            )
        elif used > 8.0:
            print(f"case {number}: slow ({used:.1f} s): {' '.join(case.words)[:200]!r}", flush=True)
        if number % 100 == 99:
            _keep(asked.json, known)
    _keep(asked.json, known)
    print("\n".join(table(known["counts"], known.get("cpu_s", {}))))
    return 1 if known["bad"] else 0


def _keep(path: Path, known: dict[str, Any]) -> None:
    part = path.with_suffix(".part")
    part.write_text(json.dumps(known, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    os.replace(part, path)


def _show(seed: int, number: int) -> int:
    case = draw(seed, number)
    keep = Path(tempfile.gettempdir()) / f"fuzz-{seed}-{number}"
    shutil.rmtree(keep, ignore_errors=True)
    print(f"cd {keep}; slipmargin", *(repr(w) for w in case.words))
    word, shows, used = run(case, keep=keep)
    print(f"{word} ({used:.1f} s): {shows}")
    return 1 if word in BAD else 0


if __name__ == "__main__":
    sys.exit(main())
