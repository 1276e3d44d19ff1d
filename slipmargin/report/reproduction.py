"""The paper's reproduction as data for ``reproduce.json`` and as lines for the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from slipmargin.paper.figure8 import HEADINGS_DEG, Curve
from slipmargin.paper.identify import Identifiability
from slipmargin.paper.numbers import MEASURED_CARPET_PHI_RAD
from slipmargin.paper.published import Spread, Unprinted
from slipmargin.paper.reproduction import Reproduction
from slipmargin.paper.rows import Row, Verdict
from slipmargin.paper.search import Calibration
from slipmargin.report.text import columns

NOT_PRINTED = "not printed in the paper, found by a search over its results"
MEASURED = "measured by the paper's authors, quoted from section IV.C, not computed here"
_PARTS = ("x_short_m", "y_m", "phi_rad")


def reproduction_report(done: Reproduction, figures: Sequence[str]) -> dict[str, Any]:
    """What ``reproduce.json`` holds (docs/paper.md explains its keys); ``figures``: file names."""
    return {
        "schema": 1,
        "source": "Williams, Carter, Gallina, Rosati, IEEE T-RA 18(3), 2002, sections III.B and IV",
        "unprinted": _unprinted(done.unprinted, done.calibration),
        "verdicts": {v.value: n for v, n in _counts(done).items()},
        "numbers": [_row(r) for r in done.numbers],
        "claims": [_row(r) for r in done.claims],
        "fig8": {
            "what": "F_emax, equal loads, every wheel in the same contact state; not printed as numbers",
            "unit": "m g",
            "orientation_deg": list(HEADINGS_DEG),
            "rows": [
                {
                    "surface": c.surface,
                    "contact": c.state,
                    "delta_deg": c.delta_deg,
                    "f_max_per_weight": c.per_weight,
                }
                for c in done.fig8
            ],
        },
        "measured": [
            {
                "what": "carpet: φ at the end, three trials",
                "unit": "rad",
                "values": list(MEASURED_CARPET_PHI_RAD),
                "origin": MEASURED,
            },
            {
                "what": "paper: φ at the end, four trials",
                "unit": "rad",
                "values": None,
                "origin": "the text says: very small, close to the angular measurement precision",
            },
        ],
        "random_rotor_angles": [
            {
                "surface": s.surface,
                "runs": len(s.end),
                "seed": done.seed,
                "mean": dict(zip(_PARTS, s.mean, strict=True)),
                "sd": dict(zip(_PARTS, s.deviation, strict=True)),
            }
            for s in done.spreads
        ],
        "identifiability": None if done.studies is None else studies_report(done.studies),
        "figures": list(figures),
    }


def studies_report(found: Identifiability) -> dict[str, Any]:
    """The two studies as data: the valley in (r, β) and the ranges of φ on carpet."""
    return {
        "seed": found.seed,
        "valley": {
            "what": "root mean square misfit [printed digits] of the initial model's three numbers; "
            "all_results: of all seven, rotor angles fitted",
            "points": [
                {
                    "radius_m": p.radius_m,
                    "beta": p.beta,
                    "initial": p.initial,
                    "all_results": p.all_results,
                }
                for p in found.ridge
            ],
        },
        "carpet_phi": [
            {"varied": s.varied, "runs": s.runs, "low_rad": s.low_rad, "high_rad": s.high_rad}
            for s in found.signs
        ],
    }


def number_table(done: Reproduction) -> tuple[Sequence[str], list[Sequence[str]]]:
    """Head and rows of the table of printed numbers."""
    head = ("published", "recomputed", "difference", "unit", "verdict", "quantity")
    return head, [
        (
            _cell(r.source.value),
            _cell(r.recomputed),
            "–" if r.difference is None else f"{r.difference:+.2g}",
            r.source.unit,
            r.verdict.value,
            r.source.key,
        )
        for r in done.numbers
    ]


def claim_table(done: Reproduction) -> tuple[Sequence[str], list[Sequence[str]]]:
    """Head and rows of the table of claims in words."""
    head = ("recomputed", "unit", "verdict", "claim")
    return head, [(_cell(r.recomputed), r.source.unit, r.verdict.value, r.source.key) for r in done.claims]


def fig8_table(curves: Sequence[Curve]) -> tuple[Sequence[str], list[Sequence[str]]]:
    """Head and rows of the values of Fig. 8 [m g]."""
    head = ("F_emax / (m g)", "δ", *(f"{h:g}°" for h in HEADINGS_DEG))
    return head, [
        (f"{c.surface}, all {c.state}", f"{c.delta_deg:g}°", *(f"{v:.5f}" for v in c.per_weight))
        for c in curves
    ]


def row_notes(rows: Sequence[Row]) -> list[str]:
    """One line for each row: what it is, where it is printed, and what there is to say of it."""
    return [
        f"  {r.source.key}: {r.source.what}; {r.source.where}" + (f" ({r.note})" if r.note else "")
        for r in rows
    ]


def markdown_tables(done: Reproduction) -> list[str]:
    """Numbers, claims and the values of Fig. 8 as Markdown tables, for docs/paper.md."""
    lines = _markdown(
        ("key", "what", "where", "unit", "published", "recomputed", "verdict", "note"),
        [
            (*_named(r), _cell(r.source.value), _cell(r.recomputed), r.verdict.value, r.note)
            for r in done.numbers
        ],
    )
    lines += ["", "## Claims in words", ""]
    lines += _markdown(
        ("key", "recomputed quantity", "where", "unit", "recomputed", "verdict", "note"),
        [(*_named(r), _cell(r.recomputed), r.verdict.value, r.note) for r in done.claims],
    )
    lines += ["", "## Values of Fig. 8", ""]
    return lines + _markdown(*fig8_table(done.fig8))


def _named(row: Row) -> tuple[str, str, str, str]:
    return f"`{row.source.key}`", row.source.what.replace("|", "\\|"), row.source.where, row.source.unit


def _markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(cells)} |" for cells in (head, ["---"] * len(head), *rows)]


def closing_lines(done: Reproduction) -> list[str]:
    """The constants that were searched for, the spread over rotor angles, the studies and the verdicts."""
    u = done.unprinted
    angles = ", ".join(f"{a:.3f}" for a in u.angles_rad)
    lines = [f"{NOT_PRINTED}: r = {u.radius_m:.4g} m, m r²/I = {u.beta:.4g}, rotor angles {angles} rad"]
    if done.calibration is not None:
        lines.append(
            f"searched {done.calibration.tried} settings, root mean square misfit "
            f"{done.calibration.misfit:.2g} printed digits"
        )
    lines += [_spread_line(s) for s in done.spreads]
    lines.append(
        f"measured φ on carpet {', '.join(f'{v:g}' for v in MEASURED_CARPET_PHI_RAD)} rad ({MEASURED})"
    )
    if done.studies is not None:
        lines += study_lines(done.studies)
    return [*lines, "verdicts: " + ", ".join(f"{v.value} {n}" for v, n in _counts(done).items())]


def report_lines(done: Reproduction) -> list[str]:
    """All that the command prints: numbers, claims and values of Fig. 8 with their notes."""
    return [
        *columns(*number_table(done)),
        *row_notes(done.numbers),
        "",
        *columns(*claim_table(done)),
        *row_notes(done.claims),
        "",
        *columns(*fig8_table(done.fig8)),
        "",
        *closing_lines(done),
    ]


def verdict_counts(done: Reproduction) -> str:
    """How many rows have each verdict, in one phrase."""
    return ", ".join(f"{n} {v.value}" for v, n in _counts(done).items())


def study_lines(found: Identifiability) -> list[str]:
    """The two studies in words."""
    first, *_, last = found.ridge
    low, high = (pick(p.initial for p in found.ridge) for pick in (min, max))
    lines = [
        "the initial model does not identify radius and inertia: along a valley from "
        f"r = {first.radius_m:g} m, m r²/I = {first.beta:.2g} to r = {last.radius_m:g} m, "
        f"m r²/I = {last.beta:.2g} its three numbers fit to {low:.2f} to {high:.2f} printed digits (r.m.s.)",
    ]
    lines += [
        f"  r = {p.radius_m:g} m, m r²/I = {p.beta:.2f}: {p.initial:.2f} digits; with the improved model, "
        f"rotor angles fitted, {p.all_results:.1f}"
        for p in found.ridge
    ]
    lines.append("φ at the end on carpet, improved model; the paper prints +0.558 rad:")
    lines += [
        f"  {s.low_rad:+.2f} to {s.high_rad:+.2f} rad in {s.runs} runs: {s.varied}" for s in found.signs
    ]
    return lines


def _row(row: Row) -> dict[str, Any]:
    return {
        "key": row.source.key,
        "what": row.source.what,
        "unit": row.source.unit,
        "published": row.source.value,
        "recomputed": row.recomputed,
        "difference": row.difference,
        "note": row.note,
        "verdict": row.verdict.value,
        "where": row.source.where,
        "quote": row.source.quote,
        "figure": row.source.figure or None,
    }


def _unprinted(unprinted: Unprinted, found: Calibration | None) -> dict[str, Any]:
    return {
        "radius_m": unprinted.radius_m,
        "beta": unprinted.beta,
        "rotor_angles_rad": unprinted.angles_rad,
        "origin": NOT_PRINTED,
        "calibration": None
        if found is None
        else {"misfit_printed_digits": found.misfit, "tried": found.tried, "seed": found.seed},
    }


def _counts(done: Reproduction) -> dict[Verdict, int]:
    found = Counter(r.verdict for r in (*done.numbers, *done.claims))
    return {v: found[v] for v in Verdict}


def _spread_line(s: Spread) -> str:
    (x, y, phi), (dx, dy, dphi) = s.mean, s.deviation
    return (
        f"random rotor angles, {s.surface}, {len(s.end)} runs: "
        f"x short {1e3 * x:.1f} ± {1e3 * dx:.1f} mm, "
        f"y {1e3 * y:.1f} ± {1e3 * dy:.1f} mm, φ {phi:.3f} ± {dphi:.3f} rad (mean ± one s.d.)"
    )


def _cell(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"
