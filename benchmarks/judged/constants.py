"""How the judged score moves when a constant of the diagnosis is halved or doubled.

    python benchmarks/judged/constants.py DIR --sets set001,set002 --out answers.json --table constants.json
        [--beside constants.json --most 3]

Each set is diagnosed as it is, and the constants that are read on the way are noted.  Each of these is then
halved and doubled, one at a time (of a share above one half its distance from one), and the set diagnosed
again.  ``--beside`` keeps the rows of an earlier table and asks only for what no set read there; ``--most``
asks each constant of so many of the sets that read it, those that are answered soonest.  A constant that none
reads moves no answer.  A set is right where its first effect is the planted one, or traced to its variable
where no catalogue entry writes it, and where a set without an effect is quiet.  Sets looked at here are
development sets.  What is known is kept after every diagnosis: a run that was stopped goes on where it was.
"""

from __future__ import annotations

import argparse
import inspect
import json
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any, final

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from judged.run import answer, judge
from judged.score import FOUND, false_alarm, grew, said_name, variable_right
from slipmargin.data import settings as of_data
from slipmargin.diagnosis import settings as of_search

Row = dict[str, Any]
#: Where the constants of each group stand.
PLACES = {"data": (of_data, "SETTINGS"), "diagnosis": (of_search, "SETTINGS"), "pulls": (of_search, "PULLS")}
GROUPS = {group: getattr(module, name) for group, (module, name) in PLACES.items()}
FACTORS = (0.5, 2.0)
#: What each process runs: the constant asked for is changed before anything else has been imported.
_DIAGNOSE = """
import json, sys
sys.path.insert(0, sys.argv[1])
from judged.constants import watched
read = watched(sys.argv[2])
import slipmargin as sm
from slipmargin.errors import InputError
try:
    report = sm.diagnose(sys.argv[3], budget_s=float(sys.argv[4])).to_json()
except InputError as fault:
    print(f"error: {fault}", file=sys.stderr)
    sys.exit(2)
print(json.dumps(json.loads(report) | {"read": sorted(read)}))
"""


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Constant:
    """A constant that decides: ``group`` and ``name``, and what its line in the source says of it."""

    group: str
    name: str
    unit: str
    reason: str

    @property
    def value(self) -> Any:
        """What it is."""
        return getattr(GROUPS[self.group], self.name)

    @property
    def shown(self) -> str:
        """The value as a reader sees it."""
        each = self.value if isinstance(self.value, tuple) else (self.value,)
        return ", ".join(f"{one:g}" if isinstance(one, float) else str(one) for one in each)

    def __str__(self) -> str:
        return f"{self.group}.{self.name}"


def documented(group: str) -> list[Constant]:
    """The constants of a group in their order; each follows its comment ``#: [unit] reason``."""
    found, said = [], []
    for line in inspect.getsource(type(GROUPS[group])).splitlines():
        words = line.strip()
        if words.startswith("#: "):
            said.append(words[3:])
        elif said:
            unit, _, reason = " ".join(said).removeprefix("[").partition("] ")
            found.append(Constant(group=group, name=words.partition(":")[0], unit=unit, reason=reason))
            said = []
    return found


CONSTANTS = [constant for group in GROUPS for constant in documented(group)]


def changed(value: Any, factor: float) -> Any:
    """A constant times ``factor``, or a large share's distance from one; None where that changes nothing.

    Of several numbers it is each.
    """
    if isinstance(value, tuple):
        return tuple(changed(one, factor) for one in value)
    if isinstance(value, int):
        other = max(1, round(value * factor))
        return None if other == value else other
    return 1.0 - (1.0 - value) * factor if 0.5 < value < 1.0 else value * factor


def changes(constant: Constant) -> list[str]:
    """The changes of a constant, ``"data.piece_s 0.5"``."""
    return [f"{constant} {f:g}" for f in FACTORS if changed(constant.value, f) is not None]


class Watched:
    """Settings that note which of them are read."""

    def __init__(self, group: str, values: dict[str, Any], read: set[str]) -> None:
        self._group, self._values, self._read = group, values, read

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._values:  # what follows from others reads these
            return getattr(type(GROUPS[self._group]), name).fget(self)
        self._read.add(f"{self._group}.{name}")
        return self._values[name]


def watched(change: str) -> set[str]:
    """Put settings that are watched in place of all, one changed: ``"data.piece_s 0.5"``; what is read."""
    read: set[str] = set()
    for group, (module, place) in PLACES.items():
        settings = GROUPS[group]
        values = {f.name: getattr(settings, f.name) for f in fields(settings)}
        constant, _, factor = change.partition(" ")
        where, _, name = constant.partition(".")
        if where == group:
            values[name] = changed(values[name], float(factor))
        setattr(module, place, Watched(group, values, read))
    return read


def right(row: Row, truth: Row) -> bool:
    """Whether a set was answered as it should be."""
    if not truth["planted"]:
        return not false_alarm(row, truth)
    if grew(row):
        return False
    if truth.get("catalogue"):
        return said_name(row, truth) == truth["catalogue"]
    return variable_right(row, truth)


def table(held: Row, truth: Row) -> list[Row]:
    """A row for each constant and change: sets in which it is read, and what becomes of them."""
    plain = {
        name: row for key, row in held["sets"].items() for name, _, how in [key.partition(":")] if not how
    }
    rows: dict[str, Row] = {}
    for key, row in sorted(held["sets"].items()):
        name, _, how = key.partition(":")
        if not how or name not in plain:
            continue
        before = plain[name]
        out = rows.setdefault(how, {"constant": how, "sets": 0, "lost": [], "gained": [], "log_error": []})
        out["sets"] += 1
        was, now = right(before, truth[name]), right(row, truth[name])
        if was != now:
            out["gained" if now else "lost"].append(name)
        chis = [(r.get("after") or {}).get("chi") for r in (before, row)]
        if all(r["verdict"] == FOUND for r in (before, row)) and all(chis):
            out["log_error"].append(math.log(chis[1] / chis[0]))
    for out in rows.values():
        logs = out.pop("log_error")
        out["worst_chi_factor"] = round(math.exp(max(logs)), 3) if logs else None
    return list(rows.values())


def asked(plain: dict[str, Row], known: set[str], most: int) -> list[tuple[str, str]]:
    """Sets and changes to ask for: of each constant not ``known`` the ``most`` soonest answered sets."""
    soonest = sorted(plain, key=lambda name: (plain[name]["seconds"], name))
    found = []
    for constant in CONSTANTS:
        reads = [name for name in soonest if str(constant) in plain[name].get("read", ())]
        found += [(name, c) for c in changes(constant) if c not in known for name in reads[:most]]
    return found


def unread(plain: dict[str, Row], earlier: Sequence[Row]) -> list[Row]:
    """A row for each change of a constant that none of the sets reads, nor one before: it moves no answer."""
    read = {name for row in plain.values() for name in row.get("read", ())}
    before = {row["constant"]: row for row in earlier}
    none = {"sets": 0, "lost": [], "gained": [], "worst_chi_factor": None}
    found = []
    for constant in CONSTANTS:
        for change in changes(constant) if str(constant) not in read else ():
            old = before.get(change, none)
            if not old["sets"]:
                found.append(
                    {"constant": change} | none | {"unread_in": len(plain) + old.get("unread_in", 0)}
                )
    return found


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, metavar="DIR")
    parser.add_argument("--sets", default="", help="names of sets, with commas; all where not given")
    parser.add_argument("--out", type=Path, required=True, help="keeps every answer")
    parser.add_argument("--table", type=Path, required=True, help="what becomes of them")
    parser.add_argument("--beside", type=Path, help="an earlier table, whose rows are kept")
    parser.add_argument("--most", type=int, default=sys.maxsize, help="sets to ask each constant of")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--budget", type=float, default=120.0, help="seconds that a search may take")
    given = parser.parse_args(words)
    sets = sorted(path for path in (given.folder / "sets").glob("*") if path.is_dir())
    sets = [path for path in sets if not given.sets or path.name in given.sets.split(",")]
    held: Row = {"budget_s": given.budget, "sets": {}}
    if given.out.exists():
        held["sets"] = json.loads(given.out.read_text(encoding="utf-8"))["sets"]
    command = [sys.executable, "-c", _DIAGNOSE, str(Path(__file__).resolve().parents[1])]
    plain = {f"{path.name}:": partial(judge, path, given.budget, [*command, ""], ("read",)) for path in sets}
    if not answer(plain, held, given.out, given.jobs):
        return 130
    for name in (path.name for path in sets):
        if held["sets"][f"{name}:"]["verdict"] == "failed":
            print(f"error: {name} failed: {held['sets'][f'{name}:'].get('said')}", file=sys.stderr)
            return 1
    earlier: Row = {"collections": [], "table": []}
    if given.beside:
        earlier = json.loads(given.beside.read_text(encoding="utf-8"))
    known = {row["constant"] for row in earlier["table"] if row["sets"]}
    paths = {path.name: path for path in sets}
    read = {name: held["sets"][f"{name}:"] for name in paths}
    other = {
        f"{name}:{change}": partial(judge, paths[name], given.budget, [*command, change])
        for name, change in asked(read, known, given.most)
    }
    if not answer(other, held, given.out, given.jobs):
        return 130
    truth = json.loads((given.folder / "truth.json").read_text(encoding="utf-8"))
    rows = [row for row in table(held, truth["sets"]) if row["constant"] not in known]
    rows += unread(read, earlier["table"])
    names = sorted({key.partition(":")[0] for key in other})
    own = {"what": truth.get("what", "judged sets"), "seed": truth["seed"], "names": names}
    collections = [*earlier["collections"], own]
    there = {change for constant in CONSTANTS for change in changes(constant)}
    kept = [row for row in earlier["table"] if row["constant"] in there & known] + rows
    lines = ",\n".join(f" {json.dumps(row)}" for row in sorted(kept, key=lambda row: row["constant"]))
    head = f'{{"collections": {json.dumps(collections)},\n"table": [\n'
    given.table.write_text(f"{head}{lines}\n]}}\n", encoding="utf-8")
    for row in sorted(rows, key=lambda row: -len(row["lost"])):
        lost, gained = len(row["lost"]), len(row["gained"])
        print(f"{row['constant']:40s} read in {row['sets']:2d}, lost {lost}, gained {gained}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
