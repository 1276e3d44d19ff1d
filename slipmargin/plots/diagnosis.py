"""Figures of a diagnosis: the residual, the variables it depends on, the candidates, the held-out runs."""

from __future__ import annotations

import math
import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import SymLogNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D

from slipmargin.checks import Array
from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.diagnosis.residual_diagnostics import CHANNELS
from slipmargin.diagnosis.result import Diagnosis, Step, TrialTrajectories
from slipmargin.plots.floor import floor_figure, floor_terms
from slipmargin.plots.limits_change import limits_figure
from slipmargin.plots.style import BLUE, GREEN, GREY, INK, ORANGE, PALE, RED, styled
from slipmargin.report.diagnosis_words import plain

#: Samples of a run in the heat map; candidates, variables and runs that a figure has room for.
_COLUMNS, _CANDIDATES, _VARIABLES, _RUNS = 240, 12, 10, 4
#: Candidates that make the error this much larger are counted, not drawn [1].
_HARMFUL = 1.15
#: Characters of a label of one line, and of a line of a label of two; their sizes [points]: a row is 0.25
#: inches high.
_LONGEST, _LONGER = 46, 56
_ONE_LINE, _TWO_LINES = 8.5, 7.0
_SIGNS = ("x", "y", "heading")
BEFORE, AFTER = RED, BLUE


def figures(diagnosis: Diagnosis, change: LimitsChange) -> dict[str, Figure]:
    """Every figure of a diagnosis by name; those that would be empty are left out."""
    drawn = {
        "residual": residual_figure(diagnosis),
        "where": where_figure(diagnosis) if diagnosis.where else None,
        "candidates": candidates_figure(diagnosis) if diagnosis.steps else None,
        "held-out": held_out_figure(diagnosis),
        "limits": limits_figure(change) if diagnosis.findings and change.moved else None,
        "floor": floor_figure(diagnosis) if diagnosis.findings and floor_terms(diagnosis) else None,
    }
    return {name: figure for name, figure in drawn.items() if figure is not None}


@styled
def residual_figure(diagnosis: Diagnosis) -> Figure:
    """Measured minus predicted in noise units, a row each run: before, and after where effects were found."""
    both = bool(diagnosis.findings)
    count = len(diagnosis.trials)
    height = max(1.5, 0.17 * count)
    figure = Figure(figsize=(10.0, (2 if both else 1) * (height + 0.75) + 0.75), layout="constrained")
    grid = figure.subplots(2 if both else 1, 3, sharex=True, sharey=True, squeeze=False)
    worst = max(
        float(np.nanmax(np.abs(_white(t, t.before, diagnosis)), initial=3.0)) for t in diagnosis.trials
    )
    image = None
    for row, model in enumerate(("before", "after") if both else ("before",)):
        for axis, axes in enumerate(grid[row]):
            image = _heat(axes, diagnosis, model, axis, worst)
            what = _SIGNS[axis]
            axes.set_title(f"{what}: " + (f"{model} the correction" if both else "the model as it stands"))
            if row == len(grid) - 1:
                axes.set_xlabel("time in the run [s]")
    assert image is not None
    bar = figure.colorbar(image, ax=grid, pad=0.01, fraction=0.03, label="measured − predicted\n[noise σ]")
    bar.ax.minorticks_off()
    bar.set_ticks(_symmetric_ticks(worst))
    bar.ax.set_yticklabels([f"{v:g}" for v in _symmetric_ticks(worst)])
    return figure


def _heat(axes: Axes, diagnosis: Diagnosis, model: str, axis: int, worst: float) -> AxesImage:
    longest = max(float(t.t_s[-1] - t.t_s[0]) for t in diagnosis.trials)
    clock = np.linspace(0.0, longest, _COLUMNS)
    rows = np.full((len(diagnosis.trials), _COLUMNS), np.nan)
    for row, trial in zip(rows, diagnosis.trials, strict=True):
        gap = _white(trial, trial.before if model == "before" else trial.after, diagnosis)[:, axis]
        seen = np.isfinite(gap)
        t = trial.t_s - trial.t_s[0]
        within = clock <= t[-1]
        if seen.any():
            row[within] = np.interp(clock[within], t[seen], gap[seen])
    image = axes.imshow(
        rows,
        aspect="auto",
        interpolation="nearest",
        cmap="RdBu_r",
        extent=(0.0, longest, len(rows) - 0.5, -0.5),
        norm=SymLogNorm(3.0, vmin=-worst, vmax=worst, base=10),
    )
    axes.grid(False)
    axes.set_facecolor(PALE)
    axes.set_yticks(
        range(len(rows)),
        [t.name + (" (held out)" if t.held_out else "") for t in diagnosis.trials],
        fontsize=7.5,
    )
    return image


def _symmetric_ticks(worst: float) -> list[float]:
    steps = [v for v in (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3000.0) if v <= worst]
    return [-v for v in reversed(steps)] + [0.0, *steps]


def _white(trial: TrialTrajectories, predicted: Array, diagnosis: Diagnosis) -> Array:
    return np.asarray((trial.measured - predicted) / diagnosis.noise)


@styled
def where_figure(diagnosis: Diagnosis) -> Figure:
    """Which measured variable the residual follows: share of its variance by variable and channel."""
    best: dict[str, float] = {}
    for d in diagnosis.where:
        best[d.variable] = max(best.get(d.variable, 0.0), d.share)
    names = sorted(best, key=lambda name: -best[name])[:_VARIABLES]
    found = {(d.variable, d.channel): d for d in diagnosis.where}
    figure = Figure(figsize=(7.0, 1.1 + 0.42 * max(1, len(names))), layout="constrained")
    axes = figure.add_subplot()
    colours = dict(zip(CHANNELS, (BLUE, ORANGE, GREEN), strict=True))
    for row, name in enumerate(names):
        for k, channel in enumerate(CHANNELS):
            one = found.get((name, channel))
            if one is None:
                continue
            sure = one.p_value <= 0.05
            axes.barh(
                row + 0.26 * (k - 1),
                100.0 * one.share,
                0.24,
                color=colours[channel] if sure else "none",
                edgecolor=colours[channel],
                lw=0.8,
            )
    words = {"right": "sideways", "forward": "forwards", "turn": "turning"}
    marks = [Line2D([], [], marker="s", ls="none", color=colours[c], label=words[c]) for c in CHANNELS]
    marks.append(
        Line2D(
            [], [], marker="s", ls="none", mfc="none", mec=GREY, label="hollow: not significant (p > 0.05)"
        )
    )
    axes.legend(handles=marks, loc="lower right", title="residual motion", alignment="left")
    axes.set_yticks(range(len(names)), [plain(name) for name in names])
    axes.invert_yaxis()
    axes.grid(False, axis="y")
    axes.set(
        xlabel="share of the residual's rate of change that the variable explains [%]",
        title="What the residual follows, before any fit",
        xlim=(0.0, max(5.0, 108.0 * max(best.values(), default=0.0))),
    )
    return figure


@styled
def candidates_figure(diagnosis: Diagnosis) -> Figure:
    """Every candidate of every round by its error on runs it was not fitted to; the chosen one in orange."""
    steps = diagnosis.steps
    rows = [max(3, min(_CANDIDATES, len(s.tried))) for s in steps] or [3]
    figure = Figure(figsize=(9.0, 1.0 + sum(0.25 * r + 0.85 for r in rows)), layout="constrained")
    grid = figure.subplots(
        max(1, len(steps)), 1, squeeze=False, gridspec_kw={"height_ratios": [r + 2 for r in rows]}
    )
    for number, (axes, step) in enumerate(zip(grid[:, 0], steps, strict=False), 1):
        _candidates(axes, step, number, steps[number - 2].taken if number > 1 else None)
    if not steps:
        grid[0, 0].text(0.5, 0.5, "nothing was tried", ha="center", va="center", color=GREY)
        grid[0, 0].set_axis_off()
        return figure
    runs = "the one run" if diagnosis.one_run else "runs fitted and left out, geometric mean"
    grid[-1, 0].set_xlabel(f"chi: {runs} (1 = noise alone)")
    marks = [
        Line2D([], [], marker="o", ls="none", color=INK, label="named effect"),
        Line2D([], [], marker="o", ls="none", mfc="white", mec=INK, label="general form over one variable"),
        Line2D([], [], color=RED, ls=(0, (4, 2)), label="without any of them"),
        Line2D([], [], ls="none", label="(2): number of parameters"),
    ]
    figure.legend(handles=marks, loc="outside upper right", ncols=4)
    return figure


def _candidates(axes: Axes, step: Step, number: int, already: str | None) -> None:
    found = sorted((t for t in step.tried if math.isfinite(t.chi)), key=lambda t: t.chi)
    shown = [t for t in found if t.chi <= _HARMFUL * step.chi_before][:_CANDIDATES] or found[:1]
    for row, tried in enumerate(shown):
        taken = tried.label == step.taken
        colour = ORANGE if taken else INK
        axes.plot([tried.chi, step.chi_before], [row, row], color=ORANGE if taken else PALE, lw=1.4, zorder=1)
        face = colour if tried.named else "white"
        axes.plot(tried.chi, row, "o", ms=7 if taken else 5, color=colour, mfc=face, mew=1.4, zorder=3)
    axes.axvline(step.chi_before, color=RED, lw=1.4, ls=(0, (4, 2)))
    axes.set_yticks(range(len(shown)), [f"{_short(t.label, already)}  ({t.parameters})" for t in shown])
    for text, tried in zip(axes.get_yticklabels(), shown, strict=True):
        text.set(fontsize=_TWO_LINES if "\n" in text.get_text() else _ONE_LINE, linespacing=1.05)
        if tried.label == step.taken:
            text.set_fontweight("bold")
    axes.set_ylim(len(shown) - 0.4, -0.6)
    axes.grid(False, axis="y")
    _scale([t.chi for t in shown] + [step.chi_before], axes, step.chi_before)
    chosen = "the one in orange is taken" if step.taken else "none is clearly better: stop"
    more = len(step.tried) - len(shown)
    axes.set_title(f"Round {number}: {chosen}" + (f" ({more} worse)" if more else ""))


def _short(label: str, already: str | None) -> str:
    """A candidate's label without what is in the model already, in two lines where one is too long."""
    if already and label.startswith(f"{already} + "):
        label = label.removeprefix(f"{already} + ")
    text = " + ".join(plain(part) for part in label.split(" + "))
    return textwrap.fill(shortened(text, 2 * _LONGER - 10), _LONGEST if len(text) <= _LONGEST else _LONGER)


def shortened(text: str, longest: int) -> str:
    """A text of at most ``longest`` characters, whole words from its middle left out where it is longer."""
    if len(text) <= longest:
        return text
    words = text.split()
    head, tail = words[:1], words[-1:]
    for word in reversed(words[1:-1]):
        if len(" ".join([*head, "…", word, *tail])) > longest:
            break
        tail.insert(0, word)
    return " ".join([*head, "…", *tail])


#: So many numbers at least stand along a logarithmic axis.
_TICKS = 4


def _scale(values: list[float], axes: Axes, before: float) -> None:
    """Logarithmic where candidates differ by factors; never so fine that hundredths of chi look large."""
    low, high = min(values), max(values)
    if high <= 1.1 * low:
        axes.set_xlim(0.9 * before, 1.1 * before)
    elif high > 4.0 * low:
        axes.set_xscale("log")
        ticks: list[float] = []
        for steps in ((1, 3), (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 7)):
            if len(ticks) < _TICKS:
                every = [float(f"{k}e{d}") for d in range(-1, 5) for k in steps]
                ticks = [v for v in every if 0.9 * low <= v <= 1.1 * high]
        axes.set_xticks(ticks, [f"{v:g}" for v in ticks])
        axes.minorticks_off()


@styled
def held_out_figure(diagnosis: Diagnosis) -> Figure:
    """Runs that no fit has seen: measured, and predicted before and after; path above, heading below."""
    chosen = [t for t in diagnosis.trials if t.held_out] or list(diagnosis.trials)
    chosen = chosen[:_RUNS]
    both = bool(diagnosis.findings)
    figure = Figure(figsize=(2.9 * max(2, len(chosen)), 5.6), layout="constrained")
    grid = figure.subplots(2, len(chosen), squeeze=False, height_ratios=(1.35, 1.0))
    for column, trial in enumerate(chosen):
        path, heading = grid[0, column], grid[1, column]
        t = trial.t_s - trial.t_s[0]
        every = max(1, len(t) // 60)
        lines = [(trial.before, BEFORE, (0, (4, 2)), 2)] + ([(trial.after, AFTER, "-", 3)] if both else [])
        path.plot(
            trial.measured[::every, 0],
            trial.measured[::every, 1],
            "o",
            ms=3,
            color=INK,
            alpha=0.55,
            zorder=1,
            mew=0,
        )
        heading.plot(
            t[::every],
            np.rad2deg(trial.measured[::every, 2]),
            "o",
            ms=3,
            color=INK,
            alpha=0.55,
            zorder=1,
            mew=0,
        )
        for predicted, colour, dash, level in lines:
            path.plot(predicted[:, 0], predicted[:, 1], color=colour, ls=dash, zorder=level)
            heading.plot(t, np.rad2deg(predicted[:, 2]), color=colour, ls=dash, zorder=level)
        path.set(title=trial.name, xlabel="x [m]", aspect="equal")
        path.set_adjustable("datalim")
        path.locator_params(nbins=4)
        heading.set(xlabel="time [s]")
        if column == 0:
            path.set_ylabel("y [m]")
            heading.set_ylabel("heading [deg]")
    marks = [
        Line2D([], [], marker="o", ls="none", ms=4, color=INK, alpha=0.6, label="measured"),
        Line2D([], [], color=BEFORE, ls=(0, (4, 2)), label="predicted before" if both else "predicted"),
    ]
    if both:
        marks.append(Line2D([], [], color=AFTER, label="predicted with what was found"))
    figure.legend(
        handles=marks,
        loc="outside upper left",
        ncols=3,
        title="Each prediction begins at the pose that fits its run best,\nnot at the first sample",
        alignment="left",
    )
    return figure
