"""Several robots side by side: a panel a question, a bar an idea."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slipmargin.plots.style import BLUE, GREY, INK, styled
from slipmargin.study.ideas import QUESTIONS, Idea, Ranking, lacks_torque, ranking

#: Size of a panel without its bars, and what a bar adds [inches].
WIDE, HIGH, A_BAR = 5.0, 0.75, 0.32


@styled
def ideas_figure(ideas: Sequence[Idea]) -> Figure:
    """Every panel in one figure, two beside each other."""
    asked = _asked(ideas)
    lines = math.ceil(len(asked) / 2)
    figure = Figure(figsize=(2.0 * WIDE, lines * (HIGH + A_BAR * len(ideas))), layout="constrained")
    panels = figure.subplots(lines, 2, squeeze=False).ravel()
    for axes in panels[len(asked) :]:
        axes.set_axis_off()
    for axes, found in zip(panels, asked, strict=False):
        _bars(axes, ideas, found)
    figure.supxlabel(_legend(ideas), fontsize=8.5, color=INK)
    return figure


def _legend(ideas: Sequence[Idea]) -> str:
    """What the bars of one figure are, in words."""
    floors = list(dict.fromkeys(idea.design.surface for idea in ideas))
    words = f"on {', '.join(f'“{floor}”' for floor in floors)}; blue: the best, or all that are alike"
    spread = any(idea.deviation(question.key) > 0.0 for idea in ideas for question in QUESTIONS)
    return words + ("; lines: ± two standard deviations" if spread else "")


@styled
def ideas_panels(ideas: Sequence[Idea]) -> dict[str, Figure]:
    """Each panel as a figure of its own, by the question's key: what a page shows."""
    out = {}
    for found in _asked(ideas):
        figure = Figure(figsize=(WIDE, HIGH + A_BAR * len(ideas)), layout="constrained")
        _bars(figure.subplots(), ideas, found)
        out[found.question.key] = figure
    return out


def _asked(ideas: Sequence[Idea]) -> list[Ranking]:
    return [found for question in QUESTIONS for found in [ranking(ideas, question)] if found is not None]


def _bars(axes: Axes, ideas: Sequence[Idea], found: Ranking) -> None:
    """Bars from zero: blue ones are the best, or all that are alike; lines are two standard deviations."""
    question, best = found.question, found.order[: found.alike]
    for k, idea in enumerate(ideas):
        value = idea.values[question.key]
        if not math.isfinite(value):
            axes.text(0.0, k, " no value", va="center", color=INK, fontsize=8.5)
            continue
        spread = 2.0 * idea.deviation(question.key)
        axes.barh(k, max(value, 0.0), height=0.62, color=BLUE if k in best and value > 0.0 else GREY)
        if spread > 0.0:
            axes.plot([max(value - spread, 0.0), value + spread], [k, k], color=INK, lw=1.4)
        why = "no torque left" if lacks_torque(idea, question) else "slips at constant speed"
        words = f" {value:.3g}" if value > 0.0 else f" {why}"
        axes.text(max(value, 0.0) + spread, k, words, va="center", color=INK, fontsize=8.5)
    axes.set(
        yticks=range(len(ideas)),
        yticklabels=[idea.name for idea in ideas],
        title=f"{question.word.capitalize()} [{question.unit}]",
    )
    axes.invert_yaxis()
    axes.margins(x=0.18)
    axes.set_xlim(left=0.0)
    axes.grid(axis="y", visible=False)
