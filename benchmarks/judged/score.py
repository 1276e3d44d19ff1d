"""Score results of ``run.py`` against the truth: tables for reading, numbers with ``--json``.

    python benchmarks/judged/score.py results.json [--truth DIR/truth.json] [--json FILE]

Everything is computed from what report.json says under the contract's keys.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

Row = dict[str, Any]
FOUND = "effect-found"
#: Parameters that are planted at an end of their range, where an interval cannot have its stated coverage.
_ON_AN_EDGE = ("com_share",)


def right_variables(truth: Row) -> set[str]:
    """The variables that count as right."""
    return {truth["variable"], *truth["also"]}


def said_name(row: Row, truth: Row) -> str:
    """The planted name where it is among the effects, else the first effect's, else the verdict."""
    names = [e["name"] for e in row.get("effects", [])]
    if row["verdict"] != FOUND or not names:
        return f"({row['verdict']})"
    return truth["catalogue"] if truth.get("catalogue") in names else names[0]


def variable_right(row: Row, truth: Row) -> bool:
    """Whether the first effect of an effect that was found is traced to the right variable."""
    return (
        row["verdict"] == FOUND
        and bool(row["effects"])
        and row["effects"][0]["traced_to"] in right_variables(truth)
    )


def lead_right(row: Row, truth: Row) -> bool:
    """Whether the first lead is the right variable."""
    return bool(row.get("leads")) and row["leads"][0]["traced_to"] in right_variables(truth)


def grew(row: Row) -> bool:
    """Effect found, and an error on held-out runs that is larger than before."""
    if row["verdict"] != FOUND:
        return False
    keys = ("rmse_position_m", "rmse_heading_rad", "chi")
    return any((row["after"][k] or 0.0) > (row["before"][k] or 0.0) for k in keys)


def false_alarm(row: Row, truth: Row) -> bool:
    """An effect in a set without one; a measurement effect is right where the instrument is at fault."""
    if row["verdict"] != FOUND:
        return False
    return not truth["instrument_at_fault"] or any(e["traced_to"] != "measurement" for e in row["effects"])


def coverage(rows: Sequence[tuple[Row, Row]]) -> Row:
    """How often intervals hold the truth, and |error| over half width, where the name is right."""
    inside, share, sets = [], [], 0
    for row, truth in rows:
        mine = [e for e in row.get("effects", []) if e["name"] == truth["catalogue"]]
        if row["verdict"] != FOUND or not mine:
            continue
        sets += 1
        for key, real in truth["parameters"].items():
            value, low, high = mine[0]["parameters"].get(key, (None, None, None))
            if (
                key in _ON_AN_EDGE or None in (value, low, high) or high <= low
            ):  # not fitted, or given without an interval
                continue
            inside.append(low <= real <= high)
            share.append(abs(value - real) / (0.5 * (high - low)))
    if not inside:
        return {"sets": sets, "intervals": 0}
    return {
        "sets": sets,
        "intervals": len(inside),
        "coverage": round(float(np.mean(inside)), 4),
        "median_error_over_half_width": round(float(np.median(share)), 4),
    }


def scored(results: Row, truth: Row) -> Row:
    """All numbers of the score; shares are given as [right, of]."""
    pairs = [(n, results["sets"][n], t) for n, t in truth["sets"].items() if n in results["sets"]]
    planted = [(n, r, t) for n, r, t in pairs if t["planted"]]
    nulls = [(n, r, t) for n, r, t in pairs if not t["planted"]]
    known = [(r, t) for _, r, t in planted if t["catalogue"]]
    new = [(r, t) for _, r, t in planted if not t["catalogue"]]
    alarms = {kind: [0, 0] for kind in sorted({t["family"] for _, _, t in nulls})}
    for _, r, t in nulls:
        alarms[t["family"]][0] += false_alarm(r, t)
        alarms[t["family"]][1] += 1

    def count(test: Any, of: Sequence[tuple[Row, Row]]) -> list[int]:
        return [sum(bool(test(r, t)) for r, t in of), len(of)]

    return {
        "sets": len(pairs),
        "not_run": len(truth["sets"]) - len(pairs),
        "verdicts": {
            "catalogue": dict(Counter(r["verdict"] for r, _ in known)),
            "inventions": dict(Counter(r["verdict"] for r, _ in new)),
            "nulls": dict(Counter(r["verdict"] for _, r, _ in nulls)),
        },
        "names": count(lambda r, t: said_name(r, t) == t["catalogue"], known),
        "names_alone": count(
            lambda r, t: [e["name"] for e in r.get("effects", [])] == [t["catalogue"]], known
        ),
        "names_or_confused_with": count(
            lambda r, t: any(
                t["catalogue"] in (e["name"], *e["confused_with"]) for e in r.get("effects", [])
            ),
            known,
        ),
        "variables_catalogue": count(variable_right, known),
        "variables_inventions": count(variable_right, new),
        "variable_or_first_lead_inventions": count(
            lambda r, t: variable_right(r, t) or lead_right(r, t), new
        ),
        "variable_or_first_lead_by_family": {
            family: count(
                lambda r, t: variable_right(r, t) or lead_right(r, t),
                [(r, t) for r, t in new if t["family"] == family],
            )
            for family in sorted({t["family"] for _, t in new})
        },
        "first_lead": count(lead_right, [*known, *new]),
        "found_and_error_grew": sorted(n for n, r, _ in pairs if grew(r)),
        "false_alarms": [sum(a for a, _ in alarms.values()), sum(b for _, b in alarms.values())],
        "false_alarms_by_kind": alarms,
        "coverage": coverage(known),
        "seconds": {
            "median": round(float(np.median([r["seconds"] for _, r, _ in pairs])), 1) if pairs else None,
            "largest": max((r["seconds"] for _, r, _ in pairs), default=None),
        },
    }


def table_of_sets(results: Row, truth: Row) -> list[str]:
    """A line a set: truth, answer, held-out error before and after, time."""
    lines = [
        "set     family                  answer                        before → after, mm (chi)             s"
    ]
    for name, t in sorted(
        truth["sets"].items(), key=lambda item: (not item[1]["planted"], item[1]["family"])
    ):
        row = results["sets"].get(name)
        if row is None:
            continue
        if "before" in row and row["before"]["chi"] is not None:
            b, a = row["before"], row["after"]
            mm = [1e3 * side["rmse_position_m"] for side in (b, a)]
            change = f"{mm[0]:8.2f} ({b['chi']:7.2f}) → {mm[1]:8.2f} ({a['chi']:7.2f})"
        else:
            change = row.get("said", "")[:37]
        names = "+".join(e["name"] for e in row.get("effects", [])) or f"({row['verdict']})"
        mark = "!" if grew(row) else " "
        lines.append(f"{name} {mark} {t['family']:22s}  {names:28s}  {change:37s} {row['seconds']:7.1f}")
    return lines


def confusion(results: Row, truth: Row) -> list[str]:
    """What was planted, and what was answered how often."""
    said: dict[str, Counter[str]] = {}
    for name, t in truth["sets"].items():
        if name in results["sets"] and t["planted"]:
            said.setdefault(t["family"], Counter())[said_name(results["sets"][name], t)] += 1
    return [
        f"{family:24s} {', '.join(f'{what} {n}' for what, n in counts.most_common())}"
        for family, counts in sorted(said.items())
    ]


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", type=Path)
    parser.add_argument("--truth", type=Path, help="by default truth.json of the collection that was run")
    parser.add_argument("--json", type=Path)
    given = parser.parse_args(words)
    results = json.loads(given.results.read_text(encoding="utf-8"))
    path = given.truth or Path(results["collection"]) / "truth.json"
    truth = json.loads(path.read_text(encoding="utf-8"))
    score = scored(results, truth)
    print(f"A {truth['kind']} collection: {score['sets']} sets judged, {score['not_run']} not run\n")
    print("What was planted, what was answered")
    print("\n".join(confusion(results, truth)), "\n")
    print("\n".join(table_of_sets(results, truth)), "\n")
    for key, value in score.items():
        if key in ("sets", "not_run"):
            continue
        share = isinstance(value, list) and len(value) == 2 and all(isinstance(v, int) for v in value)
        print(f"{key}: {f'{value[0]} of {value[1]}' if share else value}")
    if given.json:
        given.json.write_text(json.dumps(score, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
