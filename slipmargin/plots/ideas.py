"""Several robots side by side: a panel a question, a bar an idea."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from slipmargin.plots.style import BLUE, INK, SKY, styled
from slipmargin.study.ideas import QUESTIONS, Idea, ranking


@styled
def ideas_figure(ideas: Sequence[Idea]) -> Figure:
    """Bars from zero; dark ones are the best, or all that are alike; lines are two standard deviations."""
    asked = [(q, found) for q in QUESTIONS for found in [ranking(ideas, q)] if found is not None]
    lines = math.ceil(len(asked) / 2)
    figure = Figure(figsize=(8.6, lines * (0.95 + 0.3 * len(ideas))), layout="constrained")
    panels = figure.subplots(lines, 2, squeeze=False).ravel()
    for axes in panels[len(asked) :]:
        axes.set_axis_off()
    for axes, (question, found) in zip(panels, asked, strict=False):
        best = found.order[: found.alike]
        for k, idea in enumerate(ideas):
            value = idea.values[question.key]
            if not math.isfinite(value):
                axes.text(0.0, k, " no value", va="center", color=INK, fontsize=8.5)
                continue
            spread = 2.0 * idea.deviation(question.key)
            axes.barh(k, max(value, 0.0), height=0.62, color=BLUE if k in best and value > 0.0 else SKY)
            if spread > 0.0:
                axes.plot([max(value - spread, 0.0), value + spread], [k, k], color=INK, lw=1.4)
            words = f" {value:.3g}" if value > 0.0 else " slips at constant speed"
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
    return figure
