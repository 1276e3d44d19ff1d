"""What ``slipmargin reproduce`` computes, draws and says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from slipmargin.io.json_text import json_text
from slipmargin.io.work_folder import make_folder
from slipmargin.io.writes import write_together
from slipmargin.paper.published import (
    FOUND,
    MEASURED_CARPET_PHI_RAD,
    Row,
    Spread,
    Unprinted,
    section_six,
    spread,
)
from slipmargin.paper.search import Calibration, calibrate
from slipmargin.plots.reproduction import paper_figures
from slipmargin.plots.style import picture

from .render import columns

RUNS = 1000
_NOT_PRINTED = "not printed in the paper, found by a search over its results"
_MEASURED = "measured by the paper's authors, quoted from section IV.C, not computed here"


def run_reproduction(out: Path, seed: int, search: bool, advance: Any) -> tuple[dict[str, Any], list[str]]:
    """Everything, written into ``out``; the report as data and as lines."""
    found = calibrate(seed=seed) if search else None
    unprinted = FOUND if found is None else found.unprinted
    advance()
    rows = section_six(unprinted)
    spreads = [spread(s, runs=RUNS, seed=seed, unprinted=unprinted) for s in ("paper", "carpet")]
    advance()
    figures = paper_figures(unprinted, spreads)
    advance()
    report = _report(rows, spreads, unprinted, found, seed, sorted(figures))
    files: dict[Path | str, str | bytes] = {out / name: picture(f, "png") for name, f in figures.items()}
    files[out / "reproduce.json"] = json_text(report)
    make_folder(out)
    write_together(files)
    advance()
    return report, _lines(rows, spreads, unprinted, found, out)


def _report(
    rows: tuple[Row, ...],
    spreads: list[Spread],
    unprinted: Unprinted,
    found: Calibration | None,
    seed: int,
    figures: list[str],
) -> dict[str, Any]:
    return {
        "schema": 1,
        "source": "Williams, Carter, Gallina, Rosati, IEEE T-RA 18(3), 2002, sections III.B and IV",
        "unprinted": {
            "radius_m": unprinted.radius_m,
            "beta": unprinted.beta,
            "rotor_angles_rad": unprinted.angles_rad,
            "origin": _NOT_PRINTED,
            "calibration": None
            if found is None
            else {"misfit_printed_digits": found.misfit, "tried": found.tried, "seed": found.seed},
        },
        "numbers": [
            {
                "key": r.key,
                "what": r.what,
                "unit": r.unit,
                "published": r.published,
                "recomputed": r.recomputed,
                "difference": r.difference,
                "note": r.note,
            }
            for r in rows
        ],
        "measured": [
            {
                "what": "carpet: φ at the end, three trials",
                "unit": "rad",
                "values": list(MEASURED_CARPET_PHI_RAD),
                "origin": _MEASURED,
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
                "seed": seed,
                "mean": dict(zip(("x_short_m", "y_m", "phi_rad"), s.mean, strict=True)),
                "sd": dict(zip(("x_short_m", "y_m", "phi_rad"), s.deviation, strict=True)),
            }
            for s in spreads
        ],
        "figures": figures,
    }


def _lines(
    rows: tuple[Row, ...], spreads: list[Spread], unprinted: Unprinted, found: Calibration | None, out: Path
) -> list[str]:
    table = columns(
        ("published", "recomputed", "difference", "unit", "quantity"),
        [(f"{r.published:.4g}", f"{r.recomputed:.4g}", f"{r.difference:+.2g}", r.unit, r.key) for r in rows],
    )
    notes = [f"  {r.key}: {r.what}" + (f" ({r.note})" if r.note else "") for r in rows]
    angles = ", ".join(f"{a:.3f}" for a in unprinted.angles_rad)
    lines = [
        *table,
        *notes,
        f"{_NOT_PRINTED}: r = {unprinted.radius_m:.4g} m, m r²/I = {unprinted.beta:.4g}, "
        f"rotor angles {angles} rad",
    ]
    if found is not None:
        lines.append(
            f"searched {found.tried} settings, root mean square misfit {found.misfit:.2g} printed digits"
        )
    for s in spreads:
        (x, y, phi), (dx, dy, dphi) = s.mean, s.deviation
        lines.append(
            f"random rotor angles, {s.surface}, {len(s.end)} runs: "
            f"x short {1e3 * x:.1f} ± {1e3 * dx:.1f} mm, "
            f"y {1e3 * y:.1f} ± {1e3 * dy:.1f} mm, φ {phi:.3f} ± {dphi:.3f} rad (mean ± one s.d.)"
        )
    lines.append(
        f"measured φ on carpet {', '.join(f'{v:g}' for v in MEASURED_CARPET_PHI_RAD)} rad ({_MEASURED})"
    )
    return [*lines, f"written: {out / 'reproduce.json'} and figures"]
