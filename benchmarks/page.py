"""Make docs/benchmarks.md and docs/constants.md from texts here and from benchmarks/results.

    python benchmarks/page.py [benchmarks | constants]    print both, or one
    python benchmarks/page.py --write                     write both

A test compares the pages with this script's output, so a figure that is measured again must be written again.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parent))

from judged.constants import CONSTANTS, FACTORS
from judged.families import SINCE

HERE = Path(__file__).resolve().parent
DOCS = HERE.parent / "docs"

#: The real robot's models: how their name in results/robotino.json begins → what a reader sees.
ROBOTINO_ROWS = {
    "paper's model": "the paper's model, eq. (11), calibrated on the table",
    "the same, scale": "the same, scale refitted on the carpet: the honest baseline",
    "+ slip_ratio_friction": "+ `slip_ratio_friction`, scale of the table again",
    "+ its own": "+ its own constants across the wheels (drag of the rollers)",
    "+ wheel_loads": "+ `wheel_loads`",
    "+ trailing_load": "+ `trailing_load`",
    "slipmargin diagnose": "`slipmargin diagnose`, left alone with the fitted runs",
}

#: A chi after the correction that moves by less than this share is called the same [1].
CHI_MOVES = 0.02


def results(name: str) -> Any:
    """The content of a file of benchmarks/results."""
    return json.loads((HERE / "results" / name).read_text(encoding="utf-8"))


def duration(seconds: float) -> str:
    """A duration in words, with two or three digits."""
    for unit, size in (("min", 60.0), ("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= (120.0 if unit == "min" else size):
            value = seconds / size
            return f"{value:.0f} {unit}" if value >= 100 else f"{value:.2g} {unit}"
    return f"{seconds:.1e} s"


def table(head: list[str], rows: list[list[str]]) -> list[str]:
    """A Markdown table."""
    return [f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head), *rows)]


def speed() -> list[str]:
    """What is fast, beside the best other way in the same run."""
    statics, run, design = results("statics.json"), results("simulation.json"), results("design.json")
    paths = next(row for row in results("paths.json") if row["set"] == "speed")
    headings, sets = statics["sweep"], statics["zonotope"]
    whole = "us_per_sweep"
    rows = [
        (
            "limits at 721 headings, by facets",
            headings["facets, from the model"][whole] / 1e6,
            "cvxpy, a new problem for each heading",
            headings["cvxpy, new problem each"][whole] / 1e6,
        ),
        (
            "limits at 721 headings, by Clarabel, updated in place",
            headings["Clarabel, updated"][whole] / 1e6,
            "SciPy HiGHS, one problem after the other",
            headings["SciPy HiGHS"][whole] / 1e6,
        ),
        (
            "facets and vertices of a wrench set with 20 generators",
            sets["zonotope, 20 generators"]["ms"] / 1e3,
            "pycapacity, facets only",
            sets["pycapacity hyper-plane shifting (facets only), 20"]["ms"] / 1e3,
        ),
        (
            f"wheel-angle study, {design['points']:,.0f} limits",
            design["study_median_s"],
            "cvxpy, extrapolated",
            design["naive_extrapolated_s"],
        ),
        (
            f"the paper's 3.5 s run, error {run['ours_rtol_1e-06_error']:.0e} m",
            run["ours_rtol_1e-06_s"],
            f"SciPy LSODA, compiled right-hand side, error {run['lsoda_compiled_10ms_error']:.0e} m",
            run["lsoda_compiled_10ms_s"],
        ),
        (
            "time-optimal profile, 1000 points × 22 facets",
            paths["profile_1000x22_ms"] / 1e3,
            "toppra",
            paths["toppra_ms"] / 1e3,
        ),
    ]
    return [
        *table(
            ["what", "slipmargin", "other way, same run", "ratio"],
            [
                [what, duration(ours), f"{duration(theirs)} ({other})", f"{theirs / ours:,.0f} ×"]
                for what, ours, other, theirs in rows
            ],
        ),
        "",
        f"The first simulation after installation took {run['first_call_s']:.1f} s, compilation included;",
        f"later ones start in {run['cached_call_s']:.1f} s.  Acceleration limits for 360 headings take",
        f"{paths['bounds_360_ms']:.1f} ms for three wheels, {paths['bounds_360_four_wheels_ms']:.1f} ms for",
        "four, whose forces are found by following each heading's motion.",
    ]


def weight() -> list[str]:
    """Size of what `make install` brings."""
    found = results("environment.json")
    largest = ", ".join(f"{name} {size:.0f} MB" for name, size in list(found["largest_MB"].items())[:4])
    return [
        f"The package and the {found['packages'] - 1} others that it needs take {found['total_MB']} MB "
        f"(Python {found['python'].rpartition('.')[0]}).",
        f"The largest are {largest}; llvmlite is the compiler of the simulator and the limits.",
        f"cvxpy and the solvers that it brings are {found['by_cvxpy_MB']} MB of that.",
    ]


def worth() -> list[str]:
    """What the limits are worth, by two judges that share no code with them."""
    rollers, proof, few_rollers = (results(f"{n}.json") for n in ("rollers", "path_proof", "few_rollers"))
    worst = few_rollers["worst_creep_per_distance"]
    few, creeps = ", ".join(worst), ", ".join(f"{100.0 * found['0.9']:.2g}" for found in worst.values())
    starts = [row["slips"] for row in rollers if "slips" in row]
    hold = sum(not s["0.95"] for s in starts)
    slip = sum(s["1.05"] for s in starts)
    loads = max(
        row[floor]["worst_percent"] for row in rollers if "level" in row for floor in ("level", "slope")
    )
    plans = [row for row in rollers if "planned_use" in row]
    driven = [row for row in proof if row.get("duration_s")]
    named = sum(bool(row["lost"]) and bool(row["at_named_wheel"]) for row in driven)
    motors = [
        p for p in next(r for r in results("paths.json") if r["set"] == "motors").values() if p != "motors"
    ]
    longest = max(path["longest_over_finest"] for path in motors)
    return table(
        ["claim", "judge", "result"],
        [
            [
                "a start from rest holds at 0.95 of our limit and slips at 1.05",
                "rigid-body engine with real rollers (MuJoCo), three robots with 36 rollers a wheel and "
                "disc-strip grip, in 12 directions",
                f"{hold} of {len(starts)} hold, {slip} of {len(starts)} slip",
            ],
            [
                f"how far mecanum wheels of {few} rollers creep at 0.9 of our limit",
                "the same engine",
                f"{creeps} % of the way; above {100.0 * few_rollers['slips_above']:g} % counts as slip",
            ],
            [
                "mean wheel loads while accelerating, level and on a 4° slope",
                "the same engine",
                f"within {loads:.1f} % of m g / N",
            ],
            [
                "plans at 0.9 of the grip",
                "the same engine",
                f"{len(plans)} plans; fastest slip {max(p['fastest_slip_mm_s'] for p in plans):.1f} mm/s, "
                f"end at most {max(p['end_off_mm'] for p in plans):.1f} mm off",
            ],
            [
                "a planned motion, driven open loop, uses no more grip than planned",
                f"the simulator, {len(driven)} drawn robots",
                f"at most {max(row['excess'] for row in driven):.4f} of the grip more",
            ],
            [
                "the same motions at 105 % slip, at the wheel that the plan names",
                "the same robots",
                f"{named} of {len(driven)}",
            ],
            [
                "a plan's time hangs little on its grid, motors at their torque–speed line too",
                f"the finest of six grids, {len(motors)} paths",
                f"25 to 800 points: at most {100.0 * (longest - 1.0):.1f} % longer",
            ],
        ],
    )


def synthetic() -> list[str]:
    """The eight synthetic sets."""
    return table(
        ["set", "planted", "found", "position error before → after [mm]", "χ before → after"],
        [
            [
                row["set"],
                "nothing"
                if row["wanted"] == "none"
                else ", ".join(f"`{n}`" for n in row["wanted"].split("+")),
                ", ".join(f"`{name}`" for name in row["found"]) or "nothing",
                f"{1e3 * row['rmse_before_m']:.2f} → {1e3 * row['rmse_after_m']:.2f}",
                f"{row['chi_before']:.3g} → {row['chi_after']:.3g}",
            ]
            for row in results("diagnosis-synthetic.json")
        ],
    )


def rig() -> list[str]:
    """The rig with real rollers."""

    def moved(pair: list[float]) -> str:
        return f"{pair[0]:.3g} → {pair[1]:.3g}"

    return table(
        [
            "set",
            "found",
            "loads, shares of the weight",
            "χ before → after",
            "pulls, measured − predicted (rms)",
        ],
        [
            [
                row["set"],
                ", ".join(f"`{name}`" for name in row["found"]) or row["verdict"],
                ", ".join(f"{share:.3f}" for share in row["load_shares"]),
                moved(row["chi"]),
                f"{moved(row['pulls_rms_N'])} N",
            ]
            for row in results("rig.json")
        ],
    )


def answered(answer: dict[str, Any]) -> str:
    """What a diagnosis names, and what it cannot tell from that."""
    names = " + ".join(f"`{label}`" for label in answer["found"]) or answer["verdict"]
    others = [f"`{label}`" for label in answer["confused_with"]]
    return names + (f", or {', '.join(others)}" if others else "")


def next_run() -> list[str]:
    """What three proposed runs decide that three more standard runs do not."""

    def noises(chi_square: float) -> str:
        size = max(0.0, chi_square) ** 0.5
        return f"{size:.2g}" if size < 10.0 else f"{size:,.0f}"

    return table(
        [
            "planted",
            "ten runs",
            "after them",
            "with three proposed runs",
            "with three more standard runs",
            "noises",
        ],
        [
            [
                ", ".join(f"`{name}`" for name in row["truth"]),
                row["standard"],
                answered(row["before"]),
                answered(row["after"]),
                answered(row["after_standard"]),
                f"{noises(row['today'])} → {noises(row['expected'])}",
            ]
            for row in results("next_run.json")
        ],
    )


def judged() -> list[str]:
    """The collections that were each drawn and run once."""

    def share(right: int, of: int) -> str:
        return f"{right} of {of}" if of else "–"

    rows = []
    for found in results("judged.json"):
        of_family = found["variable_or_first_lead_by_family"]
        since, never = (
            [sum(n[i] for f, n in of_family.items() if (f in SINCE) is known) for i in (0, 1)]
            for known in (True, False)
        )
        inside = found["coverage"]
        rows.append(
            [
                f"{found['run_once_on']}, {found['test']}",
                share(*found["names"]),
                share(*found["variables_catalogue"]),
                share(*since),
                share(*never),
                f"{len(found['found_and_error_grew'])} of {found['sets']}",
                share(*found["false_alarms"]),
                f"{100.0 * inside['coverage']:.0f} % of {inside['intervals']}",
                f"{inside['median_error_over_half_width']:.2f}",
                f"{found['seconds']['median']:.0f} s, {found['seconds']['largest']:.0f} s",
            ]
        )
    return table(
        [
            "test",
            "names of the catalogue",
            "their variables",
            "inventions with an equation since: variable or first lead",
            "other inventions: variable or first lead",
            "claimed although an error grew",
            "false alarms",
            "intervals that hold the truth",
            "error over half width",
            "median, longest",
        ],
        rows,
    )


def robotino() -> list[str]:
    """The real robot."""
    found = results("robotino.json")
    rows = []
    for row in found["rows"]:
        errors = row["errors"]
        shares = [f"{100 * errors[part]['displacement']:.2g} %" for part in ("fitted", "headings", "speed")]
        label = next(text for key, text in ROBOTINO_ROWS.items() if row["model"].startswith(key))
        held = errors["held out"]
        rows.append([label, *shares, f"{100 * held['displacement']:.2f} %", f"{held['heading_deg']:.1f}°"])
    return table(["model", "fitted", "other headings", "0.2 m/s", "held out", "heading"], rows)


def constants(group: str) -> list[str]:
    """Every constant of a group: its value, its unit, its reason, and what halving and doubling changes."""
    found = {row["constant"]: row for row in results("constants.json")["table"]}
    rows = []
    for constant in CONSTANTS:
        if constant.group != group:
            continue
        moved = [effect_of(found.get(f"{constant} {factor:g}")) for factor in FACTORS]
        rows.append([f"`{constant.name}`", constant.shown, constant.unit, constant.reason, *moved])
    return table(["constant", "value", "unit", "what for", "halved", "doubled"], rows)


def effect_of(row: dict[str, Any] | None) -> str:
    """What a changed constant does to the answers of the development sets."""
    if row is None:
        return "not asked"
    if not row["sets"]:
        return f"not read (in {row['unread_in']})"
    said = [f"{len(row[what])} {what}" for what in ("lost", "gained") if row[what]]
    worst = row["worst_chi_factor"]
    if worst is not None and abs(worst - 1.0) >= CHI_MOVES:
        said.append(f"chi × {worst:.2f}")
    return f"{', '.join(said) or 'same'} (of {row['sets']})"


def development_sets() -> list[str]:
    """Which sets the constants were changed on."""
    found: dict[tuple[str, int], set[str]] = {}
    for one in results("constants.json")["collections"]:
        found.setdefault((one["what"], one["seed"]), set()).update(one["names"])
    said = (f"{len(names)} of the {what} of seed {seed}" for (what, seed), names in found.items())
    return [", ".join(said)]


def page(name: str) -> str:
    """A page as Markdown."""
    text = (HERE / f"{name}.md").read_text(encoding="utf-8")
    for mark, section in SECTIONS[name].items():
        text = text.replace(f"<!-- {mark} -->", "\n".join(section()))
    return text


SECTIONS: dict[str, dict[str, Callable[[], list[str]]]] = {
    "benchmarks": {
        "speed": speed,
        "weight": weight,
        "worth": worth,
        "synthetic": synthetic,
        "rig": rig,
        "nextrun": next_run,
        "judged": judged,
        "robotino": robotino,
    },
    "constants": {
        "sets": development_sets,
        "data": partial(constants, "data"),
        "diagnosis": partial(constants, "diagnosis"),
        "pulls": partial(constants, "pulls"),
    },
}


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        for name in SECTIONS:
            (DOCS / f"{name}.md").write_text(page(name), encoding="utf-8")
    else:
        for name in sys.argv[1:] or SECTIONS:
            print(page(name), end="")
