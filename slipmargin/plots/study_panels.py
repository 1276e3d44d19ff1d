"""Panels of a study's figure that compare designs: pulls all round, and the front."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.projections.polar import PolarAxes

from slipmargin.checks import Array
from slipmargin.plots.polar import forwards_up, of_pull
from slipmargin.plots.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, RED, SKY, below
from slipmargin.report.design import label as in_words_of
from slipmargin.study.batch import batches
from slipmargin.study.objectives import BY_NAME, Objective
from slipmargin.study.robot_on_surface import RobotOnSurface
from slipmargin.study.statics import headings, on_rollers
from slipmargin.study.study import Study

COLOURS = (BLUE, ORANGE, GREEN, RED, PURPLE, SKY)
#: Designs whose pulls are drawn all round, besides the best.
FAMILY = 5


def draw_polar_family(axes: PolarAxes, study: Study) -> PolarAxes:
    """F_emax / (m g) all round for designs spread over the study, the best one thick."""
    rows = _spread(study)
    chosen = [study.design(r) for r in rows]
    best, phi, others = study.best(), headings(721), itertools.cycle(COLOURS[1:])
    winners = set(study.winners(study.problem.objective.name).tolist())
    for row, force in zip(rows, _round(chosen, phi), strict=True):
        colour = BLUE if row == best else next(others)
        name = ", ".join(short(v) for v in study.values[row])
        axes.plot(
            of_pull(phi, chosen[0].robot.convention),
            force,
            color=colour,
            lw=2.8 if row == best else 1.2,
            zorder=4 if row == best else 3,
            label=name + (" (best)" if row in winners else ""),
        )
    forwards_up(axes)
    axes.set_ylim(0.0, None)
    axes.set_title("Pull before a wheel slips / (m g), by its direction")
    axes.legend(
        loc="upper center",
        bbox_to_anchor=(0.5, -0.1),
        ncols=3,
        title=", ".join(map(in_words_of, study.keys)),
    )
    return axes


def draw_front(axes: Axes, study: Study, names: Sequence[str]) -> Axes:
    """All designs by the first two objectives, those that no other beats joined by a line."""
    one, two = (BY_NAME[name] for name in names[:2])
    x, y = study.columns[one.name], study.columns[two.name]
    on = study.front(names[:2])
    axes.plot(x, y, ls="none", marker="o", ms=4, color=GREY, alpha=0.6, label="designs")
    order = np.flatnonzero(on)[np.argsort(x[on])]
    axes.plot(x[order], y[order], color=BLUE, marker="o", ms=5, lw=1.2, label="no other design beats these")
    own = (study.own[one.name], study.own[two.name])
    if all(map(math.isfinite, own)):
        axes.plot(
            *[[v] for v in own],
            marker="o",
            ms=8,
            mfc="none",
            mec=RED,
            mew=2,
            ls="none",
            label="the file’s own",
        )
    axes.margins(0.1)
    axes.locator_params(axis="x", nbins=5)
    not_too_low(axes)
    _name_ends(axes, study, [int(row) for row in order], x, y)
    names_of = ", ".join(map(in_words_of, study.keys))
    axes.set(xlabel=label_of(one), ylabel=label_of(two), title=f"By {names_of}: what no other beats")
    below(axes, 2)
    return axes


def _name_ends(axes: Axes, study: Study, order: list[int], x: Array, y: Array) -> None:
    """Name both ends of the front, the second only where the two names cannot meet."""
    width, height = np.diff(axes.get_xlim())[0], np.diff(axes.get_ylim())[0]
    for k, row in enumerate(dict.fromkeys([*order[:1], *order[-1:]])):
        near = abs(x[row] - x[order[0]]) < 0.2 * width and abs(y[row] - y[order[0]]) < 0.06 * height
        if k == 0 or not near:
            axes.annotate(
                ", ".join(short(v) for v in study.values[row]),
                (x[row], y[row]),
                xytext=(7, 5) if k == 0 else (-7, -7),
                textcoords="offset points",
                fontsize=8,
                color=INK,
                ha="left" if k == 0 else "right",
                va="bottom" if k == 0 else "top",
                zorder=7,
            )


def not_too_low(axes: Axes) -> None:
    """Keep designs that slip by far from flattening those that do not."""
    low, high = axes.get_ylim()
    if high > 0.0 and low < -1.5 * high:
        axes.set_ylim(-high, high)


def _spread(study: Study) -> list[int]:
    possible = [i for i in range(len(study.values)) if i not in study.impossible]
    steps = np.unique(np.linspace(0, len(possible) - 1, min(FAMILY, len(possible))).round().astype(int))
    return sorted({possible[int(k)] for k in steps} | {study.best()})


def _round(designs: Sequence[RobotOnSurface], phi: Array) -> list[Array]:
    out: dict[int, Array] = {}
    for batch in batches(designs)[0]:
        for row, force in zip(batch.index.tolist(), on_rollers(batch, phi, designs), strict=True):
            out[row] = force
    return [out[i] for i in range(len(designs))]


def label_of(goal: Objective) -> str:
    """An objective as an axis names it."""
    unit = "" if goal.unit in {"", "1"} else f" [{goal.unit}]"
    return textwrap.fill(goal.meaning + unit, 36)


def short(value: object) -> str:
    """A varied value in few characters."""
    return f"{value:.5g}" if isinstance(value, float | int) else str(value)
