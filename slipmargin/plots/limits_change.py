"""Limits before and after a correction, by direction."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from slipmargin.checks import Array
from slipmargin.diagnosis.limits_change import LimitsChange
from slipmargin.plots.polar import forwards_up, of_pull, polar_axes
from slipmargin.plots.style import BLUE, RED, SKY, outside, styled

BEFORE, AFTER = RED, BLUE


@styled
def limits_figure(change: LimitsChange) -> Figure:
    """F_emax over the direction of the pull, and the acceleration bounds, before and after."""
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    grid = figure.add_gridspec(1, 3)
    before, after = change.before, change.after
    pull = (
        of_pull(change.phi_rad, change.convention),
        "Pull before a wheel slips [N]",
        (before.f_max_N, before.f_low_N, before.f_high_N),
        (after.f_max_N, after.f_low_N, after.f_high_N),
    )
    way = change.convention.from_front(change.direction_rad)
    start = (
        way,
        "Speeding up without slip [m/s²]",
        (before.start_m_s2, before.start_worst_m_s2, before.start_m_s2),
        (after.start_m_s2, after.start_worst_m_s2, after.start_m_s2),
    )
    brake = (
        way,
        "Braking without slip [m/s²]",
        (before.brake_m_s2, before.brake_worst_m_s2, before.brake_m_s2),
        (after.brake_m_s2, after.brake_worst_m_s2, after.brake_m_s2),
    )
    for k, (angle, title, one, two) in enumerate((pull, start, brake)):
        axes = polar_axes(figure, grid[k])
        _polar(axes, angle, one, two)
        axes.set_title(title, pad=14)
    marks = [
        Line2D([], [], color=BEFORE, ls=(0, (4, 2)), label="as believed"),
        Line2D([], [], color=AFTER, label="corrected"),
    ]
    if any(np.any(o[2] > o[1] * (1 + 1e-6) + 1e-9) for o in (pull[3], start[3], brake[3])):
        floor = " and on the floor's direction" if change.floor_directions > 1 else ""
        label = f"depends on what the wheels stand on{floor}"
        marks.append(Line2D([], [], color=SKY, lw=7, alpha=0.35, label=label))
    outside(figure, marks)
    return figure


def _polar(
    axes: PolarAxes, angle: Array, before: tuple[Array, Array, Array], after: tuple[Array, Array, Array]
) -> None:
    ring = np.append(angle, angle[0] + math.copysign(2.0 * np.pi, angle[1] - angle[0]))

    def closed(values: Array) -> Array:
        return np.append(values, values[0])

    if np.any(after[2] > after[1] * (1 + 1e-6) + 1e-9):
        axes.fill_between(ring, closed(after[1]), closed(after[2]), color=SKY, alpha=0.3, lw=0)
    axes.plot(ring, closed(before[0]), color=BEFORE, ls=(0, (4, 2)), lw=1.5)
    axes.plot(ring, closed(after[0]), color=AFTER)
    top = 1.08 * float(np.nanmax([*after[2], *before[0], 1e-6]))
    axes.set_ylim(0.0, top)
    forwards_up(axes)
    axes.set_yticks([v for v in MaxNLocator(4).tick_values(0.0, top) if 0.0 < v < 0.97 * top])
