"""The paper's Figs 6 to 10 and the spread over random rotor angles, by the names of their files."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from slipmargin.limits import sweep
from slipmargin.paper.published import (
    DISTANCE_M,
    MEASURED_CARPET_PHI_RAD,
    Spread,
    Unprinted,
    paper_model,
    straight_line,
)
from slipmargin.plots.motion import path_figure, run_figure, spread_figure
from slipmargin.plots.sweep import sweep_figure
from slipmargin.sim.run import Run

_LABEL = "initial model", "improved model"


def paper_figures(unprinted: Unprinted, spreads: Sequence[Spread]) -> dict[str, Figure]:
    """Every figure that ``slipmargin reproduce`` draws, file name → figure."""
    runs: dict[tuple[str, bool], Run] = {
        (s, improved): straight_line(s, improved=improved, unprinted=unprinted)
        for s in ("paper", "carpet")
        for improved in (False, True)
    }
    still = paper_model("paper", improved=True, unprinted=unprinted)
    phi = np.deg2rad(np.arange(0.0, 90.5, 1.0))
    notes = (
        "measured: headings “very small”; tracks not printed as numbers",
        f"measured headings {', '.join(f'{v:g}' for v in MEASURED_CARPET_PHI_RAD)} rad; ends not printed",
    )
    made = {"fig8.png": sweep_figure(sweep(still, phi), sweep(still, np.linspace(0.0, 2.0 * np.pi, 361)))}
    for improved, times, paths in ((False, "fig6", "fig7"), (True, "fig9", "fig10")):
        kind = _LABEL[improved]
        made[f"{times}.png"] = run_figure(runs["paper", improved], f"Fig. {times[3:]}: {kind}, paper")
        made[f"{paths}.png"] = path_figure(
            {s: runs[s, improved] for s in ("paper", "carpet")},
            f"Fig. {paths[3:]}: {kind}",
            (DISTANCE_M, 0.0),
            notes,
        )
    made["spread.png"] = spread_figure(
        {s.surface: s.end for s in spreads},
        {"paper": (-0.111,), "carpet": (0.558, *MEASURED_CARPET_PHI_RAD)},
        DISTANCE_M,
    )
    return made
