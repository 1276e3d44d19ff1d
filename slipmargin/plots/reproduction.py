"""The paper's Figs 6 to 10, each with the printed numbers and claims it shows, and the studies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from slipmargin.limits import sweep
from slipmargin.paper.figure8 import HEADINGS_DEG
from slipmargin.paper.identify import Identifiability
from slipmargin.paper.numbers import MEASURED_CARPET_PHI_RAD, published
from slipmargin.paper.published import DISTANCE_M, STILL_S, paper_model
from slipmargin.paper.reproduction import Reproduction
from slipmargin.paper.rows import Row, Verdict
from slipmargin.plots.motion import path_figure, run_figure, spread_figure
from slipmargin.plots.style import BLUE, GREEN, GREY, INK, ORANGE, RED, SKY, styled

_MODELS = {False: "initial model", True: "improved model"}
_COLOURS = {Verdict.REPRODUCED: GREEN, Verdict.DIFFERS: RED, Verdict.UNCHECKED: GREY}
_LINE_INCH, _SIZE = 0.19, 8.0
#: Where the columns of the table start, as shares of the figure's width.
_COLUMNS = (0.012, 0.58, 0.69, 0.82)


def paper_figures(done: Reproduction) -> dict[str, Figure]:
    """Every figure that ``slipmargin reproduce`` draws, file name → figure."""
    rows = (*done.numbers, *done.claims)
    made = {"fig8": fig8_figure()}
    for improved, times, paths in ((False, "fig6", "fig7"), (True, "fig9", "fig10")):
        kind = _MODELS[improved]
        made[times] = _times(done, improved, f"Fig. {times[3:]}: {kind}, paper")
        made[paths] = _paths(done, improved, f"Fig. {paths[3:]}: {kind}")
    for name, figure in made.items():
        add_table(figure, [r for r in rows if r.source.figure == name])
    made["spread"] = spread_figure(
        {s.surface: s.end for s in done.spreads},
        {
            "paper": (published("improved_paper_phi"),),
            "carpet": (published("improved_carpet_phi"), *MEASURED_CARPET_PHI_RAD),
        },
        DISTANCE_M,
    )
    if done.studies is not None:
        made["identifiability"] = identifiability_figure(done.studies)
    return {f"{name}.png": figure for name, figure in made.items()}


@styled
def fig8_figure() -> Figure:
    """F_emax over orientation on both surfaces: all wheels on rollers, all on rigid material, and between."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    figure.suptitle("Fig. 8: force before sliding, equal loads, δ = 15°", fontsize=11, x=0.01, ha="left")
    panels = figure.subplots(1, 2, sharey=True)
    phi = np.arange(0.0, 90.5, 1.0)
    for axes, surface in zip(panels, ("paper", "carpet"), strict=True):
        model = paper_model(surface, improved=True)
        found = sweep(model, np.deg2rad(phi))
        weight = model.inertia.weight_N
        axes.fill_between(
            phi,
            found.f_low_N / weight,
            found.f_high_N / weight,
            color=SKY,
            alpha=0.25,
            lw=0,
            label="some wheels on rigid material",
        )
        for force, colour, label in (
            (found.f_high_N, ORANGE, "all wheels on rigid material"),
            (found.f_max_N, BLUE, "all wheels on rollers (the paper's curve)"),
        ):
            axes.plot(phi, force / weight, color=colour, label=label)
            at = [int(h) for h in HEADINGS_DEG]
            axes.plot(phi[at], force[at] / weight, color=colour, ls="none", marker="o", ms=4)
        axes.set(xlabel="orientation φ [deg]", title=surface, xlim=(0, 90), ylim=(0, 0.9))
        axes.set_xticks(HEADINGS_DEG)
    panels[0].set_ylabel("largest pull without slip / (m g)")
    panels[0].legend(loc="upper left")
    return figure


@styled
def identifiability_figure(found: Identifiability) -> Figure:
    """The valley of the initial model's misfit over (r, β), and the ranges of φ on carpet."""
    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    levels = (0.0, 0.75, 1.5, 3.0, 6.0, 12.0, 100.0)
    grid = left.contourf(
        1e3 * found.radii_m,
        found.betas,
        found.misfit.T,
        levels=levels,
        cmap="Blues_r",
        norm="asinh",
        extend="max",
    )
    bar = figure.colorbar(grid, ax=left, label="misfit of the initial model [printed digits]")
    bar.set_ticks(list(levels[:-1]))
    left.plot(
        [1e3 * p.radius_m for p in found.ridge],
        [p.beta for p in found.ridge],
        color=ORANGE,
        marker="o",
        label="best m r²/I for its radius",
    )
    left.set(
        yscale="log",
        xlabel="centre-to-wheel radius [mm]",
        ylabel="m r²/I",
        title="Radius and inertia: a valley, no point",
    )
    left.set_yticks([0.2, 0.4, 0.8, 1.6, 3.2], ["0.2", "0.4", "0.8", "1.6", "3.2"])
    left.minorticks_off()
    left.grid(False)
    left.legend(loc="lower right", frameon=True)
    for k, s in enumerate(found.signs):
        right.plot([s.low_rad, s.high_rad], [-k, -k], color=BLUE, lw=6, solid_capstyle="butt")
        right.annotate(
            f"{s.varied}\n{s.low_rad:+.2f} to {s.high_rad:+.2f} rad in {s.runs} runs",
            (-1.25, -k + 0.17),
            fontsize=8.0,
        )
    printed = published("improved_carpet_phi")
    right.axvline(0.0, color=GREY, lw=0.8)
    right.axvline(printed, color=RED, lw=1.4)
    right.annotate(
        f"printed {printed:+g}",
        (printed, 0.95),
        xytext=(-4, 0),
        textcoords="offset points",
        color=RED,
        ha="right",
    )
    right.set(
        xlabel="φ at the end on carpet [rad]",
        title="Nothing unprinted gives the printed φ",
        xlim=(-1.3, 0.7),
        ylim=(-len(found.signs) + 0.5, 1.2),
    )
    right.set_yticks([])
    right.spines["left"].set_visible(False)
    return figure


@styled
def add_table(figure: Figure, rows: Sequence[Row]) -> None:
    """Write the rows below the panels: what, printed, ours, verdict; the figure grows by their height."""
    width, height = figure.get_size_inches()
    inches = _LINE_INCH * (len(rows) + 1.7)
    figure.set_size_inches(width, height + inches)
    engine = figure.get_layout_engine()
    assert isinstance(engine, ConstrainedLayoutEngine)
    engine.set(rect=(0.0, inches / (height + inches), 1.0, height / (height + inches)))
    step = _LINE_INCH / (height + inches)
    y = inches / (height + inches) - step
    for x, name in zip(_COLUMNS, ("what", "printed", "recomputed", "verdict"), strict=True):
        figure.text(x, y, name, fontsize=_SIZE, color=GREY, va="center")
    for k, row in enumerate(rows, start=1):
        printed = "in words" if row.source.value is None else _value(row.source.value, row.source.unit)
        cells = (row.source.what, printed, _value(row.recomputed, row.source.unit), row.verdict.value)
        for x, cell in zip(_COLUMNS, cells, strict=True):
            colour = _COLOURS[row.verdict] if cell is row.verdict.value else INK
            figure.text(x, y - k * step, cell, fontsize=_SIZE, color=colour, va="center")


def _value(value: float | None, unit: str) -> str:
    if value is None:
        return "–"
    if unit in ("m", "m/s"):
        return f"{1e3 * value:.3g} m{unit}"
    return f"{value:.3g}" + ("" if unit == "1" else f" {unit}")


@styled
def _times(done: Reproduction, improved: bool, title: str) -> Figure:
    """Displacements and slip over time, with the printed ends as rings."""
    figure = run_figure(done.runs["paper", improved], title)
    left = figure.axes[0]
    name = _MODELS[improved].split()[0]
    ends = (
        DISTANCE_M - published(f"{name}_paper_x_short"),
        published(f"{name}_paper_y"),
        published(f"{name}_paper_phi"),
    )
    for line, value in zip(left.lines, ends, strict=False):
        left.plot(
            STILL_S, value, marker="o", ms=7, mfc="none", mec=line.get_color(), ls="none", clip_on=False
        )
    left.plot([], [], marker="o", ms=7, mfc="none", mec=INK, ls="none", label="printed end")
    left.legend(loc="upper left")
    return figure


@styled
def _paths(done: Reproduction, improved: bool, title: str) -> Figure:
    """y over x on both surfaces, with the printed end on paper."""
    headings = ", ".join(f"{v:g}" for v in MEASURED_CARPET_PHI_RAD)
    notes = (
        "measured: headings “very small”; tracks not printed as numbers",
        f"measured headings {headings} rad; end points not printed",
    )
    runs = {s: done.runs[s, improved] for s in ("paper", "carpet")}
    figure = path_figure(runs, title, (DISTANCE_M, 0.0), notes)
    name = _MODELS[improved].split()[0]
    x, y = DISTANCE_M - published(f"{name}_paper_x_short"), published(f"{name}_paper_y")
    paper = figure.axes[0]
    paper.plot(x, y, marker="o", ms=7, mfc="none", mec=RED, ls="none", label="printed end")
    paper.legend(loc="upper left")
    return figure
