"""Kill long commands with signal 9 at random moments: ``python tests/house/killed.py --count 100``.

After each kill every output is whole, as it was before, or absent; a second run then ends with the same
bytes as a run that nobody disturbed, and leaves nothing else behind.  Half of the moments
are spread evenly over the run; the others fall within milliseconds of the first file that appears.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "benchmarks" / "results" / "killed.json"
#: What must not be found, each counted in a column of its own.
FAULTS = ("half a file", "not resumed", "other bytes", "left behind")
#: What is counted of each command.
COUNTED = ("killed", "had ended", *FAULTS)
#: After a file has appeared the kill comes within this time [s].
SOON_S = 0.03
#: A run that had ended before the kill is no kill; another is tried, up to so many for each that is wanted.
TRIES = 4


@dataclass(frozen=True)
class Job:
    """A command line, what it reads (path → bytes), and how often it is drawn."""

    words: tuple[str, ...]
    files: dict[str, bytes] = field(default_factory=dict)
    share: float = 1.0
    #: It finds these outputs of an earlier run, where it must not be new.
    replaces: bool = True


def jobs() -> dict[str, Job]:
    """The long commands, each with every kind of file that it writes."""
    ways = b"x_m,y_m,phi_rad\n0,0,0\n1,0,0.5\n1,1,1\n0,1,2\n"
    log = "".join(
        f"{10 * k},{1e3 * math.sin(0.01 * k):.3f},{1e3 * math.cos(0.01 * k):.3f},{0.1 * k:.3f},"
        + ",".join(f"{30.0 * math.sin(0.02 * k + i):.3f}" for i in range(3)) + "\n"
        for k in range(4000)
    )  # fmt: skip
    told = "t_s,omega1_rad_s,omega2_rad_s,omega3_rad_s\n" + "".join(
        f"{0.1 * k:.1f}," + ",".join(f"{5.0 * math.sin(k + i):.4f}" for i in range(3)) + "\n"
        for k in range(60)
    )
    columns = ["--time", "t:ms", "--x", "x:mm", "--y", "y:mm", "--heading", "h:deg"]
    columns += [word for i in (1, 2, 3) for word in ("--wheel", f"w{i}:rpm")]
    columns += ["--robot", "ohio-kiwi", "--surface", "paper"]
    csv = {"l.csv": ("t,x,y,h,w1,w2,w3\n" + log).encode()}
    kiwi, omni = ("ohio-kiwi", "--surface", "paper"), ("omni4", "--surface", "floor")
    two = ("--out", "o.csv", "--json", "o.json")
    most = (*two, "--report", "o.html")
    pulls, runs = _data_set("d", runs=False), _data_set("d", runs=True)
    return {
        "sweep": Job(("sweep", *kiwi, "--to", "360", "--step", "0.2", *two, "--plot", "o.svg")),
        "polytope": Job(("polytope", *omni, "--json", "o.json")),
        "bounds": Job(("bounds", *omni, "--robust", "--export", "json", "o.rec", *most)),
        "plan": Job(
            ("plan", *omni[:1], "w.csv", *omni[1:], "--verify", "--export", "choreo", "o.traj", *two),
            {"w.csv": ways},
        ),
        "check": Job(("check", *kiwi[:1], "t.csv", *kiwi[1:], *two), {"t.csv": _trajectory().encode()}),
        "simulate": Job(("simulate", *kiwi[:1], "c.csv", *kiwi[1:], *two), {"c.csv": told.encode()}),
        "stop": Job(("stop", *kiwi, "--step", "45", *most)),
        "design": Job(("design", *kiwi, "--vary", "delta_deg=0:60:4", *two), share=2.0),
        "design several": Job(("design", "omni4", "mecanum4", "--surface", "floor", *two)),
        "import": Job(("import", "csv", "l.csv", "--out", "o", *columns), csv, replaces=False),
        "import --force": Job(("import", "csv", "l.csv", "--out", "o", "--force", *columns), csv),
        "measure": Job(
            ("measure", "p.csv", *kiwi, "--json", "o.json"),
            {"p.csv": _pulls().encode()},
        ),
        "monitor": Job(
            ("monitor", *kiwi[:1], "s.csv", *kiwi[1:], "--false-alarms", "0.5", *two),
            {"s.csv": _stream().encode()},
        ),
        "export c": Job(("export", "c", *omni, "--out", "o.h", "--json", "o.json")),
        "reproduce": Job(("reproduce", "--out", "o", "--json", "o.json"), share=0.4),
        "diagnose pulls": Job(("diagnose", "d", "--out", "o", "--json", "o.json"), pulls, share=0.2),
        "diagnose runs": Job(("diagnose", "d", "--out", "o", "--json", "o.json"), runs, share=0.2),
        "diagnose campaign": Job(
            ("diagnose", "campaign.toml", "--out", "o", "--json", "o.json"),
            {"campaign.toml": CAMPAIGN, **runs, **_data_set("e", runs=True)},
            share=0.2,
        ),
    }


CAMPAIGN = b"""schema = 1
name = "both"
[[data_set]]
path = "d"
[[data_set]]
path = "e"
floor = "another"
"""


def _data_set(place: str, *, runs: bool) -> dict[str, bytes]:
    """Pulls alone, or three short runs: a diagnosis of these takes seconds."""
    folder = ROOT / "tests" / "data" / "rig" / "a-null"
    files = {f"{place}/{name}": (folder / name).read_bytes() for name in ("robot.toml", "dataset.toml")}
    if not runs:
        lines = (folder / "pulls.csv").read_text(encoding="utf-8").split("\n")
        return files | {f"{place}/pulls.csv": ("\n".join(lines[:1] + lines[1:49:6]) + "\n").encode()}
    for file in sorted((folder / "trials").glob("*.csv"))[:3]:
        lines = file.read_text(encoding="utf-8").split("\n")[:40]
        files[f"{place}/trials/{file.name}"] = ("\n".join(lines) + "\n").encode()
    return files


def _trajectory() -> str:
    rows = (
        (0.02 * k, 0.3 * math.sin(0.02 * k), 0.2 * math.cos(0.03 * k), 0.2 * math.sin(0.01 * k))
        for k in range(500)
    )
    return "t_s,x_m,y_m,phi_rad\n" + "".join(",".join(f"{v:.6f}" for v in row) + "\n" for row in rows)


def _pulls() -> str:
    return "phi_rad,force_N\n" + "".join(
        f"{math.radians(a):.5f},{2.0 + 0.3 * math.sin(3.0 * math.radians(a)) + 0.02 * k:.3f}\n"
        for a in range(0, 360, 15)
        for k in range(3)
    )


def _stream() -> str:
    names = ["t_s", *(f"omega{i}_rad_s" for i in (1, 2, 3)), "gyro_rad_s"]
    rows = (
        ",".join([f"{0.01 * k:.2f}", *(f"{3.0 * math.sin(0.02 * k + i):.5f}" for i in range(4))])
        for k in range(4000)
    )
    return "\n".join([",".join(names), *rows]) + "\n"


def run(words: tuple[str, ...], folder: Path) -> int:
    """The command in this process, which is warm then; its exit status."""
    from slipmargin_cli.main import status

    here = os.getcwd()
    os.chdir(folder)
    kept = os.dup(1), os.dup(2)
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    os.dup2(null, 2)
    try:
        return status(list(words))
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for stream, handle in zip((1, 2), kept, strict=True):
            os.dup2(handle, stream)
            os.close(handle)
        os.close(null)
        os.chdir(here)


def started(words: tuple[str, ...], folder: Path) -> int:
    """The command in a child with a process group of its own; its number."""
    child = os.fork()
    if child == 0:
        code = 99
        try:
            os.setsid()
            code = run(words, folder)
        finally:
            os._exit(code)
    return child


def names(folder: Path) -> set[str]:
    """What is in a folder, while a command makes and removes files there."""
    found = ((Path(base), name) for base, folders, files in os.walk(folder) for name in (*folders, *files))
    return {str((base / name).relative_to(folder)) for base, name in found}


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def fill(folder: Path, files: dict[str, bytes]) -> None:
    """Write files into a folder that is made, the folders above them included."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)


def until_killed(child: int, folder: Path, before: set[str], moment: float, *, seen: bool) -> bool:
    """Kill a child ``moment`` seconds after its start, or after it makes a file; whether it still ran."""
    start, there = time.monotonic(), before
    while True:
        if os.waitpid(child, os.WNOHANG)[0]:
            return False
        if seen and there == before:
            there = names(folder)
            start = start if there == before else time.monotonic()
        elif time.monotonic() - start >= moment:
            try:
                os.killpg(child, signal.SIGKILL)
            except ProcessLookupError:  # so early that it has no group of its own yet
                os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return True
        else:
            time.sleep(0.0005)


def faults(job: Job, good: dict[str, bytes], old: dict[str, bytes], folder: Path) -> list[str]:
    """What a killed run and the one after it did wrong."""
    found = []
    for name, data in contents(folder).items():
        if name in job.files or ".part/" in f"{name}/":
            continue
        if ".work/" in name:
            try:
                json.loads(data)
            except ValueError:
                found.append(FAULTS[0])
        elif data not in (good.get(name), old.get(name)):
            found.append(FAULTS[0])
    gone = [name for name in old if not (folder / name).exists()]
    if gone and not any(p.name == "old" for p in folder.rglob("old")):
        found.append(FAULTS[0])
    done = not job.replaces and all((folder / name).is_file() for name in good)
    if _ended(started(job.words, folder)) != (2 if done else 0):  # a data set that is there is not replaced
        return [*found, FAULTS[1]]
    after = contents(folder)
    if any(after.get(name) != data for name, data in good.items()):
        found.append(FAULTS[2])
    there = names(folder)
    known = {str(p) for name in (*good, *job.files) for p in (Path(name), *Path(name).parents)}
    return [*found, *([FAULTS[3]] if there - known else [])]


def _ended(child: int) -> int:
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def kill_all(count: int, seed: int, only: list[str]) -> Iterator[tuple[str, dict[str, float]]]:
    """Commands, how often each was killed and what went wrong; of all together ``count`` kills."""
    known = {name: job for name, job in jobs().items() if not only or name in only}
    base = Path("/dev/shm") if Path("/dev/shm").is_dir() else None
    whole = sum(job.share for job in jobs().values())
    for name, job in known.items():
        drawn, counts = random.Random(f"{seed}/{name}"), Counter(dict.fromkeys(COUNTED, 0))
        place = Path(tempfile.mkdtemp(prefix="killed", dir=base))
        try:
            for folder in ("whole", "again"):
                fill(place / folder, job.files)
            if run(job.words, place / "whole"):  # compiles and imports: the next one is timed
                raise SystemExit(f"{name}: {' '.join(job.words)} fails")
            begin = time.monotonic()
            if _ended(started(job.words, place / "again")):
                raise SystemExit(f"{name}: {' '.join(job.words)} fails in a child")
            lasts = time.monotonic() - begin
            good = {k: v for k, v in contents(place / "whole").items() if k not in job.files}
            if good != {k: v for k, v in contents(place / "again").items() if k not in job.files}:
                raise SystemExit(f"{name}: two runs that nobody disturbed differ")
            wanted = math.ceil(count * job.share / whole)
            for k in range(TRIES * wanted):
                if counts["killed"] == wanted:
                    break
                one = place / "killed"
                fill(one, job.files)
                old = {n: b"as it was " + d[:20] for n, d in good.items()} if job.replaces and k % 3 else {}
                if name == "import --force" and old:
                    old |= {"o/dataset.toml": good["o/dataset.toml"]}
                fill(one, old)
                before = names(one)
                seen = bool(k % 2)
                moment, begin = drawn.uniform(0.0, SOON_S if seen else lasts), time.monotonic()
                alive = until_killed(started(job.words, one), one, before, moment, seen=seen)
                counts["killed" if alive else "had ended"] += 1
                if not alive:  # the machine was busier when it was timed
                    lasts = min(lasts, time.monotonic() - begin)
                counts.update(faults(job, good, old, one))
                shutil.rmtree(one)
        finally:
            shutil.rmtree(place, ignore_errors=True)
        yield name, dict(counts) | {"undisturbed_s": round(lasts, 2)}


def row(name: str, counts: Mapping[str, float]) -> str:
    """A line of the printed table."""
    return f"{name:<19}" + "".join(f"{counts.get(w, 0):>14}" for w in COUNTED)


def main() -> int:
    """Kill, print the table, keep it; 1 where anything was wrong."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("--count", type=int, default=100, help="kills of all commands together")
    words.add_argument("--seed", type=int, default=1)
    words.add_argument(
        "--only", default="", help="commands, with commas between; what is kept of others stays"
    )
    words.add_argument("--json", type=Path, default=RESULTS, help="where the table is kept")
    asked = words.parse_args()
    print(f"{'command':<19}" + "".join(f"{w:>14}" for w in COUNTED), flush=True)
    kept = json.loads(asked.json.read_text(encoding="utf-8")) if asked.json.exists() else {}
    table = kept["commands"] if asked.only and kept.get("seed") == asked.seed else {}
    total: Counter[str] = Counter()
    for name, found in kill_all(asked.count, asked.seed, [w for w in asked.only.split(",") if w]):
        table[name] = found
        print(row(name, found), flush=True)
        total = Counter()
        for counts in table.values():
            total.update({word: int(count) for word, count in counts.items() if word != "undisturbed_s"})
        text = json.dumps({"seed": asked.seed, "commands": table, "all": dict(total)}, indent=1)
        asked.json.write_text(text + "\n", encoding="utf-8")
    print(row("all", total))
    return 1 if any(total[fault] for fault in FAULTS) else 0


if __name__ == "__main__":
    sys.exit(main())
