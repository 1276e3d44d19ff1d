"""A design study drawn: curves over one quantity, families, a heat map over two, polar pulls, the front."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slipmargin.checks import Array
from slipmargin.physics.constants import GRAVITY_M_S2
from slipmargin.plots.polar import polar_axes
from slipmargin.plots.study_panels import COLOURS, draw_front, draw_polar_family, label_of, not_too_low, short
from slipmargin.plots.style import BLUE, GREEN, GREY, INK, ORANGE, PANEL, PURPLE, RED, SKY, below, styled
from slipmargin.report.design import label as in_words_of
from slipmargin.study.objectives import BY_NAME, Objective
from slipmargin.study.robust import Robust
from slipmargin.study.study import Study


@styled
def study_figure(study: Study, front: Sequence[str], robust: Robust | None = None) -> Figure:
    """Four panels: the objective over what was varied, limits in motion, polar pulls, the front."""
    figure = Figure(figsize=(11.5, 9.6), layout="constrained")
    grid = figure.add_gridspec(2, 2)
    _draw_goal(figure.add_subplot(grid[0, 0]), study, robust)
    _draw_other(figure.add_subplot(grid[0, 1]), study)
    draw_polar_family(polar_axes(figure, grid[1, 0]), study)
    draw_front(figure.add_subplot(grid[1, 1]), study, front)
    design = study.problem.base
    figure.suptitle(f"Design study of {design.robot.name}, surface “{design.surface}”\n", x=0.01, ha="left")
    return figure


@styled
def study_panels(study: Study, front: Sequence[str], robust: Robust | None = None) -> dict[str, Figure]:
    """The four panels, each a figure of its own."""
    goal, other, pulls, beaten = (Figure(figsize=PANEL, layout="constrained") for _ in range(4))
    _draw_goal(goal.add_subplot(), study, robust)
    _draw_other(other.add_subplot(), study)
    draw_polar_family(polar_axes(pulls), study)
    draw_front(beaten.add_subplot(), study, front)
    return {"goal": goal, "other": other, "pulls": pulls, "front": beaten}


def _draw_goal(axes: Axes, study: Study, robust: Robust | None) -> None:
    """The objective: a map over two quantities, else curves."""
    if _over_two(study):
        draw_heat(axes, study, study.problem.objective.name)
    else:
        draw_curves(axes, study, robust)


def _draw_other(axes: Axes, study: Study) -> None:
    """A second objective beside it."""
    if _over_two(study):
        draw_heat(axes, study, second_objective(study))
    else:
        draw_second(axes, study)


def _over_two(study: Study) -> bool:
    return sum(grid.numeric and len(grid.values) > 1 for grid in study.problem.grids) > 1


def second_objective(study: Study) -> str:
    """The objective of the second map: one that is not the first and not the same for every design."""
    goal = study.problem.objective.name
    names = ("start_worst_m_s2", "f_worst", "f_mean", "corner_m_s", "f_best")
    there = [name for name in names if name in study.objectives and name != goal]
    varied = [name for name in there if np.nanmax(study.columns[name]) > np.nanmin(study.columns[name])]
    return (varied or there or [goal])[0]


def draw_curves(axes: Axes, study: Study, robust: Robust | None = None) -> Axes:
    """The objective over the first quantity, one curve for each combination of the others.

    With one quantity and a pull as objective: worst, mean and best pull, and the worst under static loads.
    """
    goal = study.problem.objective
    if len(study.keys) == 1 and goal.name.startswith("f_"):
        for name, label, colour, style in (
            ("f_best", "best heading", SKY, "-"),
            ("f_mean", "mean", GREEN, "-"),
            ("f_worst", "worst heading", BLUE, "-"),
            ("f_worst_static", "worst, static loads", ORANGE, "--"),
            ("f_worst_equal", "worst, equal loads", PURPLE, ":"),
        ):
            _line(axes, study, study.columns[name], label, colour, style)
        axes.set(ylabel="pull / (m g)", title="Pull before a wheel slips, on rollers")
    else:
        _families(axes, study, goal)
        axes.set(ylabel=label_of(goal), title=goal.meaning)
    if robust is not None and len(study.keys) == 1:
        _line(axes, study, robust.value, "worst case of what is uncertain", RED, "-.")
    _mark_best(axes, study, goal)
    _finish(axes, study)
    return axes


def draw_second(axes: Axes, study: Study) -> Axes:
    """Worst starting and braking over the quantity; without limits in motion, isotropy."""
    if "start_worst_m_s2" not in study.objectives:
        _families(axes, study, BY_NAME["isotropy"])
        axes.set(ylabel="weakest / strongest pull", title="Isotropy of the pull")
    elif len(study.keys) == 1:
        for name, label, colour in (
            ("brake_worst_m_s2", "braking", GREEN),
            ("start_worst_m_s2", "starting", BLUE),
        ):
            _line(axes, study, study.columns[name], f"{label}, worst direction", colour, "-")
        static = study.columns["f_worst"] * GRAVITY_M_S2
        _line(axes, study, static, "static pull / m: not a limit of motion", GREY, ":")
        axes.axhline(0.0, color=INK, lw=0.8)
        axes.set(ylabel="acceleration [m/s²]", title="Limits in motion, on rollers (below 0: it must slip)")
        not_too_low(axes)
    else:
        _families(axes, study, BY_NAME["start_worst_m_s2"])
        axes.axhline(0.0, color=INK, lw=0.8)
        axes.set(ylabel="worst starting [m/s²]", title="Speeding up, on rollers (below 0: it must slip)")
        not_too_low(axes)
    _finish(axes, study)
    return axes


def draw_heat(axes: Axes, study: Study, name: str) -> Axes:
    """A column over the first two numeric quantities, the others as in the best design."""
    first, second = [k for k, g in enumerate(study.problem.grids) if g.numeric and len(g.values) > 1][:2]
    best, goal = study.best(name), BY_NAME[name]
    table = study.shaped(name)
    index = np.unravel_index(best, table.shape)
    pick = tuple(slice(None) if k in (first, second) else index[k] for k in range(table.ndim))
    x, y = (np.array(study.problem.grids[k].values, dtype=float) for k in (first, second))
    x_edges, y_edges = _edges(x), _edges(y)
    winners, middle = study.winners(name), float(table[index])
    alike = (0.9 * middle, 1.1 * middle) if not len(winners) and middle > 0.0 else (None, None)
    image = axes.pcolormesh(
        x_edges,
        y_edges,
        table[pick].T,
        cmap="viridis" if goal.sign > 0 else "viridis_r",
        rasterized=True,
        vmin=alike[0],  # rounding is no difference
        vmax=alike[1],
    )
    figure = axes.figure
    assert isinstance(figure, Figure)
    figure.colorbar(image, ax=axes, label="" if goal.unit == "1" else goal.unit)
    others = [k for k in range(len(study.keys)) if k not in (first, second)]
    shown = [
        study.values[row]
        for row in winners
        if all(study.values[row][k] == study.values[best][k] for k in others)
    ]
    if shown:  # a line without points would still take room, at the corner of the page
        axes.plot(
            [float(at[first]) for at in shown],
            [float(at[second]) for at in shown],
            marker="*",
            ms=15,
            mfc="white",
            mec=INK,
            ls="none",
            label="best of the grid",
            clip_on=False,
            zorder=5,
        )
    elif not len(winners):
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 3.0}
        words = "every design alike"
        axes.text(0.5, 0.95, words, ha="center", va="top", transform=axes.transAxes, color=INK, bbox=box)
    own = study.own_values
    here, there = own[first], own[second]
    if (
        isinstance(here, float | int)
        and isinstance(there, float | int)
        and x_edges[0] <= here <= x_edges[-1]
        and y_edges[0] <= there <= y_edges[-1]
    ):
        axes.plot(
            [float(here)],
            [float(there)],
            marker="o",
            ms=8,
            mfc="none",
            mec=RED,
            mew=2,
            ls="none",
            label="the file’s own",
            clip_on=False,
            zorder=5,
        )
    axes.grid(False)
    axes.set(xlabel=_axis(study, first), ylabel=_axis(study, second), title=textwrap.fill(goal.meaning, 44))
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    return axes


def _families(axes: Axes, study: Study, goal: Objective) -> None:
    main = _main(study)
    table = np.moveaxis(study.shaped(goal.name), main, 0)
    rest = [g for k, g in enumerate(study.problem.grids) if k != main]
    flat = table.reshape(table.shape[0], -1)
    shown = np.unique(np.linspace(0, flat.shape[1] - 1, min(len(COLOURS), flat.shape[1])).round().astype(int))
    for colour, column in zip(COLOURS, shown.tolist(), strict=False):
        index = np.unravel_index(column, table.shape[1:]) if rest else ()
        label = ", ".join(
            f"{in_words_of(g.key)} = {short(g.values[int(i)])}" for g, i in zip(rest, index, strict=True)
        )
        axes.plot(
            _positions(study),
            flat[:, column],
            color=colour,
            ms=4,
            label=label or goal.name,
            marker="o" if len(flat) < 12 else None,
        )


def _line(axes: Axes, study: Study, values: Array, label: str, colour: str, style: str) -> None:
    x = _positions(study)
    axes.plot(x, values, color=colour, ls=style, marker="o" if len(x) < 12 else None, ms=4, label=label)


def _mark_best(axes: Axes, study: Study, goal: Objective) -> None:
    best = study.winners(goal.name)
    index = np.unravel_index(best, [len(g.values) for g in study.problem.grids])
    axes.plot(
        _positions(study)[index[_main(study)]],
        study.columns[goal.name][best],
        marker="*",
        ms=14,
        mfc="white",
        mec=INK,
        ls="none",
        zorder=6,
        label="best" if len(best) else "every design alike",
    )


def _finish(axes: Axes, study: Study) -> None:
    main = _main(study)
    grid, own = study.problem.grids[main], study.own_values[main]
    if grid.numeric:
        if isinstance(own, float | int) and min(grid.values) <= own <= max(grid.values):  # type: ignore[operator]
            axes.axvline(own, color=RED, lw=1.0, ls=(0, (5, 3)), label="the file’s own")
    else:
        axes.set_xticks(range(len(grid.values)), [short(v) for v in grid.values])
    axes.set_xlabel(_axis(study, main))
    below(axes, 2)


def _main(study: Study) -> int:
    """The axis drawn to the right: the numeric one with most values, else the longest."""
    return max(
        range(len(study.keys)),
        key=lambda k: (study.problem.grids[k].numeric, len(study.problem.grids[k].values), -k),
    )


def _positions(study: Study) -> Array:
    grid = study.problem.grids[_main(study)]
    return np.array(grid.values if grid.numeric else range(len(grid.values)), dtype=float)


def _edges(values: Array) -> Array:
    ordered = np.asarray(values)
    middle = 0.5 * (ordered[1:] + ordered[:-1])
    return np.concatenate([[2 * ordered[0] - middle[0]], middle, [2 * ordered[-1] - middle[-1]]])


def _axis(study: Study, k: int) -> str:
    quantity = study.problem.grids[k].quantity
    unit = f" [{quantity.unit}]" if quantity.unit not in ("", "1") else ""
    return textwrap.fill(quantity.meaning + unit, 40)
